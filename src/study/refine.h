/* study/refine.h -- a design of a run polished, and whether the gain is more than the noise.
 *
 *   value = sum_k weight_k f_k / (range of f_k on the front)       of the objectives to be improved, minimised
 *
 *   1 the design is simulated `replicates` times: what the kept objectives may lose (one standard deviation of a single
 *     simulation, or their slack), and whether it is noisy at all; then every design tried is a mean of `replicates`
 *   2 NLopt on the simulator (study/polish.h)
 *   3 design and result once more, with replicates that no step has used:
 *         error_k = root((sd_start_k^2 + sd_end_k^2) / replicates)
 *   4 both at twice the steps of the engine (analysis/estimate.h), where it has such, or at those by which the run
 *     knows the design: the same gain must be there
 *
 * A gain counts where it is more than REFINE_GAIN_MIN and more than twice sum_k weight_k error_k / range_k (as if all
 * errors went together), and no kept objective lost more than it may and twice its error. With a single replicate the
 * standard deviation is not known, and runs with noise are refused unless they are of the tower.
 *
 * Ownership  refine_design fills the caller's Refined; refined_free releases what it allocated
 * Threads    call it from one thread; replicates share the simulator's workers, the numbers do not depend on how many
 *            */
#pragma once

#include "store/run.h"

/* Of the value: a practical threshold, in ranges of the front. */
static const double REFINE_GAIN_MIN = 1e-3;

typedef struct {
    double weight[OBJECTIVES_MAX]; /* >= 0; 0: not to be improved */
    double slack[OBJECTIVES_MAX]; /* share of its value that an objective may lose; < 0: one deviation; INFINITY: all */
    long replicates;              /* of a tower; other problems: 1 */
    size_t max_evals;             /* simulations, those of all steps together */
    int (*go_on)(void *user);     /* asked before each simulation, NULL: yes; 0: STATUS_STOPPED, nothing is refined */
    void *user;
} RefineConfig;

typedef struct {
    EvaluationTable designs;                   /* (2) start and end, as simulated in step 3 */
    double error[OBJECTIVES_MAX];              /* likely integration error of both, the greater one; NAN: not known */
    double gain, gain_error;                   /* of the value, > 0 is better; error NAN: not known */
    double gain_finer;                         /* of step 4; NAN: there is none */
    size_t n_evaluated, n_failed, n_simulated; /* designs, of them failed; simulations */
    double seconds;
    int has_changed; /* 0: nothing better was found, the end is the design itself */
    int keeps;       /* what was to be kept is */
} Refined;

/* Refused: noisy answers of others than the tower, which is simulated with replicates. */
Status refine_allows(const Settings *s, Err *err);

/* The design in row `row` of the run, with the settings that it was made with. */
Status refine_design(const Run *h, size_t row, const RefineConfig *config, Refined *out, Err *err);
void refined_free(Refined *r);

/* Simulations that it takes to try one design: steps 1, 3 and 4 and that one. */
size_t refine_evals_min(const Settings *s, long replicates);

/* A gain that is significant, or of which no standard deviation is known; and all else kept. */
int refined_counts(const Refined *r);
