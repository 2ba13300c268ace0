#include "bench/throughput.h"

#include <math.h>
#include <omp.h>
#include <stdlib.h>

#include "base/clock.h"
#include "evaluate/replicates.h"

enum { DESIGNS = 24, DESIGNS_QUICK = 4, JUDGED = 6, REPLICATES = 8 };

static const double WINDOW_S = 8, PLAIN_STEP = 2e-4, BDF_RTOL = 1e-6, REFERENCE_STEPS = 320;

/* From coarse to fine. */
static const double STEPS[] = {4e-3, 2e-3, 1.5e-3, 1e-3, 5e-4, 2e-4},
                    TOLERANCES[] = {3e-3, 1e-3, 3e-4, 1e-4, 3e-5, 1e-5};
enum { LADDER = 6 };

typedef struct {
    const SceneOptions *settings;
    const Motion *whole;
    Motion window;
    BenchCase bench_case; /* one design at a time, on the window or the whole */
    int n, n_judged;
    FILE *out;
    TimedRun *seen, *reference;
} Throughput;

static Status take(Throughput *t, int design, int whole, Err *err)
{
    BenchCase *bench_case = &t->bench_case;
    bench_case->motion = whole ? *t->whole : t->window;
    const double length = (double)(bench_case->motion.n - 1) * bench_case->motion.dt_s;
    bench_case->duration = whole ? length : fmin(WINDOW_S, length);
    bench_irregular_gaps((uint32_t)design, bench_case->building.n, bench_case->gaps);
    return model_set(&bench_case->model, t->settings, &bench_case->building, bench_case->core, bench_case->gaps, err);
}

static Status run_fast(Throughput *t, Err *err)
{
    double ms[DESIGNS], all = 0;
    long steps = 0, forces = 0, impacts = 0, failed = 0;
    for (int k = 0; k < t->n; k++) {
        TRY(take(t, k, 1, err));
        TRY(timed_run(&t->bench_case, ENGINE_FAST, ACCURACY_STANDARD, 0, t->seen, err));
        const SimResult *r = &t->seen->result;
        ms[k] = 1e3 * t->seen->seconds;
        all += t->seen->seconds;
        steps += r->steps;
        forces += r->force_evaluations;
        impacts += r->impacts;
        failed += r->outcome != RUN_OK || !(r->energy_balance_error <= sim_energy_balance_max(&t->settings->sim));
    }
    const double middle = bench_median(t->n, ms);
    fprintf(t->out, "fast, standard: %d designs, %.5g s each, one thread\n", t->n, t->bench_case.duration);
    fprintf(t->out, "  per design      %.3g ms median, %.3g min, %.3g max; %.4g designs a second\n", middle, ms[0],
            ms[t->n - 1], (double)t->n / all);
    fprintf(t->out, "  counted         %.0f steps, %.0f force evaluations, %.0f impacts per design; %ld failed\n",
            (double)steps / t->n, (double)forces / t->n, (double)impacts / t->n, failed);
    fprintf(t->out, "  work            steps %ld force_evaluations %ld\n", steps, forces);
    return STATUS_OK;
}

/* Design k; replicate r of it. */
static Status run_one(Throughput *t, SimWorker *worker, int k, int r, Err *err)
{
    const int n = t->bench_case.building.n;
    double x[FLOORS_MAX + 2];
    SimResult result;
    bench_irregular_gaps((uint32_t)k, n, x);
    replicate_design(1, (size_t)r, 0, (size_t)n, x);
    x[n] = BENCH_WALL_BASE;
    x[n + 1] = BENCH_WALL_TOP;
    return sim_run(worker, SCENE_IMPACT, x, &result, err);
}

/* Wall time [s] of n designs, or of n replicates of design 0, over the workers. */
static double time_runs(Throughput *t, SimWorker *const worker[], int threads, int n, int are_replicates)
{
    const double start = clock_seconds();
#pragma omp parallel for schedule(dynamic) num_threads(threads)
    for (int k = 0; k < n; k++) {
        Err err;
        run_one(t, worker[omp_get_thread_num()], are_replicates ? 0 : k, are_replicates ? k : 0, &err);
    }
    return clock_seconds() - start;
}

static Status time_workers(Throughput *t, const Scene *scene, int threads, double *all, double *replicated, Err *err)
{
    SimWorker **worker = calloc((size_t)threads, sizeof(SimWorker *));
    Status status = worker ? STATUS_OK : fail(err, STATUS_NO_MEMORY, "bench: out of memory");
    for (int i = 0; i < threads && status == STATUS_OK; i++)
        status = sim_worker_create(&worker[i], scene, err);
    if (status == STATUS_OK) {
        *all = time_runs(t, worker, threads, t->n, 0);
        *replicated = time_runs(t, worker, threads, REPLICATES, 1);
    }
    for (int i = 0; worker && i < threads; i++)
        sim_worker_free(worker[i]);
    free(worker);
    return status;
}

