/* bench/promise.h -- how often the engine `fast` holds what docs/trust.md promises: quantiles of its errors against
 * `fine` over many windows and over the designs of a front, and of `fine` against CVODE.
 *
 *   window k   of record k mod n: 8 to 15 s that begin somewhere in the strong shaking, from rest
 *   design k   gaps of 1 to 200 mm, in half of the windows log-uniform, else uniform; core of 4 to 40 mm, bending with
 *              and without shear deformation in turn
 *
 * Errors of J1, J2, J3 and of the shares are relative, a share below 0.1 % compared as 0.1 %; of the shares the worst
 * counts. Cases in which `fine` fails or J1 is zero are left out and counted.
 *
 * Threads  none: timings want the machine to themselves */
#ifndef IMTET_BENCH_PROMISE_H
#define IMTET_BENCH_PROMISE_H

#include <stdio.h>

#include "bench/timed_run.h"

/* J1, J2, J3, the shares: each held by PROMISE_SHARE of the windows at `standard`. */
enum { PROMISED = 4 };
static const double PROMISE[PROMISED] = {1e-3, 3e-3, 1e-2, 1e-2}, PROMISE_SHARE = 0.95;

typedef struct {
    const SceneOptions *options;
    const Motion *records; /* (n_records) prepared */
    int n_records;
    long n_windows;
    const char *front; /* a design file, simulated under all of the first record; NULL: none */
} PromisePlan;

typedef struct {
    Motion motion; /* its samples are the record's */
    double duration, x[FLOORS_MAX + 2];
    CoreTheory theory;
} PromiseCase;

/* Window k of the plan, with its design. */
void promise_window(const PromisePlan *plan, int n_floors, long k, PromiseCase *out);

/* Writes the table as CSV; a line of progress per part to `progress`. share_pct: of the cases that hold the promise, or
 * whose error is below the estimate. */
Status promise_write(const PromisePlan *plan, FILE *out, FILE *progress, Err *err);

#endif
