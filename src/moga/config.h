/* moga/config.h -- what a search is given: its configuration and, where it is resumed, the evaluations so far.
 *
 * Ownership  borrows every array
 * Threads    no state */
#pragma once

#include "evaluate/evaluation.h"
#include "settings/search_options.h"

/* Why a search ends. */
typedef enum {
    STOP_NONE,
    STOP_EVALUATIONS,
    STOP_EXHAUSTED,
    STOP_TIME,
    STOP_CONVERGED,
    STOP_ASKED,
    STOP_FAILURES
} StopReason;

enum { SEARCH_CENTRES = 400 }; /* of the surrogate at most */

typedef struct {
    uint32_t seed;
    size_t population, max_evals, surrogate_max;
    size_t planned_evals; /* 0: max_evals. Initial sample and reference vectors of infill are those of so many
                                  evaluations: of two searches that differ in max_evals only, one begins the other */
    size_t initial;       /* size of the initial sample; 0: by the number of variables */
    const double *given;  /* (n_given, n_var) first designs, moved into the box; the sample is then smaller, by
                                  half at most */
    size_t n_given;
    SurrogateUse surrogate;
    Fidelity fidelity;
    long ahead; /* designs that may be under way when the next ones are chosen; -1: by their number (common_ahead) */
    double replicate_share; /* noisy: share of max_evals for further replicates */
    size_t replicates_max;  /* ... of each design */
    double max_seconds;     /* of the client's clock; 0: no limit */
    size_t stop_after;      /* evaluations that gain nothing above the noise of hypervolume end it; 0: never */
} SearchConfig;

/* Evaluations that the search was planned for. */
static inline size_t config_budget(const SearchConfig *c)
{
    return c->planned_evals > 0 ? c->planned_evals : c->max_evals;
}

/* Where a search is resumed: the evaluations at the end of a generation, in the order of the view, and its state. Only
 * read. */
typedef struct {
    size_t n, n_later; /* n_later: rows, by ascending id, that had been told when it ended and had not entered yet */
    const Evaluation *row; /* (n + n_later); with `each` the last n_later alone */
    const void *state;     /* NULL: n is 0, none was saved */
    size_t n_state;
    Status (*each)(EvaluationFn take, void *search, void *user,
                   Err *err); /* passes the first n; NULL: they are in `row` */
    void *user;               /* of `each` */
} SearchStart;

/* Whether this version of the search wrote the state: another one cannot be resumed. */
int search_state_is_current(const void *state, size_t n_state);
