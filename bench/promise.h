/* bench/promise.h -- how often the engine `fast` holds what docs/promise.md promises: quantiles of its errors against
 * `fine` over scenes of ten kinds and over the designs of a front, and of `fine` against CVODE.
 *
 *   scene k of a kind   of record k mod n: 9 to 40 s that begin somewhere in the strong shaking, from rest, stretched
 *                       1.5 to 4 times, peak 0.1 to 0.5 g, a box of 8, 11.3 or 15 m, walls of 4 to 40 mm
 *   kinds               gaps of 1 to 500 mm, log-uniform; 50 to 500 mm; three floors alone, 1 to 200 mm; 1 to 10 mm;
 *                       growing with height; equal but for 5 %; log-uniform with storeys that yield; log-uniform
 *                       with contacts off the centre by 2 to 10 % of the plan; with a core that may lift off its mat,
 *                       5 to 10 m in radius, on soil C; with walls that buckle
 *   predictable         a scene where gaps that are wider or narrower by 1e-6 of themselves, in N_PATTERNS patterns of
 *                       signs, the first all wider, move no result by more than the promise; of runs with
 *                       STEPS_PREDICTABLE steps per contact
 *
 * Errors of J1, J2, J3 and of the shares are relative, a share below 0.1 % compared as 0.1 %; of the shares the worst
 * counts. Cases in which `fine` fails, J1 is zero or no gap closes are left out and counted, and so are those that are
 * not predictable.
 *
 * Threads  none: timings want the machine to themselves */
#pragma once

#include <stdio.h>

#include "bench/timed_run.h"

/* J1, J2, J3, the shares. */
enum { PROMISED = 4, N_PATTERNS = 8 };
static const double PROMISE[PROMISED] = {1e-3, 3e-3, 1e-2, 1e-2}, STEPS_PREDICTABLE = 32;

typedef enum {
    GAPS_LOG_UNIFORM,
    GAPS_WIDE,
    GAPS_THREE_FLOORS,
    GAPS_SMALL,
    GAPS_GROWING,
    GAPS_EQUAL,
    GAPS_YIELDING,
    GAPS_OFF_CENTRE,
    GAPS_LIFTING,
    GAPS_BUCKLING,
    N_GAPS
} GapKind;

typedef struct {
    const SceneOptions *options;
    const Motion *records; /* (n_records) prepared: those of a front */
    int n_records;
    long n_scenes;     /* of each kind */
    const char *front; /* a design file, simulated under all of the first record; NULL: none */
} PromisePlan;

typedef struct {
    Motion motion; /* its samples are its own: motion_free */
    double duration, width, x[FLOORS_MAX + 2];
    double yield_drift;  /* [-] 0: no storey yields */
    double eccentricity; /* [-] of contacts */
    double radius;       /* [m] of the mat, held down by weight alone; 0: the core is clamped */
    CoreWall wall;
    CoreTheory theory;
} PromiseCase;

/* Scene k of a kind. */
Status promise_case(const PromisePlan *plan, int n_floors, GapKind kind, long k, PromiseCase *out, Err *err);

/* Writes the table as CSV; a line of progress per part to `progress`. cases: those that are predictable, of so many
 * scenes. share_pct: of the cases that hold the promise, or whose error is below the bound of the estimate;
 * wider_pct: the same where all gaps wider by 1e-6 alone decide what is predictable. */
Status promise_write(const PromisePlan *plan, FILE *out, FILE *progress, Err *err);
