/* analysis/estimate.h -- the integration error of a result, estimated from the same design at twice the steps.
 *
 *   error of measure m = ESTIMATE_FACTOR |m(steps) - m(2 steps)|
 *
 * The factor is calibrated: the error against `fine` is below the estimate in 95 % of the windows of docs/promise.md
 * (`make promise` prints the share and how much too large the estimate is). Of the engine `fast` alone.
 *
 * Threads  pure functions; estimate_designs simulates on workers of its own */
#ifndef IMTET_ANALYSIS_ESTIMATE_H
#define IMTET_ANALYSIS_ESTIMATE_H

#include "evaluate/tower.h"

static const double ESTIMATE_FACTOR = 9;

/* The options of the second run; 0: there is none by this engine. */
int estimate_options(const SimOptions *o, SimOptions *finer);

/* error (N_MEASURES), in the unit of each; not numbers where one of the two runs failed. */
void estimate_errors(const SimResult *result, const SimResult *finer, double error[]);

/* The same for n results of the tower under motion.record alone, by simulating the tasks once more: error (n, N_MEASURES).
 * s: of the results, sim.engine = fast. */
Status estimate_designs(const Settings *s, size_t n, const SimTask tasks[], const SimResult results[], double error[],
                        Err *err);

#endif
