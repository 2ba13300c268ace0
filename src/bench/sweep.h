/* bench/sweep.h -- every engine at many settings of its knob on one stage: speed against accuracy.
 *
 * The reference is CVODE at 1e-12; a second method that shares nothing with it must agree: fast at 320 steps per
 * contact or etdrk4 at 10 microseconds, whichever is nearer. An error below ten times their difference is not known and
 * is drawn as that (floor). Ownership  sweep_free releases the rows. Threads  none: timings want the machine to
 * themselves */
#ifndef IMTET_BENCH_SWEEP_H
#define IMTET_BENCH_SWEEP_H

#include <stdio.h>

#include "bench/observe.h"

typedef struct {
    const BenchScene *scene;
    Engine engine;
    char knob[16];
    Accuracy accuracy;
    double knob_value; /* 0: as accuracy says */
    Observed seen;
    Errors error;
} SweepRow;

typedef struct {
    size_t n, n_max;
    SweepRow *rows;
    double agreement[N_BENCH_SCENES]; /* of the two references; 0: the scene was not run */
    long impacts[N_BENCH_SCENES];
    double duration[N_BENCH_SCENES];
    double
        noise; /* largest relative spread of an objective over an ensemble, whole motion, irregular gaps; 0: unknown */
} Sweep;

typedef struct {
    unsigned engines; /* bit by Engine */
    double limit_s; /* an engine's sweep ends with the first run that takes longer, or the second that does and fails */
} SweepPlan;

/* Appends the rows of one scene; says on `progress` what it does. */
Status sweep_scene(Sweep *s, int scene, const Stage *stage, const SweepPlan *plan, FILE *progress, Err *err);
void sweep_free(Sweep *s);

/* Sets noise. settings, motion: as prepared for the stages. */
Status sweep_find_noise(Sweep *s, const SceneOptions *settings, const Motion *motion, Err *err);

double sweep_floor(const Sweep *s, int scene);

/* A run that ends, with closed books, far from the answer. */
int sweep_silently_wrong(const SweepRow *row);
int sweep_row_failed(const SweepRow *row);

void sweep_write_csv(const Sweep *s, FILE *out);
void sweep_write_markdown(const Sweep *s, const Motion *motion, FILE *out);

#endif
