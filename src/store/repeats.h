/* store/repeats.h -- a design that was evaluated several times, as the search sees it: one design with a mean.
 *
 *   F            of a design the mean of its evaluations
 *   sd           standard deviation of a single simulation, estimated from all repeats of the run (moga/noise.h)
 *   replicates   simulations behind F: evaluations x sim.replicates
 *
 * A design with an evaluation that failed keeps its first one; the search has taken it off the front. f of the table
 * stays what each evaluation found; unfinished and polished ones are left alone. Without noise nothing changes.
 *
 * Threads  one; the run is written */
#ifndef IMTET_STORE_REPEATS_H
#define IMTET_STORE_REPEATS_H

#include "store/run.h"

Status repeats_join(Run *run, Err *err);

#endif
