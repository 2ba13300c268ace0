#include "simulator/trial.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/random.h"
#include "simulator/ensemble.h"
#include "simulator/schema.h"
#include "settings/settings.h"

enum { RECORDS_MAX = 16 };

struct Trials {
    Settings settings;
    size_t n_records, members;
    World world[RECORDS_MAX];
    Crew *crew[RECORDS_MAX];
};

const World *trials_world(const Trials *t)
{
    return &t->world[0];
}

size_t trials_n_records(const Trials *t)
{
    return t->n_records;
}

const World *trials_record(const Trials *t, size_t i)
{
    return &t->world[i];
}

Crew *trials_crew(const Trials *t)
{
    return t->crew[0];
}

size_t trials_per_design(const Trials *t)
{
    return t->n_records * t->members;
}

static Status open_record(Trials *t, const char *name, int threads, Err *err)
{
    Settings s = t->settings;
    if (t->n_records == RECORDS_MAX)
        return fail(err, STATUS_BAD_DATA, "motion.records: more than %d records", RECORDS_MAX);
    snprintf(s.motion.record, sizeof s.motion.record, "%s", name);
    TRY(world_open(&t->world[t->n_records], &s, err));
    t->n_records++;
    return crew_create(&t->crew[t->n_records - 1], t->world[t->n_records - 1].scene, threads, err);
}

static Status open_records(Trials *t, int threads, Err *err)
{
    const char *list = t->settings.motion.records;
    char name[OPTION_TEXT_MAX];
    TRY(open_record(t, t->settings.motion.record, threads, err));
    for (size_t i = 0; strcmp(list, "none") != 0 && i < list_count(list); i++) {
        if (!list_item(list, i, name, sizeof name))
            return fail(err, STATUS_BAD_DATA, "motion.records: item %zu is empty or too long", i + 1);
        TRY(open_record(t, name, threads, err));
    }
    return STATUS_OK;
}

Status trials_open(Trials **out, const Settings *s, int threads, Err *err)
{
    Trials *t = calloc(1, sizeof *t);
    *out = NULL;
    if (!t)
        return fail(err, STATUS_NO_MEMORY, "no memory for a scene");
    t->settings = *s;
    t->members = (size_t)s->sim.replicates;
    const Status status = open_records(t, threads, err);
    if (status != STATUS_OK)
        trials_close(t);
    else
        *out = t;
    return status;
}

void trials_close(Trials *t)
{
    for (size_t r = 0; t && r < t->n_records; r++) {
        crew_free(t->crew[r]);
        world_close(&t->world[r]);
    }
    free(t);
}

/* Member k of a design. A gap never is negative. */
static void vary(const Trials *t, size_t k, size_t n_floors, double x[])
{
    Random random = random_stream((uint32_t)t->settings.search.seed, RANDOM_ENSEMBLE, 0, (uint32_t)k);
    for (size_t j = 0; k > 0 && j < n_floors; j++) {
        const double tiny = random_normal(&random), error = random_normal(&random);
        x[j] = fmax(x[j] * (1.0 + ENSEMBLE_CHANGE * tiny) + t->settings.sim.gap_tolerance_m * error, 0.0);
    }
}

/* Mean and standard deviation of measure k over the members under one record. */
static void summarise(size_t n, const SimResult members[], int k, double *mean, double *spread)
{
    double square = 0.0;
    *mean = 0.0;
    for (size_t i = 0; i < n; i++)
        *mean += measure_value(&members[i], k) / (double)n;
    for (size_t i = 0; i < n; i++)
        square += pow(measure_value(&members[i], k) - *mean, 2.0);
    *spread = n > 1 ? sqrt(square / (double)(n - 1)) : NAN;
}

