#include "bench/timed_run.h"
#include "base/stat.h"
#include "sim/tail.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

/* Runs shorter than this [s] are timed three times. */
static const double SHORT = 0.3;

static const double SHARE_FLOOR_PCT = 0.1;

const char *const BENCH_OBJECTIVE_NAMES[BENCH_OBJECTIVES] = {"j1", "j2", "j3", "ed1", "ed5_10", "edcs"};

double bench_median(int n, double x[])
{
    sort_values((size_t)n, x);
    return n == 0 ? NAN : n % 2 ? x[n / 2] : 0.5 * (x[n / 2 - 1] + x[n / 2]);
}

double bench_quantile(int n, double x[], double share)
{
    const int at = (int)ceil(share * n) - 1;
    sort_values((size_t)n, x);
    return n == 0 ? NAN : x[at < 0 ? 0 : at];
}

double processor_seconds(void)
{
    struct timespec t;
    clock_gettime(CLOCK_THREAD_CPUTIME_ID, &t);
    return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

/* input: of tail_input, which a scene knows before its first run. */
static Status run_once(const BenchCase *bench_case, const double *input, int engine, Accuracy accuracy,
                       double tolerance, TimedRun *o, double *seconds, Err *err)
{
    OnsetLog log = {.n_max = BENCH_ONSETS, .at = o->onsets};
    const EngineOptions options = {.duration = bench_case->duration,
                                   .accuracy = accuracy,
                                   .tolerance = tolerance,
                                   .end_state = o->state,
                                   .tail_input = input,
                                   .onsets = &log};
    const double start = processor_seconds();
    TRY(bench_engine(engine)->run(&bench_case->model, &bench_case->motion, &options, &o->result, err));
    *seconds = processor_seconds() - start;
    o->n_onsets = log.n;
    return STATUS_OK;
}

static double median_of_three(const double t[3])
{
    return fmax(fmin(t[0], t[1]), fmin(fmax(t[0], t[1]), t[2]));
}

Status timed_run(const BenchCase *bench_case, int engine, Accuracy accuracy, double tolerance, TimedRun *o, Err *err)
{
    double t[3], *input = malloc(bench_case->motion.n * sizeof *input);
    if (!input)
        return fail(err, STATUS_NO_MEMORY, "bench: out of memory");
    memset(o, 0, sizeof *o);
    Status status = tail_input(&bench_case->building.model, &bench_case->motion, input, err);
    for (int i = 0; i < 3 && status == STATUS_OK; i++) {
        status = run_once(bench_case, input, engine, accuracy, tolerance, o, &t[i], err);
        o->seconds = i < 2 ? t[0] : median_of_three(t);
        if (t[0] >= SHORT)
            break;
    }
    free(input);
    return status;
}

static double energy_of(const SimModel *model, const double state[], const double minus[])
{
    double sum = 0;
    for (int i = 0; i < model->m; i++) {
        const double q = state[i] - (minus ? minus[i] : 0), v = state[model->m + i] - (minus ? minus[model->m + i] : 0);
        sum += 0.5 * (v * v + pow(model->omega[i] * q, 2));
    }
    return sum;
}

/* The first closing of floor j, NULL where it is not among those kept. */
static const ContactOnset *first_onset(const TimedRun *o, int j)
{
    for (int k = 0; k < o->n_onsets; k++)
        if (o->onsets[k].floor == j)
            return &o->onsets[k];
    return NULL;
}

/* The first onsets of the floors that the reference closes first; speeds below the contact law's floor are alike. */
static void compare_onsets(const BenchCase *bench_case, const TimedRun *o, const TimedRun *reference, RunErrors *e)
{
    const double slow = bench_case->model.contact[0].v0_floor;
    int compared = 0;
    e->first_s = e->first_speed = NAN;
    for (int i = 0; i < reference->n_onsets && compared < BENCH_FIRST; i++) {
        const ContactOnset *b = &reference->onsets[i], *a = first_onset(o, b->floor);
        if (!a || b != first_onset(reference, b->floor))
            continue;
        e->first_s = fmax(e->first_s, fabs(a->t - b->t)); /* fmax passes over NaN */
        e->first_speed = fmax(e->first_speed, fabs(fmax(a->speed, slow) / fmax(b->speed, slow) - 1));
        compared++;
    }
}

void result_errors(const SimResult *a, const SimResult *b, double each[BENCH_OBJECTIVES])
{
    const double found[] = {a->j1_m, a->j2_m, a->j3_g, a->ed1_pct, a->ed5_10_pct, a->edcs_pct};
    const double wanted[] = {b->j1_m, b->j2_m, b->j3_g, b->ed1_pct, b->ed5_10_pct, b->edcs_pct};
    for (int k = 0; k < BENCH_OBJECTIVES; k++)
        each[k] = fabs(found[k] - wanted[k]) / fmax(fabs(wanted[k]), k < 3 ? 1e-300 : SHARE_FLOOR_PCT);
}

RunErrors run_errors(const BenchCase *bench_case, const TimedRun *o, const TimedRun *reference)
{
    RunErrors e = {0};
    result_errors(&o->result, &reference->result, e.each);
    for (int k = 0; k < BENCH_OBJECTIVES; k++)
        if (!(e.each[k] <= e.objectives)) /* keeps NaN */
            e.objectives = e.each[k];
    const SimModel *model = &bench_case->model;
    e.state = sqrt(energy_of(model, o->state, reference->state) / energy_of(model, reference->state, NULL));
    compare_onsets(bench_case, o, reference, &e);
    return e;
}