/* What threads gain, and what the replicates of one design cost. */
static Status run_workers(Throughput *t, Err *err)
{
    const int threads = omp_get_num_procs();
    double one, many, replicated_one, replicated_many;
    Scene *scene;
    TRY(scene_create(&scene, t->settings, t->whole, err));
    Status status = time_workers(t, scene, 1, &one, &replicated_one, err);
    if (status == STATUS_OK)
        status = time_workers(t, scene, threads, &many, &replicated_many, err);
    scene_free(scene);
    TRY(status);
    fprintf(t->out, "  threads         %.4g designs a second on 1, %.4g on %d: %.2f times\n", t->n / one, t->n / many,
            threads, one / many);
    fprintf(t->out, "  replicates, %d   %.3g ms on 1 thread, %.3g ms on %d: %.2f and %.2f times one design\n",
            REPLICATES, 1e3 * replicated_one, 1e3 * replicated_many, threads, replicated_one * t->n / one,
            replicated_many * t->n / one);
    return STATUS_OK;
}

/* -- what is asked for beside the objectives ----------------------------------------------------------------------- */

enum { PLAIN, WITH_FORCES, FILTERED, N_ASKED, ASKED_ROUNDS = 5 };

/* Processor time [s] of all designs one after the other. */
static Status time_designs(const Throughput *t, SimWorker *worker, double *seconds, Err *err)
{
    const int n = t->bench_case.building.n;
    double x[FLOORS_MAX + 2];
    SimResult r;
    const double start = processor_seconds();
    for (int k = 0; k < t->n; k++) {
        bench_irregular_gaps((uint32_t)k, n, x);
        x[n] = BENCH_WALL_BASE;
        x[n + 1] = BENCH_WALL_TOP;
        TRY(sim_run(worker, SCENE_IMPACT, x, &r, err));
    }
    *seconds = processor_seconds() - start;
    return STATUS_OK;
}

static Status time_asked(const Throughput *t, SimWorker *const workers[], double ratio[N_ASKED][ASKED_ROUNDS], Err *err)
{
    for (int round = 0; round < ASKED_ROUNDS; round++) {
        double seconds[N_ASKED];
        for (int a = 0; a < N_ASKED; a++)
            TRY(time_designs(t, workers[a], &seconds[a], err));
        for (int a = 0; a < N_ASKED; a++)
            ratio[a][round] = seconds[a] / seconds[PLAIN];
    }
    return STATUS_OK;
}

static Status open_asked(const Throughput *t, Scene *scenes[], SimWorker *workers[], Err *err)
{
    for (int a = 0; a < N_ASKED; a++) {
        SceneOptions o = *t->settings;
        o.sim.forces = a == WITH_FORCES ? FORCES_YES : FORCES_AUTO;
        o.sim.measures_only = 1;
        o.sim.filtered = a == FILTERED;
        TRY(scene_create(&scenes[a], &o, t->whole, err));
        TRY(sim_worker_create(&workers[a], scenes[a], err));
    }
    return STATUS_OK;
}

/* Forces and the filter, each in turn with neither: medians of ratios of processor time, which other load leaves alone. */
static Status run_asked(const Throughput *t, Err *err)
{
    Scene *scenes[N_ASKED] = {NULL};
    SimWorker *workers[N_ASKED] = {NULL};
    double ratio[N_ASKED][ASKED_ROUNDS];
    Status status = open_asked(t, scenes, workers, err);
    if (status == STATUS_OK)
        status = time_asked(t, workers, ratio, err);
    for (int a = 0; a < N_ASKED; a++) {
        sim_worker_free(workers[a]);
        scene_free(scenes[a]);
    }
    TRY(status);
    fprintf(t->out, "  asked for       forces %.3f, filtered acceleration %.3f times the processor time without\n",
            bench_median(ASKED_ROUNDS, ratio[WITH_FORCES]), bench_median(ASKED_ROUNDS, ratio[FILTERED]));
    return STATUS_OK;
}

/* Median over the judged designs of the error in the window. */
static Status judge(Throughput *t, int engine, double tolerance, double *error, Err *err)
{
    double errors[JUDGED];
    for (int k = 0; k < t->n_judged; k++) {
        TRY(take(t, k, 0, err));
        TRY(timed_run(&t->bench_case, ENGINE_FAST, ACCURACY_FINE, REFERENCE_STEPS, t->reference, err));
        TRY(timed_run(&t->bench_case, engine, ACCURACY_STANDARD, tolerance, t->seen, err));
        const RunErrors e = run_errors(&t->bench_case, t->seen, t->reference);
        errors[k] = t->seen->result.outcome == RUN_OK && isfinite(e.objectives) ? e.objectives : HUGE_VAL;
    }
    *error = bench_median(t->n_judged, errors);
    return STATUS_OK;
}

