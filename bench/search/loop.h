/* bench/search/loop.h -- the loop of the paper's Fig. 6a as its text has it, beside this program's search: `imtet-bench
 * loop`.
 *
 *   1 initial population: the start and a Latin hypercube, simulated
 *   2 radial basis functions of the Euclidean distance interpolate each objective at all designs simulated, kept as
 *     they are: rbf_fit without rbf_tune
 *   3 one generation: tournament, crossover, mutation; the interpolant gives every child its objectives and their error
 *   4 a child whose error is acceptable joins with what was predicted; any other one is simulated and a further centre
 *   5 the population of the next iteration; back to 2
 *
 * The paper stops at a share of nondominated designs in the population, which is written down: all iterations are run.
 * Predictions of members follow the interpolant; those of the last population are simulated at the end, in a row of
 * their own. The search has the same first designs, and as many simulations.
 *
 * Error       local average of leave-one-out errors (rbf/rbf.h), share of the objective's range over the designs
 *             simulated, of the worst objective
 * Hypervolume as of a run (store/store.c): a box about the first sample, from a fifth of its range below the best to the
 *             worst; of simulated designs alone
 * Threads     those of the simulator and the interpolant; the same bytes for any number of them */
#pragma once

#include <stdio.h>

#include "settings/options.h"

typedef struct {
    Settings *settings; /* search.seed is that of the first; search.population of the loop */
    long n_seeds, iterations;
    double error_max; /* that is acceptable; 0: every child is simulated */
} LoopPlan;

/* Rows of iterations and, of the search, generations, as CSV. */
Status loop_run(const LoopPlan *plan, FILE *out, Err *err);
