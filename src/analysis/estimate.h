/* analysis/estimate.h -- how far the numbers of a result can be trusted: the integration error, estimated from the same
 * design at twice the steps, and how much they move where the gaps do by less than anybody can measure.
 *
 *   likely error of measure m = |m(steps) - m(2 steps)|        bound = ESTIMATE_FACTOR times that
 *   sd of measure m = standard deviation of the design and of ESTIMATE_PATTERNS others, whose gaps are all wider or
 *                     narrower by ESTIMATE_GAP_M, by a pattern of signs that is the same for every design
 *
 * A contact that grazes is found by the second alone: the first compares runs that both meet it. The factor is
 * calibrated: the error against `fine` is below the bound for 95 % of the figures of docs/promise.md (`make promise`
 * prints the share and the ratio of the true to the likely error). Of the engine `fast` alone.
 *
 * Threads  estimate_errors is pure; estimate_designs has the workers of the problem */
#pragma once

#include "evaluate/tower.h"

static const double ESTIMATE_FACTOR = 9, ESTIMATE_GAP_M = 1e-6;
enum { ESTIMATE_PATTERNS = 5 };

/* error (N_MEASURES): the likely ones, in the unit of each; not numbers where one of the two runs failed. */
void estimate_errors(const Measured *result, const Measured *finer, double error[]);

/* The same for n results of single simulations, by simulating the tasks again: error, sd (n, N_MEASURES), sd not
 * numbers where a run failed or no gap is in the scene; sd NULL: not wanted, and simulated once instead of
 * 1 + ESTIMATE_PATTERNS times. The engine is fast. */
Status estimate_designs(const Problem *p, size_t n, const SimTask tasks[], const SimResult results[], double error[],
                        double sd[], Err *err);
