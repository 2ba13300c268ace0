/* bench/case.h -- the benchmark cases: a short strong window of one ground motion, five kinds of gaps.
 *
 *   linear      no gap can close
 *   one-impact  one floor, once
 *   irregular   gaps of 10 to 200 mm from a fixed stream, as a search proposes them
 *   tiny        gaps of 1 to 3 mm
 *   zero        no gaps: every floor always touches one side or the other
 *
 * Life cycle  bench_case_open -> bench_case_close
 * Ownership   borrows the whole motion
 * Threads     one owner at a time */
#pragma once

#include "base/random.h"
#include "motion/motion.h"
#include "bench/engines/engines.h"

typedef struct {
    const char *name;
    double window_s;
} BenchKind;

/* Thickness of the core in the first and last storey [m]. */
static const double BENCH_WALL_BASE = 0.012, BENCH_WALL_TOP = 0.0064;

enum { N_BENCH_KINDS = 5 };
const BenchKind *bench_kind(int k);

typedef struct {
    const BenchKind *kind;
    Building building;
    CoreBeam *core;
    SimModel model;
    Motion motion; /* the window; its samples are the whole motion's */
    double gaps[FLOORS_MAX];
    double duration, start; /* [s] of the window, of the whole motion where it starts */
} BenchCase;

/* motion: prepared. quick: half the window. */
Status bench_case_open(BenchCase *bench_case, const BenchKind *kind, const SceneOptions *s, const Motion *motion,
                       int quick, Err *err);
void bench_case_close(BenchCase *bench_case); /* a zeroed BenchCase may be closed */

/* Gaps of design k (n): 10 to 200 mm, uniform, from a stream of its own. */
void bench_irregular_gaps(uint32_t design, int n, double gaps[]);

/* The window of a motion that starts one second before it first reaches three tenths of its peak. */
Motion bench_window(const Motion *whole, double *start_s);
