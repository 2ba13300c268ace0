/* bench/distribution.h -- past the predictability horizon single runs differ: do engines agree in distribution?
 *
 * Each engine runs DISTRIBUTION_RUNS replicates of one design (evaluate/replicates.h) over a window longer than the
 * horizon. Its results are compared with those of the reference (fast, fine) by the two-sample distance of Kolmogorov
 * and Smirnov, sup |F_a(x) - F_b(x)|. Two samples of one distribution exceed ks_critical() in one comparison of twenty.
 *
 * Threads  none: timings want the machine to themselves */
#ifndef IMTET_BENCH_DISTRIBUTION_H
#define IMTET_BENCH_DISTRIBUTION_H

#include "bench/sweep.h"

enum { DISTRIBUTION_RUNS = 64 };

typedef struct {
    int known; /* 0: no setting of the engine was quick and accurate enough */
    char tolerance[16];
    double seconds; /* of one run, mean */
    int finished;   /* runs that ended */
    double distance[BENCH_OBJECTIVES];
} EngineDistribution;

typedef struct {
    double duration;                 /* [s]; 0: not done */
    double tolerance_m;              /* sim.gap_tolerance_m */
    double spread[BENCH_OBJECTIVES]; /* of the reference: standard deviation over mean */
    EngineDistribution again;        /* a second sample of the reference */
    EngineDistribution engine[BENCH_ENGINES];
} DistributionTest;

/* Engines at the fastest setting of the sweep on this case with an error of 5e-3 at most; those whose runs
 * would take longer than limit_s are left out. */
Status distribution_test_run(DistributionTest *test, const Sweep *sweep, const BenchCase *bench_case,
                             const SceneOptions *s, double limit_s, FILE *progress, Err *err);

double ks_critical(int n);

/* sup |F_a - F_b| of two samples; sorts them. */
double ks_distance(int n_a, double a[], int n_b, double b[]);

/* As CSV; the row `reference` is a second sample of the reference. */
void distribution_test_write(const DistributionTest *test, FILE *out);

#endif
