#include "bench/throughput.h"

#include <math.h>
#include <stdlib.h>

#include "sim/sim.h"

enum { DESIGNS = 24, DESIGNS_QUICK = 4, JUDGED = 6 };

static const double WINDOW_S = 8, PLAIN_STEP = 2e-4, REFERENCE_STEPS = 320;

/* The engines that fast is compared with at equal error: each at the coarsest of a ladder of tolerances that reaches the
 * error of fast, its rungs so close that its own error is not much smaller. */
static const struct {
    const char *label;
    int engine;
    double coarsest, rung;
    int designs;
} PEERS[] = {{"ETDRK4 at equal error", ENGINE_ETDRK4, 4e-3, 0.9, 8},
             {"ARKODE IMEX at equal error", ENGINE_ARKODE_IMEX, 1e-3, 0.8, 8},
             {"CVODE Adams at equal error", ENGINE_CVODE, 3e-4, 0.5, 2}};
enum { N_PEERS = sizeof PEERS / sizeof PEERS[0] };
static const double FINEST = 1e-3; /* of the coarsest */

typedef struct {
    const SceneOptions *settings;
    const Motion *whole;
    Motion window;
    BenchCase bench_case; /* one design at a time, on the window or the whole */
    int n, n_judged;
    FILE *out;
    TimedRun *seen, *reference;
    TimedRun *judged; /* (n_judged) the window of each with REFERENCE_STEPS */
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

static Status find_references(Throughput *t, Err *err)
{
    for (int k = 0; k < t->n_judged; k++) {
        TRY(take(t, k, 0, err));
        TRY(timed_run(&t->bench_case, ENGINE_FAST, ACCURACY_FINE, REFERENCE_STEPS, &t->judged[k], err));
    }
    return STATUS_OK;
}

/* Median over the judged designs of the error in the window. */
static Status judge(Throughput *t, int engine, double tolerance, double *error, Err *err)
{
    double errors[JUDGED];
    for (int k = 0; k < t->n_judged; k++) {
        TRY(take(t, k, 0, err));
        TRY(timed_run(&t->bench_case, engine, ACCURACY_STANDARD, tolerance, t->seen, err));
        const RunErrors e = run_errors(&t->bench_case, t->seen, &t->judged[k]);
        errors[k] = t->seen->result.outcome == RUN_OK && isfinite(e.objectives) ? e.objectives : HUGE_VAL;
    }
    *error = bench_median(t->n_judged, errors);
    return STATUS_OK;
}

/* The coarsest tolerance of the ladder whose error is at most `allowed` (else the finest). */
static Status equal_error(Throughput *t, int engine, double coarsest, double rung, double allowed, double *tolerance,
                          double *error, Err *err)
{
    for (*tolerance = coarsest; *tolerance >= FINEST * coarsest; *tolerance *= rung) {
        TRY(judge(t, engine, *tolerance, error, err));
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
    double allowed, plain, tolerance[N_PEERS], error[N_PEERS];
    TRY(find_references(t, err));
    TRY(judge(t, ENGINE_FAST, 0, &allowed, err));
    TRY(judge(t, ENGINE_ETDRK4, PLAIN_STEP, &plain, err));
    for (size_t i = 0; i < N_PEERS; i++)
        TRY(equal_error(t, PEERS[i].engine, PEERS[i].coarsest, PEERS[i].rung, allowed, &tolerance[i], &error[i], err));
    fprintf(t->out,
            "\nerror in the strong window (%.3g s, median of %d designs; largest of J1..J3 and shares):\n"
            "  fast standard %.1e, plain ETDRK4 %.1e",
            fmin(WINDOW_S, (double)(t->window.n - 1) * t->window.dt_s), t->n_judged, allowed, plain);
    for (size_t i = 0; i < N_PEERS; i++)
        fprintf(t->out, ", %s %.1e", PEERS[i].label, error[i]);
    fprintf(t->out, "\n\n  %-34s %9s %13s %11s %10s\n", "against", "tolerance", "per design", "fast", "ratio");
    TRY(compare(t, "plain ETDRK4", ENGINE_ETDRK4, PLAIN_STEP, quick ? 1 : 4, 1, err));
    for (size_t i = 0; i < N_PEERS; i++)
        TRY(compare(t, PEERS[i].label, PEERS[i].engine, tolerance[i], quick ? 1 : PEERS[i].designs, 1, err));
    return STATUS_OK;
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
    t.seen = malloc((2 + JUDGED) * sizeof *t.seen);
    if (!t.seen)
        return fail(err, STATUS_NO_MEMORY, "bench: out of memory");
    t.reference = t.seen + 1;
    t.judged = t.seen + 2;
    Status status = bench_case_open(&t.bench_case, bench_kind(2), s, motion, quick, err);
    THEN(status, run_fast(&t, err));
    if (status == STATUS_OK && !count)
        status = compare_all(&t, quick, err);
    bench_case_close(&t.bench_case);
    free(t.seen);
    return status;
}
