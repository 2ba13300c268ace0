/* moga/search.h -- the surrogate-assisted search for the Pareto front.
 *
 *   1 Latin hypercube start, simulated
 *   2 a radial basis response surface on what has been simulated (moga/surrogate.h)
 *   3 tournament selection, SBX, polynomial mutation: one offspring population, bred over a few generations on the
 *     surface, and designs that descend the surface along reference directions; where the surface explains too little,
 *     plain children
 *   4 every offspring predicted; where the leave-one-out based error estimate is small the prediction stands, of the
 *     others those that promise most are simulated and become new centres (moga/infill.h), the rest is forgotten.
 *     A few predictions that stand are checked by simulation, first those that have stood for long. Predicted and true
 *     order of every batch are compared (Kendall's tau); while they disagree, batches are plain children. What promises
 *     most is measured in two ways, which share a batch by what they gain; once there are many simulations a few of
 *     every batch are plain children that promise most, and most of it while these gain more. A design one of whose
 *     three nearest simulated ones failed is not chosen, and plain children take the share of a batch that fails
 *   5 environmental selection with reference directions (NSGA-III, moga/selection.h); back to 2
 *
 * Predicted designs may live in the population; only simulated ones enter the archive, and the front is made of the
 * archive alone.
 *
 * Reproducible  random streams are keyed by (seed, generation, individual): the same bytes at any thread count;
 *               no clock is asked but for SURROGATE_AUTO and max_seconds
 * Never twice   a design that is in the archive, failed ones too, is not simulated again, but where answers are noisy
 * Noise         a share `repeats` of the simulations, beyond the first 18 for each variable, goes to the front: the
 *               best in each objective, the nearest to the ideal, then the best in most directions; a quarter of it
 *               while the search goes on, the rest at its end. A design has the mean of its answers, and dominance
 *               asks for more than the errors (moga/archive.h). Where the spread is more than a fifth of the front's
 *               range, parents, survivors and what is to be beaten are compared by estimates, means that the surface
 *               has corrected within their errors (moga/noise.h). A spread below a thousandth of the range ends the
 *               repeats
 * Threads       simulations go through a queue (evaluate/queue.h) to as many workers as the problem has; a batch is
 *               asked for, then taken in that order. Set BLAS to one thread
 * Asynchronous  the same queue in the order of arrival: no worker waits for the slowest of a batch, and the next one is
 *               chosen while the last designs of this one wait or are simulated. Those count as
 *               what the surface predicts, so that no place is chosen twice. A generation ends with the first
 *               results that arrive, all but `lead` of those that are asked for; lead is 0 at one worker, else the
 *               workers and a quarter of a batch more. Rows of the archive are in the order of arrival, and a run
 *               is a function of that order alone: the same order, the same bytes, at one worker those of a search
 *               in batches
 * Goes on       from the simulations and the state of any generation's end (SearchView.state): the rest is then the
 *               same, bit by bit, as if it had never stopped. The state is what the simulations do not tell:
 *               population, forms and scales of the surface, running means. A new variable that outlives a
 *               generation is one more line in state_pack (state.c), and STATE_VERSION one higher
 * Ownership     search_run owns all it allocates; a SearchView is valid inside the callback only
 * Sources       Deb and Jain, IEEE Trans. Evol. Comput. 18 (2014) 577-601 (NSGA-III); Deb and Agrawal, Complex
 *               Systems 9 (1995) 115-148 (SBX); Rippa, Adv. Comput. Math. 11 (1999) 193-210 (leave-one-out). */
#ifndef IMTET_MOGA_SEARCH_H
#define IMTET_MOGA_SEARCH_H

#include <stdint.h>

#include "evaluate/problem.h"
#include "moga/options.h"

