/* sim/tolerance.h -- the steps per contact that a relative error needs: the setting sim.tolerance.
 *
 *   steps = 2 (0.01 / tolerance)^(2/3)
 *
 * so that J3 and the shares, which converge last, err by less than the tolerance in 95 % of the windows of docs/promise.md:
 * 2e-2, 7e-3 and 2e-3 were measured at 1, 2 and 4 steps. Core modes, tolerances of a step and the end of the contacts
 * follow the steps (sim/fast/fast.h). The presets of sim.accuracy are names: standard of 0.01, coarse of about 0.05.
 *
 * auto: a tenth of the standard deviation of J3 that gaps as built (sim.gap_tolerance_m) make, medians of 40 designs:
 * 0.0014, 0.009, 0.056, 0.10 and 0.15 at 0.01, 0.1, 1, 5 and 10 mm.
 *
 * Threads  pure functions */
#ifndef IMTET_SIM_TOLERANCE_H
#define IMTET_SIM_TOLERANCE_H

#include "sim/options.h"

/* Of o->tolerance (none, auto or a number); 0: steps are as accuracy and steps_per_contact say. A text that is no
 * number from 1e-6 to 0.2, and one beside steps_per_contact, are refused. */
Status tolerance_steps(const SimOptions *o, double *steps, Err *err);

/* [-] Relative error of J3 for auto; 0: gaps are built as designed. */
double tolerance_as_built(double gap_tolerance_m);

#endif
