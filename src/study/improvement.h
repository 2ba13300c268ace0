/* study/improvement.h -- what a run may still gain. */
#pragma once

#include "store/run.h"

/* Hypervolume that as many simulations again would gain (moga/convergence.h), NAN: nothing is known, or designs are
 * finished at the end (search.fidelity). */
Status improvement_expected(const Run *run, double *gain, Err *err);