typedef struct {
    uint32_t seed;
    size_t population, generations, max_evals, surrogate_max;
    size_t planned_evals; /* 0: max_evals. First sample and directions of infill are chosen for so many simulations;
                             of two searches that differ in max_evals only, one is then the beginning of the other */
    size_t initial;       /* 0: by the number of variables */
    const double *given;  /* (n_given, n_var) designs to be simulated first, moved into the box; the first sample is
                             then smaller, by a half at most */
    size_t n_given;
    SurrogateUse surrogate;
    SelectionKind selection;
    int asynchronous;
    double repeats;            /* of a noisy problem: share of max_evals that is spent on designs simulated again */
    size_t replicates_min;     /* ... of each design that is reported to be on the front */
    size_t replicates_max;     /* ... of each design, the first included */
    double max_seconds;        /* 0: no limit */
    double nondominated_share; /* stop when this share of the archive is nondominated; 1: never */
    double trust_error;        /* share of an objective's range in the archive */
    double crossover_probability, crossover_eta, mutation_eta, mutation_rate;
} SearchConfig;

/* Repeats that n simulations of a noisy problem bring at most. Where new designs are worth more than certainty about
 * old ones there are none: of the first REPLICATE_AFTER simulations for each variable. */
double search_replicates(size_t n, double share, size_t n_var);

typedef enum { STOP_NONE, STOP_GENERATIONS, STOP_EVALUATIONS, STOP_TIME, STOP_SHARE, STOP_ASKED } StopReason;
const char *stop_reason_words(StopReason reason);

/* Everything simulated so far, in the order of simulation; row i is design number i + 1. */
typedef struct {
    size_t n, n_var, n_obj, n_con;
    const double *X, *Y, *H;       /* (n, n_var) (n, n_obj) (n, n_con) designs, and what each simulation answered */
    const double *F;               /* (n, n_obj) of a design's first row: mean of its answers */
    const double *sd;              /* (n, n_obj) ... and standard deviation of one of them */
    const size_t *replicates;      /* (n) of a design's first row, else 0 */
    const unsigned char *ok;       /* (n) 0: the simulation failed */
    const unsigned char *kind;     /* (n) EvaluationKind */
    const size_t *generation;      /* (n) */
    const unsigned char *on_front; /* (n) feasible, ok, nondominated and answered replicates_min times at least; at the
                                      end, where none is: those with the most answers */
    size_t n_front, n_failed, n_replicates;
    size_t generation_now;
    size_t n_predicted;     /* offspring of this generation whose prediction stood */
    double surrogate_error; /* median leave-one-out error, share of range, worst objective; NaN: no surface yet */
    double seconds;
    double simulation_s, own_s;   /* wall time per simulation, of this session: in the simulator (all threads together),
                                     of surrogate and search while the surface was in use; NAN: none yet */
    double waited_s, surrogate_s; /* of `seconds`: waiting for simulations, at the surface; the rest is search */
    int is_asynchronous;
    int is_aside;      /* the surface costs more than it saves and is no longer used */
    const void *state; /* (n_state bytes) of the search at this moment; NULL: no memory for it */
    size_t n_state;
} SearchView;

/* A moment to go on from: the evaluations at the end of a generation, in the order of the view, and the state that it
 * had. All of it is only read. */
typedef struct {
    size_t n, n_later; /* n_later: rows behind the n that came after the state was saved (evaluate/queue.h: known) */
    const Evaluation *row; /* (n + n_later) */
    const void *state;     /* NULL: n is 0, none was saved */
    size_t n_state;
} SearchStart;

/* Called after the start and after every generation; return non-zero to stop. */
typedef int (*ObserveFn)(const SearchView *view, void *user);

Status search_run(const Problem *problem, const SearchConfig *config, ObserveFn observe, void *user, StopReason *reason,
                  Err *err);

/* The same from `start` on (NULL: from the beginning). Problem and configuration must be those of the search that wrote
 * the state, but for the limits (generations, max_evals with planned_evals set, max_seconds). A state that does not fit
 * is STATUS_BAD_DATA. A search that has reached its limits simulates nothing and does not call observe. */
Status search_resume(const Problem *problem, const SearchConfig *config, const SearchStart *start, ObserveFn observe,
                     void *user, StopReason *reason, Err *err);

#endif
