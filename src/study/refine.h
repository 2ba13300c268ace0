/* study/refine.h -- a design of a run polished, and whether the gain is more than the noise.
 *
 *   value = sum_k weight_k f_k / (range of f_k on the front)       of the objectives to be improved, minimised
 *
 *   1 the design is simulated `replicates` times: what the kept objectives may lose (one standard deviation of a single
 *     simulation, or `slack`), and whether it is noisy at all; then every design tried is a mean of `replicates`
 *   2 a surrogate of the nearest evaluations and the simulator in turn (study/local.h)
 *   3 NLopt's `algorithm` on the simulator from the best so far (study/polish.h), with half of the simulations where
 *     it was asked for by name, else COBYLA with what step 2 leaves
 *   4 design and result once more, with replicates that no step has used:
 *         error_k = root((sd_start_k^2 + sd_end_k^2) / replicates)
 *   5 both at twice the steps of the engine (analysis/estimate.h), where it has such: the same gain must be there
 *
 * A gain counts where it is more than gain_min (a practical threshold) and more than twice sum_k weight_k error_k / range_k
 * (as if all errors went together), and no kept objective lost more than it may and twice its error. With a single replicate the standard deviation is not known,
 * and runs with noise are refused unless they are of the tower.
 *
 * Ownership  refine_design fills x, f, ... of the caller's Refined; refined_free releases what it allocated
 * Threads    call it from one thread; replicates and the designs of a round share the simulator's workers, the
 *            numbers do not depend on how many */
#ifndef IMTET_STUDY_REFINE_H
#define IMTET_STUDY_REFINE_H

#include "store/run.h"

typedef struct {
    const char *algorithm;     /* study/polish.h; NULL: as the steps above say */
    const double *weight;      /* (n_obj) >= 0; 0: not to be improved */
    const unsigned char *keep; /* (n_obj) */
    double slack;              /* share of the value; < 0: one spread */
    double gain_min;           /* [-] of the value: a practical threshold, in ranges of the front */
    long replicates;           /* of a tower; other problems: 1 */
    size_t max_evals;          /* simulations, those of all steps together */
    double max_seconds;        /* 0: no limit */
    int (*go_on)(void *user);  /* asked before each simulation, NULL: yes; 0: STATUS_STOPPED and nothing is refined */
    void *user;
} RefineConfig;

typedef struct {
    double *x, *f_start, *f, *spread_start, *spread; /* (n_var), (n_obj) natural; of step 4 */
    double *error;           /* (n_obj) estimated integration error of both, the greater one; NAN: not known */
    double *extra;           /* (n_extra) of the end */
    double gain, gain_error; /* of the value, > 0 is better; error NAN: not known */
    double gain_finer;       /* of step 5; NAN: there is none */
    double gain_min;         /* of the config */
    double violation;        /* of the user's limits */
    size_t n_evaluated, n_failed, n_simulated; /* designs, of them failed; simulations */
    double seconds;
    int has_changed; /* 0: nothing better was found, x is the design itself */
    int keeps;       /* what was to be kept is */
} Refined;

/* Refused: noisy answers of others than the tower, which is simulated with replicates. */
Status refine_allows(const Settings *s, Err *err);

/* The design in row `row` of the run, with the settings that it was made with. */
Status refine_design(const Run *h, size_t row, const RefineConfig *config, Refined *out, Err *err);
void refined_free(Refined *r);

/* Simulations that it takes to try one design: steps 1, 4 and 5 and that one. */
size_t refine_evals_min(const Settings *s, long replicates);

/* A gain above gain_min that is significant, or of which no standard deviation is known; and all else kept. */
int refined_counts(const Refined *r);

/* As a run stores it; borrows x, f, spread and extra. */
Evaluation refined_evaluation(const Refined *r);

#endif
