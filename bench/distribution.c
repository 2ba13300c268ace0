#include "bench/distribution.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/stat.h"
#include "evaluate/replicates.h"

static const double WINDOW_S = 60, ENOUGH = 5e-3, REFERENCE_STEPS = 10;

static const double GAP_M = 0.008; /* of the first floor; floor j has j times as much */

typedef struct {
    int n;
    double value[BENCH_OBJECTIVES][DISTRIBUTION_RUNS];
} Samples;

double ks_distance(int n_a, double a[], int n_b, double b[])
{
    double largest = 0;
    sort_values((size_t)n_a, a);
    sort_values((size_t)n_b, b);
    for (int i = 0, j = 0; i < n_a && j < n_b;) {
        const double x = fmin(a[i], b[j]);
        while (i < n_a && a[i] <= x)
            i++;
        while (j < n_b && b[j] <= x)
            j++;
        largest = fmax(largest, fabs((double)i / n_a - (double)j / n_b));
    }
    return largest;
}

double ks_critical(int n)
{
    return 1.358 * sqrt(2.0 / n);
}

static void take_sample(const SimResult *r, Samples *samples)
{
    const double all[BENCH_OBJECTIVES] = {r->j1_m, r->j2_m, r->j3_g, r->ed1_pct, r->ed5_10_pct, r->edcs_pct};
    for (int k = 0; k < BENCH_OBJECTIVES; k++)
        samples->value[k][samples->n] = all[k];
    samples->n++;
}

static Status run_all(BenchCase *bench_case, const SceneOptions *s, int engine, Accuracy accuracy, double tolerance,
                      uint32_t series, Samples *samples, EngineDistribution *out, Err *err)
{
    const EngineOptions options = {.duration = bench_case->duration, .accuracy = accuracy, .tolerance = tolerance};
    double changed[FLOORS_MAX];
    SimResult r;
    const double start = processor_seconds();
    samples->n = 0;
    for (size_t k = 1; k <= DISTRIBUTION_RUNS; k++) { /* replicate 0 is the design itself, in every series */
        memcpy(changed, bench_case->gaps, sizeof changed);
        replicate_design(series, k, s->sim.gap_tolerance_m, (size_t)bench_case->building.n, changed);
        TRY(model_set(&bench_case->model, s, &bench_case->building, bench_case->core, changed, err));
        memset(&r, 0, sizeof r);
        TRY(bench_engine(engine)->run(&bench_case->model, &bench_case->motion, &options, &r, err));
        if (r.outcome == RUN_OK && isfinite(r.j3_g))
            take_sample(&r, samples);
    }
    out->known = 1;
    out->seconds = (processor_seconds() - start) / DISTRIBUTION_RUNS;
    out->finished = samples->n;
    return STATUS_OK;
}

static void compare(const Samples *reference, Samples *samples, EngineDistribution *out)
{
    for (int k = 0; k < BENCH_OBJECTIVES; k++) {
        double sorted[DISTRIBUTION_RUNS];
        memcpy(sorted, reference->value[k], sizeof sorted);
        out->distance[k] = samples->n > 0 ? ks_distance(reference->n, sorted, samples->n, samples->value[k]) : NAN;
    }
}

static double relative_sd(int n, const double x[])
{
    double mean, sd;
    mean_and_sd_of((size_t)n, x, &mean, &sd);
    return sd / fabs(mean);
}

/* The fastest setting of the sweep that is accurate and quick enough; NULL: there is none. */
static const SweepRow *setting_of(const Sweep *sweep, const BenchCase *bench_case, int engine, double limit_s)
{
    const SweepRow *best = NULL;
    for (size_t i = 0; i < sweep->n; i++) {
        const SweepRow *row = &sweep->rows[i];
        if (row->kind == bench_case->kind && row->engine == engine && !sweep_row_failed(row) &&
            row->error.objectives <= ENOUGH && (!best || row->seen.seconds < best->seen.seconds))
            best = row;
    }
    return best && best->seen.seconds * WINDOW_S / bench_case->kind->window_s <= limit_s ? best : NULL;
}

static Status test_engines(DistributionTest *p, const Sweep *sweep, BenchCase *bench_case, const SceneOptions *s,
                           double limit_s, Samples samples[2], FILE *progress, Err *err)
{
    Samples *reference = &samples[0], *other = &samples[1];
    EngineDistribution ignored;
    TRY(run_all(bench_case, s, ENGINE_FAST, ACCURACY_FINE, REFERENCE_STEPS, 1, reference, &ignored, err));
    for (int k = 0; k < BENCH_OBJECTIVES; k++)
        p->spread[k] = relative_sd(reference->n, reference->value[k]);
    snprintf(p->again.tolerance, sizeof p->again.tolerance, "%g", REFERENCE_STEPS);
    TRY(run_all(bench_case, s, ENGINE_FAST, ACCURACY_FINE, REFERENCE_STEPS, 2, other, &p->again, err));
    compare(reference, other, &p->again);
    for (int e = 0; e < BENCH_ENGINES; e++) {
        const SweepRow *row = setting_of(sweep, bench_case, e, limit_s);
        if (!row)
            continue;
        fprintf(progress, "  after the horizon: %s\n", bench_engine(e)->name);
        snprintf(p->engine[e].tolerance, sizeof p->engine[e].tolerance, "%s", row->tolerance);
        TRY(run_all(bench_case, s, e, row->accuracy, row->tolerance_value, 3, other, &p->engine[e], err));
        compare(reference, other, &p->engine[e]);
    }
    return STATUS_OK;
}

Status distribution_test_run(DistributionTest *test, const Sweep *sweep, const BenchCase *bench_case,
                             const SceneOptions *s, double limit_s, FILE *progress, Err *err)
{
    BenchCase longer = *bench_case; /* borrows all of it; the model is set anew for every run */
    Samples *samples = calloc(2, sizeof *samples);
    if (!samples)
        return fail(err, STATUS_NO_MEMORY, "bench: out of memory");
    for (int j = 0; j < longer.building.n; j++)
        longer.gaps[j] = GAP_M * (j + 1);
    longer.duration = fmin(WINDOW_S, (double)(bench_case->motion.n - 1) * bench_case->motion.dt_s);
    const Status status = test_engines(test, sweep, &longer, s, limit_s, samples, progress, err);
    test->duration = longer.duration;
    test->tolerance_m = s->sim.gap_tolerance_m;
    free(samples);
    return status;
}

static void write_row(const char *name, const EngineDistribution *e, FILE *out)
{
    fprintf(out, "%s,%s,%.3g,%d", name, e->tolerance, 1e3 * e->seconds, e->finished);
    for (int k = 0; k < BENCH_OBJECTIVES; k++)
        fprintf(out, ",%.2f", e->distance[k]);
    fputc('\n', out);
}

void distribution_test_write(const DistributionTest *p, FILE *out)
{
    fprintf(out, "engine,tolerance,ms,finished");
    for (int k = 0; k < BENCH_OBJECTIVES; k++)
        fprintf(out, ",%s", BENCH_OBJECTIVE_NAMES[k]);
    fputc('\n', out);
    write_row("reference", &p->again, out);
    for (int e = 0; e < BENCH_ENGINES; e++)
        if (p->engine[e].known)
            write_row(bench_engine(e)->name, &p->engine[e], out);
    fprintf(out, "sd over mean,,,");
    for (int k = 0; k < BENCH_OBJECTIVES; k++)
        fprintf(out, ",%.2g", p->spread[k]);
    fputc('\n', out);
}
