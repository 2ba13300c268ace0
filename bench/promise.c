#include "bench/promise.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/random.h"
#include "scene/design.h"
#include "sim/sim.h"
#include "analysis/estimate.h"

static const double GAP_MIN = 1e-3, GAP_MAX = 0.2, CORE_MIN = 4e-3, CORE_MAX = 0.04; /* [m] */
static const double WINDOW_MIN_S = 8, WINDOW_MAX_S = 15, STRONG = 0.3;               /* of the peak */

enum { FRONT_MAX = 60, REFERENCE_EVERY = 10 };

typedef struct {
    const char *name;
    Accuracy accuracy;
    double steps;
} Preset;

static const Preset PRESETS[] = {
    {"coarse", ACCURACY_COARSE, 0},
    {"standard", ACCURACY_STANDARD, 0},
    {"standard, 1 step per contact", ACCURACY_STANDARD, 1},
    {"standard, 4 steps per contact", ACCURACY_STANDARD, 4},
    {"standard, 8 steps per contact", ACCURACY_STANDARD, 8},
};
enum { N_PRESETS = sizeof PRESETS / sizeof PRESETS[0], N_ERRORS = PROMISED + 1, STANDARD = 1, TWICE_STANDARD = 3 };

static const int ESTIMATED[] = {MEASURE_J1, MEASURE_J2, MEASURE_J3, MEASURE_ED1, MEASURE_ED5_10, MEASURE_EDCS};
enum { N_ESTIMATED = sizeof ESTIMATED / sizeof ESTIMATED[0] };

/* Below this share of a value neither estimate nor error is looked at: rounding. */
static const double SMALLEST_ERROR = 1e-10;

/* Errors (N_ERRORS, n) of the cases: relative of J1, J2, J3, worst share, and of the shares in points of the input. */
typedef struct {
    double *error;
    double seconds;
    long held, repeated, failed;
} Missed;

typedef struct {
    const PromisePlan *plan;
    int n_floors;
    long n, n_max, left_out; /* cases that count, room, cases without a reference */
    Missed missed[N_PRESETS];
    double *ratio[N_ESTIMATED]; /* (n) estimated over true error at standard */
} Promise;

/* ---- the cases --------------------------------------------------------------------------------------------------- */

/* First and last sample above a share of the peak. */
static void strong_part(const Motion *m, size_t *first, size_t *last)
{
    const double wanted = STRONG * motion_peak(m);
    *first = 0;
    *last = m->n - 1;
    while (*first < *last && fabs(m->accel[*first]) < wanted)
        ++*first;
    while (*last > *first && fabs(m->accel[*last]) < wanted)
        --*last;
}

static void draw_design(Random *r, int n_floors, int log_uniform, double x[])
{
    for (int j = 0; j < n_floors; j++) {
        const double share = random_uniform(r);
        x[j] = log_uniform ? GAP_MIN * pow(GAP_MAX / GAP_MIN, share) : GAP_MIN + (GAP_MAX - GAP_MIN) * share;
    }
    x[n_floors] = CORE_MIN + (CORE_MAX - CORE_MIN) * random_uniform(r);
    x[n_floors + 1] = CORE_MIN + (x[n_floors] - CORE_MIN) * random_uniform(r);
}

void promise_window(const PromisePlan *plan, int n_floors, long k, PromiseCase *out)
{
    const Motion *record = &plan->records[k % plan->n_records];
    Random r = random_stream(1, RANDOM_TEST, 1, (uint32_t)k);
    size_t first, last;
    strong_part(record, &first, &last);
    const double length = WINDOW_MIN_S + (WINDOW_MAX_S - WINDOW_MIN_S) * random_uniform(&r);
    const size_t samples = (size_t)(length / record->dt_s), latest = last > samples / 2 ? last - samples / 2 : 0;
    const size_t start = latest > first ? first + random_below(&r, latest - first) : first;
    *out = (PromiseCase){.motion = *record, .theory = k % 2 ? CORE_EULER_BERNOULLI : CORE_TIMOSHENKO};
    out->motion.accel += start;
    out->motion.n -= start;
    out->duration = fmin(length, (double)(out->motion.n - 1) * record->dt_s);
    draw_design(&r, n_floors, (k & 2) != 0, out->x);
}

/* ---- errors ------------------------------------------------------------------------------------------------------ */

static Status simulate(const Promise *p, const PromiseCase *c, Engine engine, const Preset *preset, int times,
                       SimResult *result, double *seconds, Err *err)
{
    SceneOptions o = *p->plan->options;
    Scene *scene;
    SimWorker *worker;
    o.sim.engine = engine;
    o.sim.accuracy = preset->accuracy;
    o.sim.steps_per_contact = preset->steps;
    o.sim.duration_s = c->duration;
    o.core.theory = c->theory;
    TRY(scene_create(&scene, &o, &c->motion, err));
    Status status = sim_worker_create(&worker, scene, err);
    const double start = processor_seconds();
    for (int i = 0; i < times && status == STATUS_OK; i++)
        status = sim_run(worker, SCENE_IMPACT, c->x, result, err);
    *seconds = (processor_seconds() - start) / times;
    sim_worker_free(worker);
    scene_free(scene);
    return status;
}

