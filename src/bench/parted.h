/* bench/parted.h -- after the horizon single runs no longer agree: are engines alike in distribution?
 *
 * Each engine answers PARTED_RUNS times, gaps graded over the height and changed by 1e-12 of themselves, over a window
 * long enough for the runs to part. Its answers are compared with those of the reference (fast, fine) by the two-sample
 * distance of Kolmogorov and Smirnov, sup |F_a(x) - F_b(x)|. Two samples of one distribution are apart by more than
 * parted_by_chance() in one comparison of twenty. Threads  none: timings want the machine to themselves */
#ifndef IMTET_BENCH_PARTED_H
#define IMTET_BENCH_PARTED_H

#include "bench/sweep.h"

enum { PARTED_RUNS = 64 };

typedef struct {
    int known; /* 0: no setting of the engine was quick and accurate enough */
    char knob[16];
    double seconds; /* of one run, mean */
    int finished;   /* runs that ended */
    double distance[BENCH_OBJECTIVES];
} PartedEngine;

typedef struct {
    double duration;                 /* [s]; 0: not done */
    double spread[BENCH_OBJECTIVES]; /* of the reference: standard deviation over mean */
    PartedEngine again;              /* the reference once more, other changes: what chance does */
    PartedEngine engine[ENGINE_COUNT];
} Parted;

/* Engines at the fastest setting of the sweep on this stage's scene with an error of 5e-3 at most; those whose runs
 * would take longer than limit_s are left out. */
Status parted_run(Parted *parted, const Sweep *sweep, const Stage *stage, const SceneOptions *s, double limit_s,
                  FILE *progress, Err *err);

double parted_by_chance(int n);

/* sup |F_a - F_b| of two samples; sorts them. */
double parted_distance(int n_a, double a[], int n_b, double b[]);

void parted_write_markdown(const Parted *parted, FILE *out);

#endif
