/* bench/search/factors.h -- the tables of `imtet-bench search` on the problems of families.h: what the search reaches
 * beside a plain one, NSGA-III (Deb and Jain 2014).
 *
 *   factor   evaluations that the plain search (search.surrogate = off) needs for what this program has after n,
 *            divided by n; at most FACTOR_MAX, where it is not reached within so many. Of IGD+ and of hypervolume
 *
 * One search to the last budget is read at all of them. IGD+ to the true front (reference.h), normalised by its ranges.
 * Hypervolume in a box about the nondominated designs of this program and of the plain search of the same seed, from
 * the best to the worst and a tenth of the range beyond; nothing is said where this program has none. Both of all
 * designs that succeeded and keep the limits. Medians over the seeds; over the problems the geometric mean.
 *
 * Threads  those of the search */
#pragma once

#include <stdio.h>

#include "bench/search/course.h"
#include "settings/options.h"

typedef struct {
    const Settings *settings; /* of all searches, but for surrogate, seed and limits */
    const char *problems;     /* comma list; NULL: those not kept aside */
    int aside;                /* Family.is_aside of those that are run */
    long n_seeds, first_seed;
    long budgets[4]; /* evaluations, ascending; 0: none further */
} FactorPlan;

/* A search that fills an empty course. */
Status search_course(const Settings *s, const Problem *p, SurrogateUse surrogate, Course *c, Err *err);

/* One line per problem, as they are done, then the means. */
Status factors_run(const FactorPlan *plan, FILE *out, Err *err);
