/* bench/observe.h -- one run of an engine on a stage, timed, and how far it is from another. Threads  none */
#ifndef IMTET_BENCH_OBSERVE_H
#define IMTET_BENCH_OBSERVE_H

#include "bench/stage.h"

enum { BENCH_OBJECTIVES = 6, BENCH_ONSETS = 24, BENCH_FIRST = 3 };

typedef struct {
    SimResult result;
    double seconds;                    /* of processor time: the median of three where they are short */
    double state[4 * FLOORS_MAX];      /* q and q' at the end */
    double energy;                     /* [J] of that state, without the contacts */
    ContactOnset onsets[BENCH_ONSETS]; /* the first */
    int n_onsets;
} Observed;

typedef struct {
    double each[BENCH_OBJECTIVES]; /* relative: J1, J2, J3, shares of mode 1, modes 5-10, core */
    double objectives;             /* the largest of them */
    double state; /* at the end: root of the energy of the difference over that of the whole; NaN: unknown */
    double first_s, first_speed; /* first three onsets: largest error in time, relative in speed; NaN: unknown */
} Errors;

extern const char *const BENCH_OBJECTIVE_NAMES[BENCH_OBJECTIVES];

Status observe(const Stage *stage, Engine engine, Accuracy accuracy, double knob, Observed *out, Err *err);

/* A share below 0.1 % of the input energy is compared as if it were 0.1 %. */
Errors errors_between(const Stage *stage, const Observed *o, const Observed *reference);

/* Of this thread: other work on the machine disturbs it less than it does the time of day. */
double processor_seconds(void);

#endif