/* The coarsest of a ladder of tolerances whose error is at most `allowed` (else the finest). */
static Status equal_error(Throughput *t, int engine, const double ladder[LADDER], double allowed, double *tolerance,
                          double *error, Err *err)
{
    for (int i = 0; i < LADDER; i++) {
        *tolerance = ladder[i];
        TRY(judge(t, engine, ladder[i], error, err));
        if (*error <= allowed)
            break;
    }
    return STATUS_OK;
}

/* Time of an engine over that of fast at standard accuracy, on the same designs, one after the other; designs on which
 * it fails are left out and counted. */
static Status compare(Throughput *t, const char *label, int engine, double tolerance, int designs, int whole, Err *err)
{
    double other = 0, fast = 0;
    int finished = 0;
    for (int k = 0; k < designs; k++) {
        TRY(take(t, k, whole, err));
        TRY(timed_run(&t->bench_case, ENGINE_FAST, ACCURACY_STANDARD, 0, t->reference, err));
        TRY(timed_run(&t->bench_case, engine, ACCURACY_STANDARD, tolerance, t->seen, err));
        if (t->seen->result.outcome != RUN_OK) {
            fprintf(t->out, "  %s fails on design %d: %s\n", label, k, t->seen->result.reason);
            continue;
        }
        fast += t->reference->seconds;
        other += t->seen->seconds;
        finished++;
    }
    if (finished > 0)
        fprintf(t->out, "  %-34s %9.4g %10.4g ms %8.3g ms %8.4g x   %d designs, %.4g s\n", label, tolerance,
                1e3 * other / finished, 1e3 * fast / finished, other / fast, finished, t->bench_case.duration);
    return STATUS_OK;
}

static Status compare_all(Throughput *t, int quick, Err *err)
{
    double allowed, step, step_error, rtol, rtol_error, plain;
    TRY(judge(t, ENGINE_FAST, 0, &allowed, err));
    TRY(equal_error(t, ENGINE_ETDRK4, STEPS, allowed, &step, &step_error, err));
    TRY(equal_error(t, ENGINE_ARKODE_IMEX, TOLERANCES, allowed, &rtol, &rtol_error, err));
    TRY(judge(t, ENGINE_ETDRK4, PLAIN_STEP, &plain, err));
    fprintf(t->out,
            "\nerror in the strong window (%.3g s, median of %d designs; largest of J1..J3 and shares):\n"
            "  fast standard %.1e, etdrk4 at %g %.1e, at %g %.1e, arkode_imex at %g %.1e\n\n",
            fmin(WINDOW_S, (double)(t->window.n - 1) * t->window.dt_s), t->n_judged, allowed, PLAIN_STEP, plain, step,
            step_error, rtol, rtol_error);
    fprintf(t->out, "  %-34s %9s %13s %11s %10s\n", "against", "tolerance", "per design", "fast", "ratio");
    TRY(compare(t, "plain ETDRK4", ENGINE_ETDRK4, PLAIN_STEP, quick ? 1 : 4, 1, err));
    TRY(compare(t, "ETDRK4 at equal error", ENGINE_ETDRK4, step, quick ? 2 : 8, 1, err));
    TRY(compare(t, "ARKODE IMEX at equal error", ENGINE_ARKODE_IMEX, rtol, quick ? 2 : 8, 1, err));
    return compare(t, "CVODE BDF, strong window only", ENGINE_CVODE_BDF, BDF_RTOL, quick ? 1 : 2, 0, err);
}

Status throughput_print(const SceneOptions *s, const Motion *motion, int quick, int count, FILE *out, Err *err)
{
    Throughput t = {.settings = s,
                    .whole = motion,
                    .n = quick || count ? DESIGNS_QUICK : DESIGNS,
                    .n_judged = quick ? 2 : JUDGED,
                    .out = out};
    double start;
    t.window = bench_window(motion, &start);
    t.seen = malloc(2 * sizeof *t.seen);
    if (!t.seen)
        return fail(err, STATUS_NO_MEMORY, "bench: out of memory");
    t.reference = t.seen + 1;
    Status status = bench_case_open(&t.bench_case, bench_kind(2), s, motion, quick, err);
    if (status == STATUS_OK)
        status = run_fast(&t, err);
    if (status == STATUS_OK && !count)
        status = run_workers(&t, err);
    if (status == STATUS_OK && !count)
        status = run_asked(&t, err);
    if (status == STATUS_OK && !count)
        status = compare_all(&t, quick, err);
    bench_case_close(&t.bench_case);
    free(t.seen);
    return status;
}
