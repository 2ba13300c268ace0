/* analysis/estimate.h -- the integration error of a result, estimated from the same design at twice the steps.
 *
 *   likely error of measure m = |m(steps) - m(2 steps)|        bound = ESTIMATE_FACTOR times that
 *
 * The factor is calibrated: the error against `fine` is below the bound in 95 % of the windows of docs/promise.md
 * (`make promise` prints the share and how much too large the bound is). Of the engine `fast` alone.
 *
 * Threads  estimate_errors is pure; estimate_designs has the workers of the problem */
#ifndef IMTET_ANALYSIS_ESTIMATE_H
#define IMTET_ANALYSIS_ESTIMATE_H

#include "evaluate/tower.h"

static const double ESTIMATE_FACTOR = 9;

/* error (N_MEASURES): the likely ones, in the unit of each; not numbers where one of the two runs failed. */
void estimate_errors(const Measured *result, const Measured *finer, double error[]);

/* The same for n results of single simulations, by simulating the tasks once more: error (n, N_MEASURES). The engine
 * is fast. */
Status estimate_designs(const Problem *p, size_t n, const SimTask tasks[], const SimResult results[], double error[],
                        Err *err);

#endif
