/* bench/search/factors.h -- how many evaluations a plain search needs for what the surrogate reached: the table of
 * `imtet-bench search` on the problems of families.h.
 *
 *   factor   evaluations of the plain search (search.surrogate = off) until its hypervolume is that of the surrogate
 *            after n, divided by n; at most FACTOR_MAX, where it is not reached within so many
 *
 * Hypervolume in a box about the nondominated designs of both, from the best to the worst and a tenth of the range
 * beyond, of all designs that keep the limits. Medians over the seeds; the geometric mean over the problems.
 *
 * Threads  those of the search */
#ifndef IMTET_BENCH_SEARCH_FACTORS_H
#define IMTET_BENCH_SEARCH_FACTORS_H

#include <stdio.h>

#include "base/status.h"
#include "settings/options.h"

typedef struct {
    const Settings *settings; /* of both searches, but for surrogate, seed and limits */
    const char *problems;     /* comma list; NULL: those not kept aside */
    int aside;                /* those kept aside instead */
    long n_seeds, first_seed;
    long budgets[4]; /* evaluations, ascending; 0: none further */
} FactorPlan;

/* One line per problem, as they are done, then the means. */
Status factors_run(const FactorPlan *plan, FILE *out, Err *err);

#endif
