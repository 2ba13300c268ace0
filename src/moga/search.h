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
 *   5 Questions (generation.c), of replicates too where evaluations are noisy (replication.c); with FIDELITY_REPLICATES
 *     by the cheap level, and in full for those that promise most (screening.c). The client evaluates and tells
 *   6 Environmental selection (selection.h)
 *       NSGA-III among members and results; other designs are dropped. Back to 2
 *
 * Look-ahead    questions are made in groups, and no group waits for all answers to those before: it is made from the
 *               answers to all questions but the last common_ahead ones, whether these are there or not; those count as
 *               their predictions, so that no design near them is chosen. Which answers a question is made from follows
 *               from its number alone
 * Reproducible  random streams are keyed by (seed, generation, individual), no clock is read and nothing depends on who
 *               evaluates or in what order the answers are told: the same bytes for any number of workers
 * Never twice   a design that is in the archive, failed ones too, is not evaluated again, except as a replicate
 * Noise         a share replicate_share of the evaluations, beyond the first REPLICATE_AFTER for each variable, goes to
 *               replicates of the front: the best in each objective and the knee, then the best for most reference
 *               vectors. A design has the mean of its replicates, and dominance asks for more than the standard
 *               errors (moga/archive.h). Standard deviations below a thousandth of the front's range end replication
 * Resumed       from the evaluations that had entered and the state (search_state), to the same bytes as if it had not
 *               stopped: what was under way is asked for again. The state is what the evaluations do not tell:
 *               population, hyperparameters, questions under way. A new variable that outlives a step is one more line
 *               in state_pack (state.c), and STATE_VERSION one higher
 * Converged     stop_after evaluations that gain no more hypervolume than its standard error end the search
 *               (moga/convergence.h); whatever ends it, what is under way enters first
 * Life cycle    search_create -> search_ask, search_tell ... -> search_free; borrows problem and configuration
 * Threads       one at a time; fits and predictions use several (OpenMP). Set BLAS to one thread
 * Sources       Deb and Jain, IEEE Trans. Evol. Comput. 18 (2014) 577-601 (NSGA-III)
 *               Deb and Agrawal, Complex Systems 9 (1995) 115-148 (SBX)
 *               Cox and John, SDO: a statistical method for global optimization, SIAM 1997, 315-329 (lower confidence
 *               bounds)
 *               Rippa, Adv. Comput. Math. 11 (1999) 193-210 (leave-one-out)
 * Constants     moga/constants.h; what each is worth: docs/search.md */
#pragma once

#include "evaluate/problem.h"
#include "moga/archive.h"
#include "moga/config.h"
#include "moga/question.h"

const char *stop_reason_words(StopReason reason);

typedef struct Search Search;

/* start NULL: from the beginning; else problem and configuration must be those of the search that wrote the state, but
 * for the limits (max_evals with planned_evals set). A state that does not fit is STATUS_BAD_DATA. Where it fails *out
 * is what there is of it, for search_free. */
Status search_create(Search **out, const Problem *problem, const SearchConfig *config, const SearchStart *start,
                     Err *err);
void search_free(Search *s); /* NULL is fine */

typedef enum {
    SEARCH_ASKS,  /* here is a question */
    SEARCH_WAITS, /* for the answer to the first question that is not told */
    SEARCH_STEPS, /* answers have entered: look, save the state; then ask again */
    SEARCH_ENDS   /* every question is answered and has entered */
} SearchMove;

/* What the search does next; q is set where it asks. */
Status search_ask(Search *s, SearchMove *move, Question *q, Err *err);

/* The answer to a question, in any order; parts of its cheap level, which are copied, NULL: they are not known. */
Status search_tell(Search *s, size_t number, const Evaluation *e, const void *parts, Err *err);

/* Questions that may be under way at once, at most, behind the initial sample. */
size_t search_at_once(const Problem *p, const SearchConfig *c);

/* Nothing more is asked for this reason; what is under way enters. */
void search_stop(Search *s, StopReason reason);

/* What is known; rows have their results after a step alone, else screened ones what is expected of them. */
typedef struct {
    const Archive *all;     /* rows in the order of the questions: row i is design number i + 1 */
    size_t n_evaluations;   /* of max_evals: all->n, less what screened designs are not simulated */
    size_t n_screened;      /* designs evaluated by the cheap level first */
    double level_agreement; /* Kendall's tau of the levels, mean over the objectives; NAN: not known */
    int has_left_screening; /* it is too low: nothing is screened any more */
    size_t generation;
    size_t n_left_out;      /* objectives and constraints that the surrogate leaves out: their mean stands for them */
    double surrogate_error; /* median leave-one-out error, share of range, worst objective; NAN: no surrogate yet */
    StopReason reason;      /* why it has ended; STOP_NONE: it goes on */
    const void *state;      /* (n_state bytes) the search as it is now but for the rows; NULL: no memory for it */
    size_t n_state;
} SearchView;

/* At any time; holds until the next call on the search. */
SearchView search_look(Search *s);
