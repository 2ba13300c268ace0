/* study/polish.h -- a design improved by NLopt on the simulator itself, and whether the gain is more than the noise: a
 * method of study/improver.h.
 *
 *   value = sum_k weight_k f_k / (range of f_k on the front)       of the objectives to be improved, minimised
 *
 *   1 the start is simulated `replicates` times: whether it is noisy at all; then every design tried is a mean of
 *     `replicates`
 *   2 in the unit cube of the box COBYLA (Powell 1994: linear models of every function), where nothing is kept BOBYQA
 *     (Powell 2009: a quadratic model), each step of the descent from the best design so far until it has converged
 *   3 start and end once more, with replicates that no step has used:
 *         error_k = root((sd_start_k^2 + sd_end_k^2) / replicates)
 *   4 both at twice the steps of the engine (analysis/estimate.h), where it has such, or at those by which the run
 *     knows the design: the same gain must be there
 *
 * A gain counts where it is more than POLISH_GAIN_MIN and more than twice sum_k weight_k error_k / range_k (as if all
 * errors went together), and no kept objective lost more than it may and twice its error. With a single replicate the
 * standard deviation is not known, and runs with noise are refused unless they are of the tower.
 *
 * Guards   a failed simulation is a finite wall, never NaN; whole numbers and choices stay
 * Repeats  both methods are deterministic, and ask for one design after the other */
#pragma once

#include "study/improver.h"

/* Of the value: a practical threshold, in ranges of the front. */
static const double POLISH_GAIN_MIN = 1e-3;

/* Designs of the path: the start by its first replicates and by fresh ones, and what came of it, by the same. */
enum { POLISH_START, POLISH_BEFORE, POLISH_END };

/* An ImproveMethod. */
Status polish_design(Improver *m, Err *err);

/* Step 2 alone: from m->x, whose value is m->value; all else of m is there. */
Status polish_descend(Improver *m, Err *err);

/* Refused: noisy answers of others than the tower, which is simulated with replicates. */
Status polish_allows(const Settings *s, Err *err);

/* Simulations that it takes to try one design: steps 1, 3 and 4 and that one. */
size_t polish_evals_min(const Settings *s, long replicates);

/* A gain that is significant, or of which no standard deviation is known; and all else kept. */
int polish_counts(const Improved *r);
