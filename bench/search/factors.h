/* bench/search/factors.h -- the tables of `imtet-bench search` on the problems of families.h: what the search reaches
 * beside a plain one and beside other methods.
 *
 *   factor   evaluations that the plain search (search.surrogate = off) needs for what this program has after n,
 *            divided by n; at most FACTOR_MAX, where it is not reached within so many. Of IGD+ and of hypervolume
 *   ratio    of a method's IGD+ (or hypervolume) after n to this program's
 *
 * With a cheap level (levels.h) the factor is that of the search with it to the one without, 4 at most; instead of what
 * the problem is its table has Kendall's tau between the levels.
 *
 * One search to the last budget is read at all of them. IGD+ to the true front (reference.h), normalised by its ranges.
 * Hypervolume in a box about the nondominated designs of this program and of the plain search of the same seed, from
 * the best to the worst and a tenth of the range beyond; nothing is said where this program has none. Both of all
 * designs that succeeded and keep the limits. Medians over the seeds; over the problems the geometric mean, or quartiles.
 *
 * Threads  those of the search */
#ifndef IMTET_BENCH_SEARCH_FACTORS_H
#define IMTET_BENCH_SEARCH_FACTORS_H

#include <stdio.h>

#include "base/status.h"
#include "bench/search/levels.h"
#include "settings/options.h"

typedef struct {
    const Settings *settings; /* of all searches, but for surrogate, survival, seed and limits */
    const char *problems;     /* comma list; NULL: those not kept aside */
    int aside;                /* those kept aside instead */
    Levels levels;            /* a cheap level of every problem; cost 0: none */
    long n_seeds, first_seed;
    long budgets[4];    /* evaluations, ascending; 0: none further */
    const char *keep;   /* folder of the courses, which are not run again; NULL: none */
    int with_methods;   /* the other methods too */
    const char *curves; /* path of a CSV: hypervolume against hours; NULL: none */
} FactorPlan;

/* One line per problem, as they are done, then the means; of other methods one line each. */
Status factors_run(const FactorPlan *plan, FILE *out, Err *err);

#endif