static void case_errors(const SimResult *found, const SimResult *wanted, double error[N_ERRORS])
{
    double each[BENCH_OBJECTIVES];
    const double points[] = {found->ed1_pct - wanted->ed1_pct, found->ed5_10_pct - wanted->ed5_10_pct,
                             found->edcs_pct - wanted->edcs_pct};
    result_errors(found, wanted, each);
    error[PROMISED - 1] = error[PROMISED] = 0;
    for (int k = 0; k < PROMISED - 1; k++)
        error[k] = each[k];
    for (int k = PROMISED - 1; k < BENCH_OBJECTIVES; k++) {
        error[PROMISED - 1] = fmax(error[PROMISED - 1], each[k]);
        error[PROMISED] = fmax(error[PROMISED], fabs(points[k - PROMISED + 1]));
    }
}

static void note(Promise *p, Missed *m, const SimResult *found, const SimResult *wanted, double seconds)
{
    double error[N_ERRORS];
    int held = found->outcome == RUN_OK;
    case_errors(found, wanted, error);
    for (int k = 0; k < N_ERRORS; k++) {
        m->error[k * p->n_max + p->n] = found->outcome == RUN_OK ? error[k] : HUGE_VAL;
        held = held && !(k < PROMISED && error[k] > PROMISE[k]);
    }
    m->held += held;
    m->repeated += found->repeated > 0;
    m->failed += found->outcome != RUN_OK;
    m->seconds += seconds;
}

static void note_estimates(Promise *p, const SimResult *standard, const SimResult *finer, const SimResult *wanted)
{
    double error[N_MEASURES];
    const Measured as_set = measured(standard), again = measured(finer);
    estimate_errors(&as_set, &again, error);
    for (int i = 0; i < N_ESTIMATED; i++) {
        const double value = measure_value(wanted, ESTIMATED[i]), least = SMALLEST_ERROR * fabs(value);
        const double missed = fmax(fabs(measure_value(standard, ESTIMATED[i]) - value), least);
        p->ratio[i][p->n] = fmax(ESTIMATE_FACTOR * error[ESTIMATED[i]], least) / missed;
    }
}

static Status measure_case(Promise *p, const PromiseCase *c, int times, Err *err)
{
    static const Preset FINE = {"fine", ACCURACY_FINE, 0};
    SimResult wanted, found[N_PRESETS];
    double seconds;
    TRY(simulate(p, c, ENGINE_FAST, &FINE, 1, &wanted, &seconds, err));
    if (wanted.outcome != RUN_OK || !(wanted.j1_m > 0)) {
        p->left_out++;
        return STATUS_OK;
    }
    for (int k = 0; k < N_PRESETS; k++) {
        TRY(simulate(p, c, ENGINE_FAST, &PRESETS[k], times, &found[k], &seconds, err));
        note(p, &p->missed[k], &found[k], &wanted, seconds);
    }
    note_estimates(p, &found[STANDARD], &found[TWICE_STANDARD], &wanted);
    p->n++;
    return STATUS_OK;
}

static Status clear(Promise *p, long n_max, Err *err)
{
    p->n = p->left_out = 0;
    p->n_max = n_max;
    for (int k = 0; k < N_PRESETS; k++) {
        double *error = realloc(p->missed[k].error, (size_t)(N_ERRORS * n_max + 1) * sizeof *error);
        if (!error)
            return fail(err, STATUS_NO_MEMORY, "promise: no memory for %ld cases", n_max);
        p->missed[k] = (Missed){.error = error};
    }
    for (int i = 0; i < N_ESTIMATED; i++) {
        double *ratio = realloc(p->ratio[i], (size_t)n_max * sizeof *ratio);
        if (!ratio)
            return fail(err, STATUS_NO_MEMORY, "promise: no memory for %ld cases", n_max);
        p->ratio[i] = ratio;
    }
    return STATUS_OK;
}

/* ---- the table --------------------------------------------------------------------------------------------------- */

static const char *const QUANTITIES[N_ERRORS] = {"j1", "j2", "j3", "worst_share", "share_points"};

/* n values, which are sorted: median, quantiles of 90 and 95 %. */
static void write_quantiles(FILE *out, const char *part, const char *accuracy, const char *quantity, long n, double x[])
{
    fprintf(out, "%s,\"%s\",%s,%ld", part, accuracy, quantity, n);
    for (int k = 0; k < 3; k++)
        fprintf(out, ",%.1e", bench_quantile((int)n, x, (double[]){0.5, 0.9, 0.95}[k]));
}

