/* simulator/estimate.h -- the integration error of a result, estimated from the same design at twice the steps.
 *
 *   error of measure m = ESTIMATE_FACTOR |m(steps) - m(2 steps)|
 *
 * The factor is calibrated: the error against `fine` is below the estimate in 95 % of the windows of docs/promise.md
 * (`make promise` prints the share and how much too large the estimate is). Of the engine `fast` alone.
 *
 * Threads  pure functions */
#ifndef IMTET_SIMULATOR_ESTIMATE_H
#define IMTET_SIMULATOR_ESTIMATE_H

#include "simulator/measures.h"

static const double ESTIMATE_FACTOR = 9;

/* The options of the second run; 0: there is none by this engine. */
int estimate_options(const SimOptions *o, SimOptions *finer);

/* error (N_MEASURES), in the unit of each; not numbers where one of the two runs failed. */
void estimate_errors(const SimResult *result, const SimResult *finer, double error[]);

#endif
