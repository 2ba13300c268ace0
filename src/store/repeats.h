/* store/repeats.h -- a design that was simulated several times, as the search sees it: one design with a mean.
 *
 *   F         of a design the mean of its answers
 *   spread    standard deviation of a single simulation, as far as all repeats of the run tell (moga/spread.h)
 *   members   simulations behind F: answers x sim.ensemble
 *
 * A design with an answer that failed keeps its first one; the search has taken it off the front.
 * Rows of repeats keep what they answered; unfinished and polished ones are left alone. Where answers are not noisy
 * nothing changes.
 *
 * Threads  one; h is written */
#ifndef IMTET_STORE_REPEATS_H
#define IMTET_STORE_REPEATS_H

#include "store/run.h"

Status repeats_join(Run *h, Err *err);

#endif
