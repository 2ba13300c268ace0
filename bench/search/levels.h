/* bench/search/levels.h -- a problem of families.h with a cheap level, and the search that screens by it.
 *
 *   cheap_k(x) = 0.8 f_k(x) + sd_k (off s_k(x) - 3)
 *
 *   sd   of f_k over the box
 *   s_k  a smooth function of unit variance, waves in random directions: what a coarse mesh does to an answer
 *   3    a bias by which any cheap answer dominates any whole one
 *
 * Limits and failures are those of the whole. Sources: Rahimi and Recht, Random features for large-scale kernel machines,
 * NIPS 2007 (s_k).
 *
 * Threads  no state */
#ifndef IMTET_BENCH_SEARCH_LEVELS_H
#define IMTET_BENCH_SEARCH_LEVELS_H

#include "bench/search/course.h"
#include "settings/options.h"

typedef struct {
    double off;  /* deviation of the cheap level, in standard deviations of an objective */
    double cost; /* of the cheap level, a whole evaluation is 1 */
} Levels;

/* As a Method (methods.h), of as many whole evaluations as c has room for; c has the designs evaluated as a whole, filled
 * up by some that do not count. p stays the caller's. */
Status run_levels(const Settings *s, const Problem *p, const Levels *levels, Course *c, Err *err);

/* Kendall's tau of the two levels over random designs, mean over the objectives. */
Status levels_agreement(const Problem *p, const Levels *levels, double *tau, Err *err);

#endif
