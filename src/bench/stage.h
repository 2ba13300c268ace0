/* bench/stage.h -- the scenes that engines are compared on: a short strong window of one ground motion, five sets of
 * gaps.
 *
 *   linear      no gap can close
 *   one-impact  one floor, once
 *   irregular   gaps of 10 to 200 mm from a fixed stream, as a search would propose
 *   tiny        gaps of 1 to 3 mm
 *   zero        no gaps: every floor always touches one side or the other
 *
 * Life cycle  stage_open -> stage_close. Ownership  borrows the whole motion. Threads  none */
#ifndef IMTET_BENCH_STAGE_H
#define IMTET_BENCH_STAGE_H

#include "base/random.h"
#include "scene/motion.h"
#include "sim/engine.h"

typedef struct {
    const char *name, *what;
    double window_s;
} BenchScene;

/* Wall of the core in the first and last storey [m]. */
static const double BENCH_WALL_BASE = 0.012, BENCH_WALL_TOP = 0.0064;

enum { N_BENCH_SCENES = 5 };
const BenchScene *bench_scene(int k);

typedef struct {
    const BenchScene *scene;
    Building building;
    CoreBeam *core;
    SimModel model;
    Motion motion; /* the window; its samples are the whole motion's */
    double gaps[FLOORS_MAX];
    double duration, start; /* [s] of the window, of the whole motion where it starts */
} Stage;

/* motion: prepared. quick: half the window. */
Status stage_open(Stage *stage, const BenchScene *scene, const SceneOptions *s, const Motion *motion, int quick,
                  Err *err);
void stage_close(Stage *stage); /* a zeroed Stage may be closed */

/* Gaps of design k (n): 10 to 200 mm, uniform, from a stream of its own. */
void bench_irregular_gaps(uint32_t design, int n, double gaps[]);

/* The window of a motion that starts one second before it first reaches three tenths of its peak. */
Motion bench_window(const Motion *whole, double *start_s);

#endif