/* From results (n_records, members) of one design. */
static void judge(const Trials *t, const SimResult *const results[], Trial *out)
{
    double mean, spread;
    *out = (Trial){.result = results[0][0]};
    for (size_t r = t->n_records; r-- > 0;)
        for (size_t k = t->members; k-- > 0;) {
            double unused[N_OBJECTIVES];
            out->seconds += results[r][k].seconds;
            if (!measure_objectives(&results[r][k], unused))
                out->result = results[r][k];
        }
    for (int k = 0; k < N_MEASURES; k++) {
        for (size_t r = 0; r < t->n_records; r++) {
            const double sense = measure(k)->sense, n = (double)t->n_records;
            summarise(t->members, results[r], k, &mean, &spread);
            if (t->settings.sim.robust == ROBUST_MEAN || sense == 0.0) {
                out->value[k] += mean / n;
                out->spread[k] += spread * spread / n;
            } else if (r == 0 || sense * mean > sense * out->value[k]) {
                out->value[k] = mean;
                out->spread[k] = spread * spread;
            }
        }
        out->spread[k] = sqrt(out->spread[k]);
    }
}

/* One pass over the designs under record `under`; a design is judged when its last member is done under the last. */
typedef struct {
    Trials *trials;
    int worker;          /* that does all of it; -1: the whole crew */
    size_t under, *left; /* left (n): members to be done */
    SimResult *results;  /* (n_records, n, members) */
    size_t n;
    Trial *out;
    const Watch *watch;
} Pass;

static int may_go_on(void *user)
{
    const Pass *p = user;
    return watch_go_on(p->watch);
}

static Status member_done(size_t task, void *user, Err *err)
{
    const Pass *p = user;
    const Trials *t = p->trials;
    const size_t i = task / t->members;
    const SimResult *of_design[RECORDS_MAX];
    if (p->under + 1 < t->n_records || --p->left[i] > 0)
        return STATUS_OK;
    for (size_t r = 0; r < t->n_records; r++)
        of_design[r] = p->results + (r * p->n + i) * t->members;
    judge(t, of_design, &p->out[i]);
    return watch_done(p->watch, i, err);
}

static Status run_passes(Pass *p, SimTask tasks[], Err *err)
{
    const size_t n_tasks = p->n * p->trials->members;
    const Watch watch = {may_go_on, member_done, p};
    for (p->under = 0; p->under < p->trials->n_records; p->under++) {
        Crew *crew = p->trials->crew[p->under];
        SimResult *results = p->results + p->under * n_tasks;
        TRY(p->worker < 0 ? crew_run_watched(crew, n_tasks, tasks, results, &watch, err)
                          : crew_run_alone(crew, p->worker, n_tasks, tasks, results, &watch, err));
    }
    return STATUS_OK;
}

static Status run(Trials *t, int worker, size_t n, const double X[], const size_t draws[], Trial out[],
                  const Watch *watch, Err *err)
{
    const size_t n_floors = (size_t)scene_n_floors(t->world[0].scene), n_var = n_floors + 2, n_tasks = n * t->members;
    double *varied = calloc(n_tasks * n_var, sizeof *varied);
    SimTask *tasks = calloc(n_tasks, sizeof *tasks);
    size_t *left = calloc(n, sizeof *left);
    SimResult *results = calloc(t->n_records * n_tasks, sizeof *results);
    Status status = STATUS_NO_MEMORY;
    if (!varied || !tasks || !left || !results) {
        fail(err, status, "no memory for %zu simulations", t->n_records * n_tasks);
        goto done;
    }
    for (size_t i = 0; i < n_tasks; i++) {
        double *x = varied + i * n_var;
        memcpy(x, X + i / t->members * n_var, n_var * sizeof *x);
        vary(t, (draws ? draws[i / t->members] * t->members : 0) + i % t->members, n_floors, x);
        tasks[i] = (SimTask){SCENE_IMPACT, x};
        left[i / t->members] = t->members;
    }
    status = run_passes(&(Pass){t, worker, 0, left, results, n, out, watch}, tasks, err);
done:
    free(varied);
    free(tasks);
    free(left);
    free(results);
    return status;
}

Status trials_run(Trials *t, size_t n, const double X[], const size_t draws[], Trial out[], const Watch *watch,
                  Err *err)
{
    return run(t, -1, n, X, draws, out, watch, err);
}

Status trials_run_alone(Trials *t, int worker, const double x[], size_t draws, Trial *out, const Watch *watch, Err *err)
{
    return run(t, worker, 1, x, &draws, out, watch, err);
}
