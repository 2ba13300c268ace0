/* moga/search.h -- surrogate-assisted NSGA-III: the search for the Pareto front.
 *
 *   1 Initial sample (generation.c)
 *       Latin hypercube and given designs, evaluated
 *   2 Surrogate (surrogate.h)
 *       RBF interpolant of the archive; hyperparameters are tuned now and then. Of an output with waves along single
 *       variables the kernel gets an additive part (rbf/rbf.h). Used while its leave-one-out errors are small enough
 *   3 Offspring (offspring.c): tournament, SBX, polynomial mutation
 *       evolved     INNER_GENERATIONS generations of variation and selection on the surrogate
 *       descended   descents on the surrogate along reference vectors, from the best design of each
 *       probes      designs of the front with one variable anywhere else, where objectives have waves
 *       variation   children of the population, where the surrogate is not used or proposes nothing new
 *   4 Infill selection of a batch (offspring.c)
 *       infill      those with the greatest gain by two criteria in turn, PBI and hypervolume (infill.h); a gain is
 *                   that of lower confidence bounds, prediction minus OPTIMISM times its error in every objective:
 *                   where the surrogate errs more there is more to find
 *       probes      PROBE_SHARE times the share of objectives with waves: what a surrogate knows of one valley says
 *                   nothing of the others, and what is gained at once is no measure of it
 *       limits      a gain counts with the probability that the design succeeds and keeps every limit; descents turn
 *                   back where a limit is violated or a failure predicted
 *   5 Evaluation (generation.c), with replicates where evaluations are noisy (replication.c); with FIDELITY_REPLICATES
 *     by the cheap level, and in full for those that promise most (screening.c)
 *   6 Environmental selection (selection.h)
 *       NSGA-III among members and results; other designs are dropped. Back to 2
 *
 * Reproducible  random streams are keyed by (seed, generation, individual): the same bytes at any thread count; no
 *               clock is read but for max_seconds
 * Never twice   a design that is in the archive, failed ones too, is not evaluated again, except as a replicate
 * Noise         a share replicate_share of the evaluations, beyond the first REPLICATE_AFTER for each variable, goes to
 *               replicates of the front: the best in each objective and the knee, then the best for most reference
 *               vectors. A design has the mean of its replicates, and dominance asks for more than the standard
 *               errors (moga/archive.h). Standard deviations below a thousandth of the front's range end replication
 * Threads       evaluations go through a queue (evaluate/queue.h) to as many workers as the problem has; a batch is
 *               asked for, then taken in that order. Set BLAS to one thread
 * Asynchronous  the same queue in the order of arrival: no worker waits for the slowest of a batch, and the next one is
 *               selected while the last designs of this one wait or are under way. Those count as their predictions, so
 *               that no design near them is selected. A generation ends with the first results that arrive, all but
 *               those that keep the workers busy: none at one worker, else the workers and a quarter of a batch more.
 *               Rows of the archive are in the order of arrival, and a run is a function of that order alone: the same
 *               order, the same bytes, at one worker those of a search in batches
 * Resumed       from the evaluations and the state of any generation's end (SearchView.state), to the same bytes as if
 *               it had not stopped. The state is what the evaluations do not tell: population, hyperparameters, running
 *               means. A new variable that outlives a generation is one more line in pack_search (state.c), and
 *               STATE_VERSION one higher
 * Converged     stop_after evaluations that gain no more hypervolume than its standard error end the search
 *               (moga/convergence.h)
 * Ownership     search_run owns all it allocates; a SearchView is valid inside the callback only
 * Sources       Deb and Jain, IEEE Trans. Evol. Comput. 18 (2014) 577-601 (NSGA-III)
 *               Deb and Agrawal, Complex Systems 9 (1995) 115-148 (SBX)
 *               Cox and John, SDO: a statistical method for global optimization, SIAM 1997, 315-329 (lower confidence
 *               bounds)
 *               Rippa, Adv. Comput. Math. 11 (1999) 193-210 (leave-one-out)
 * Constants     moga/constants.h; what each is worth: docs/search.md */
#pragma once

#include "evaluate/problem.h"
#include "moga/config.h"

typedef enum {
    STOP_NONE,
    STOP_GENERATIONS,
    STOP_EVALUATIONS,
    STOP_TIME,
    STOP_SHARE,
    STOP_CONVERGED,
    STOP_ASKED,
    STOP_FAILURES
} StopReason;
const char *stop_reason_words(StopReason reason);

/* All evaluations so far, in their order; row i is design number i + 1. */
typedef struct {
    size_t n, n_var, n_obj, n_con;
    const double *X, *Y, *H;       /* (n, n_var) (n, n_obj) (n, n_con) design, objectives and constraints of each row */
    const double *F;               /* (n, n_obj) of a design's first row: mean of its replicates */
    const double *sd;              /* (n, n_obj) ... standard deviation of one replicate */
    const size_t *replicates;      /* (n) ... how many; of further replicates 0 */
    const unsigned char *ok;       /* (n) 0: failed */
    const unsigned char *kind;     /* (n) EvaluationKind */
    const size_t *generation;      /* (n) */
    const unsigned char *on_front; /* (n) feasible, nondominated */
    size_t n_front, n_failed;
    size_t n_replicates;    /* rows that are further replicates */
    size_t n_evaluations;   /* of max_evals: n, less what screened designs are not simulated */
    size_t n_screened;      /* designs evaluated by the cheap level first */
    double level_agreement; /* Kendall's tau of the levels, mean over the objectives; NAN: not known */
    int has_left_screening; /* it is too low: nothing is screened any more */
    size_t generation_now;
    size_t n_left_out;      /* objectives and constraints that the surrogate leaves out: their mean stands for them */
    double surrogate_error; /* median leave-one-out error, share of range, worst objective; NAN: no surrogate yet */
    double seconds;
    double waited_s;    /* of `seconds`: waiting for evaluations */
    double surrogate_s; /* ... fits, predictions, descents; the rest is search */
    int is_asynchronous;
    int is_last;       /* the search ends by itself; none follows */
    const void *state; /* (n_state bytes) of the search at this moment; NULL: no memory for it */
    size_t n_state;
} SearchView;

/* Called after the start and after every generation; return non-zero to stop. */
typedef int (*ObserveFn)(const SearchView *view, void *user);

Status search_run(const Problem *problem, const SearchConfig *config, ObserveFn observe, void *user, StopReason *reason,
                  Err *err);

/* Resumed at `start` (NULL: from the beginning). Problem and configuration must be those of the search that wrote
 * the state, but for the limits (generations, max_evals with planned_evals set, max_seconds). A state that does not fit
 * is STATUS_BAD_DATA. A search that has reached its limits evaluates nothing and does not call observe. */
Status search_resume(const Problem *problem, const SearchConfig *config, const SearchStart *start, ObserveFn observe,
                     void *user, StopReason *reason, Err *err);
