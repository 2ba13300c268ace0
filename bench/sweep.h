/* bench/sweep.h -- every engine at many tolerances on one benchmark case: speed against accuracy.
 *
 * The reference is CVODE at 1e-12; a second method that shares nothing with it must agree: fast at 320 steps per
 * contact or etdrk4 at 10 microseconds, whichever is nearer. An error below ten times their difference is not known and
 * is drawn as that (floor).
 *
 * Ownership  sweep_free releases the rows
 * Threads    none: timings want the machine to themselves */
#pragma once

#include <stdio.h>

#include "bench/timed_run.h"

typedef struct {
    const BenchKind *kind;
    int engine;
    char tolerance[16];
    Accuracy accuracy;
    double tolerance_value; /* 0: as accuracy says */
    TimedRun seen;
    RunErrors error;
} SweepRow;

typedef struct {
    size_t n, n_max;
    SweepRow *rows;
    double agreement[N_BENCH_KINDS]; /* of the two references; 0: the case was not run */
} Sweep;

typedef struct {
    unsigned engines; /* bit by Engine */
    double limit_s; /* an engine's sweep ends with the first run that takes longer, or the second that does and fails */
} SweepPlan;

/* Appends the rows of one case; progress: one line per engine. */
Status sweep_run(Sweep *s, int kind, const BenchCase *bench_case, const SweepPlan *plan, FILE *progress, Err *err);
void sweep_free(Sweep *s);

double sweep_floor(const Sweep *s, int kind);

int sweep_row_failed(const SweepRow *row);

void sweep_write(const Sweep *s, FILE *out); /* as CSV */
