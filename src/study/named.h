/* study/named.h -- the designs that a study names, simulated with more steps until their error is known.
 *
 * Named are the knee, the best of each objective, and NAMED_SPREAD designs spread over the front (run_spread_out). What
 * a search has picked it has picked partly for its error: a design of a front misses the promise of sim.accuracy more
 * often than a random one (docs/promise.md).
 *
 *   1 the design at 2, 4, 8, ... times the steps per contact (estimate_options) until two runs in a row differ by less
 *     than a third of the promise in every promised measure. The last one is what is known of the design, and that
 *     difference its likely error
 *   2 two copies of it, every gap changed by 1 um, in patterns of signs, at the steps of the run; where they say more
 *     than a third of the promise, or no steps agree in 1, six others, at the steps of 1
 *   3 its error is sqrt(difference^2 + (c sd)^2), sd the standard deviation of the design and its last copies, c that
 *     of Student's distribution for so few runs; never less than a fifteenth of the promise. Where no steps agree, or
 *     sd is above the promise, the design is called unpredictable. docs/measured/named.csv has what this covers
 *   4 the front is formed again with the better values; names move on, and what is named then is looked at as well. All
 *     that are named at a time are looked at together and stored together: a run which is stopped goes on behind them
 *
 * Step sizes and copies of all these designs are tasks side by side; what depends on an answer is asked for in the next
 * wave, of which there are four at most.
 *
 * Of a tower with the engine fast, one replicate for a design; others know no error.
 *
 * Deterministic  at any number of threads and stops; nothing of it reaches the search, and it ends with the next
 *                generation
 * Errors         STATUS_STOPPED: go_on said so, but not before the first ones are stored */
#pragma once

#include "settings/options.h"
#include "store/store.h"

enum { NAMED_SPREAD = 4 };

/* Whether errors can be known. */
int named_are_known(const Settings *s);

/* problem: of the run, by which nobody simulates meanwhile. */
Status named_simulate(RunStore *store, const Settings *used, const Problem *problem, int (*go_on)(void *user),
                      void *user, Err *err);