static void write_errors(Promise *p, const char *part, const char *accuracy, const Missed *m, FILE *out)
{
    const double n = (double)p->n;
    for (int e = 0; e < N_ERRORS; e++) {
        write_quantiles(out, part, accuracy, QUANTITIES[e], p->n, m->error + e * p->n_max);
        fprintf(out, ",%.0f,%.2f,%.0f\n", 100 * (double)m->held / n, 1e3 * m->seconds / n,
                100 * (double)m->repeated / n);
    }
}

/* Estimated over true error: quantiles, and the share of the cases in which the estimate is not too small. */
static void write_estimates(Promise *p, const char *part, FILE *out)
{
    for (int i = 0; i < N_ESTIMATED; i++) {
        long above = 0;
        for (long k = 0; k < p->n; k++)
            above += p->ratio[i][k] >= 1;
        write_quantiles(out, part, "estimated / true error", measure(ESTIMATED[i])->name, p->n, p->ratio[i]);
        fprintf(out, ",%.1f,,\n", 100 * (double)above / (double)p->n);
    }
}

static void write_part(Promise *p, const char *part, FILE *out, FILE *progress)
{
    for (int k = 0; k < N_PRESETS; k++)
        write_errors(p, part, PRESETS[k].name, &p->missed[k], out);
    write_estimates(p, part, out);
    fprintf(progress, "promise: %s: %ld cases, %ld left out: `fine` fails there or nothing moves\n", part, p->n,
            p->left_out);
}

static Status write_windows(Promise *p, FILE *out, FILE *progress, Err *err)
{
    const PromisePlan *plan = p->plan;
    TRY(clear(p, plan->n_windows, err));
    for (long k = 0; k < plan->n_windows; k++) {
        PromiseCase c;
        promise_window(plan, p->n_floors, k, &c);
        TRY(measure_case(p, &c, 3, err));
    }
    write_part(p, "windows", out, progress);
    return STATUS_OK;
}

static Status write_designs(Promise *p, const Designs *d, FILE *out, FILE *progress, Err *err)
{
    const Motion *record = &p->plan->records[0];
    PromiseCase c = {
        .motion = *record, .duration = (double)(record->n - 1) * record->dt_s, .theory = p->plan->options->core.theory};
    const long n = d->n < FRONT_MAX ? (long)d->n : FRONT_MAX;
    TRY(clear(p, n, err));
    for (long k = 0; k < n; k++) {
        memcpy(c.x, d->x + (size_t)k * d->n / (size_t)n * (size_t)d->space.n_var, (size_t)d->space.n_var * sizeof *c.x);
        TRY(measure_case(p, &c, 1, err));
    }
    write_part(p, "front", out, progress);
    return STATUS_OK;
}

static Status write_front(Promise *p, FILE *out, FILE *progress, Err *err)
{
    Designs d = {0};
    DesignSpace space;
    TRY(design_space_make(&space, &p->plan->options->design, p->plan->options->core.section, p->n_floors, err));
    TRY(design_read(&d, p->plan->front, &space, err));
    const Status status = write_designs(p, &d, out, progress, err);
    design_free(&d);
    return status;
}

/* `fine` against another method, on a part of the windows. */
static Status write_reference(Promise *p, FILE *out, Err *err)
{
    static const Preset FINE = {"fine", ACCURACY_FINE, 0};
    Missed *m = &p->missed[0];
    TRY(clear(p, p->plan->n_windows, err));
    for (long k = 0; k < p->plan->n_windows; k += REFERENCE_EVERY) {
        PromiseCase c;
        SimResult found, wanted;
        double seconds;
        promise_window(p->plan, p->n_floors, k, &c);
        TRY(simulate(p, &c, ENGINE_CVODE, &FINE, 1, &wanted, &seconds, err));
        TRY(simulate(p, &c, ENGINE_FAST, &FINE, 1, &found, &seconds, err));
        if (wanted.outcome != RUN_OK || !(wanted.j1_m > 0))
            continue;
        note(p, m, &found, &wanted, seconds);
        p->n++;
    }
    write_errors(p, "cvode", "fine", m, out);
    return STATUS_OK;
}

static Status write_table(Promise *p, FILE *out, FILE *progress, Err *err)
{
    fprintf(out, "part,accuracy,quantity,cases,median,q90,q95,share_pct,ms,repeated_pct\n");
    TRY(write_windows(p, out, progress, err));
    if (p->plan->front)
        TRY(write_front(p, out, progress, err));
    return write_reference(p, out, err);
}

Status promise_write(const PromisePlan *plan, FILE *out, FILE *progress, Err *err)
{
    Promise p = {.plan = plan};
    Building b;
    TRY(building_load(&b, &plan->options->building, err));
    p.n_floors = b.n;
    building_free(&b);
    const Status status = write_table(&p, out, progress, err);
    for (int k = 0; k < N_PRESETS; k++)
        free(p.missed[k].error);
    for (int i = 0; i < N_ESTIMATED; i++)
        free(p.ratio[i]);
    return status;
}
