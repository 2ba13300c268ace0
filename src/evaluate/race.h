/* evaluate/race.h -- the records by which a design is judged first: those that speak most for all of a suite.
 *
 *   of a sample of designs y_S: an objective by the study's rule over the records S alone, y: over all of them
 *   forward selection: S grows by the record with which a line on y_S explains most of the variance of y (R^2, mean
 *   over the objectives that differ between designs)
 *
 * Source   forward selection of variables in regression: Efroymson, in: Mathematical Methods for Digital Computers
 *          (1960) 191-203
 * Threads  pure functions */
#pragma once

#include "base/status.h"

enum { RACE_FIRST_MAX = 4 }; /* what a few say of all depends on how many they are, hardly on how many all are */

/* Records that a design sees first, of so many: a fifth, RACE_FIRST_MAX at most. */
static inline size_t race_first(size_t n_records)
{
    return n_records < 10 ? 1 : MIN_OF(n_records / 5, (size_t)RACE_FIRST_MAX);
}

/* y (n_designs, n_obj) over n records; NAN: the design failed. */
typedef void RaceResults(size_t n, const size_t records[], double y[], void *user);

/* order (n_records): race_first of them as they were selected, then the others. */
Status race_order(size_t n_records, size_t n_designs, size_t n_obj, RaceResults *results, void *user, size_t order[],
                  Err *err);
