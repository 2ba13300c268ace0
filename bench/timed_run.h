/* bench/timed_run.h -- one timed run of an engine on a benchmark case, and its errors against another.
 *
 * Threads  none: timings want the machine to themselves */
#pragma once

#include "bench/case.h"

enum { BENCH_OBJECTIVES = 6, BENCH_ONSETS = 24, BENCH_FIRST = 3 };

typedef struct {
    SimResult result;
    double seconds;                    /* of processor time: the median of three where they are short */
    double state[4 * FLOORS_MAX];      /* q and q' at the end */
    double energy;                     /* [J] of that state, without the contacts */
    ContactOnset onsets[BENCH_ONSETS]; /* the first */
    int n_onsets;
} TimedRun;

typedef struct {
    double each[BENCH_OBJECTIVES]; /* relative: J1, J2, J3, shares of mode 1, modes 5-10, core */
    double objectives;             /* the largest of them */
    double state; /* at the end: root of the energy of the difference over that of the whole; NaN: unknown */
    double first_s, first_speed; /* first three onsets: largest error in time, relative in speed; NaN: unknown */
} RunErrors;

extern const char *const BENCH_OBJECTIVE_NAMES[BENCH_OBJECTIVES];

Status timed_run(const BenchCase *bench_case, int engine, Accuracy accuracy, double tolerance, TimedRun *out, Err *err);

/* Relative, of a against b: J1, J2, J3, shares of mode 1, modes 5-10, core. A share below 0.1 % of the input is compared as 0.1 %. */
void result_errors(const SimResult *a, const SimResult *b, double each[BENCH_OBJECTIVES]);
RunErrors run_errors(const BenchCase *bench_case, const TimedRun *o, const TimedRun *reference);

/* Of n numbers, which are sorted: the middle, and the least that a share of them does not exceed; NAN: of none. */
double bench_median(int n, double x[]);
double bench_quantile(int n, double x[], double share);

/* [s] of this thread: less disturbed by other work on the machine than wall time. */
double processor_seconds(void);
