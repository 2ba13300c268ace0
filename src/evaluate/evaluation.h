/* evaluate/evaluation.h -- one evaluated design: the record that a simulator fills, the search ranks, a run stores and
 * every file is written from.
 *
 *   x      (n_var)    design variables
 *   f      (n_obj)    objectives in natural signs and units, means over the replicates; NAN where the design failed
 *   sd     (n_obj)    standard deviation of a single simulation; NAN: not known (one replicate); NULL in a table
 *                     without (n_sd = 0)
 *   extra  (n_extra)  what else is written down; NAN: not known
 *
 * Shapes     of one table, all rows have the same; in its memory rows follow each other: table.x is X (n, n_var)
 *            row-major, likewise f, sd, extra, and row[i].x = table.x + i n_var
 * Ownership  the table owns rows, numbers and reasons; pointers into it hold until the next evaluation_table_add. A
 *            row outside a table borrows its arrays
 * Memory     an allocation for each array, doubled when it is full; of room that is not used the system has only
 *            addresses
 * Threads    no state
 * Errors     STATUS_NO_MEMORY; a design that failed is a row with another outcome than OUTCOME_OK, not an error */
#pragma once

#include "base/status.h"

/*    name            word in files */
#define OUTCOME_LIST(X)                                                                                                \
    X(OK, "ok")                                                                                                        \
    X(NOT_FINITE, "not_finite")                                                                                        \
    X(OUT_OF_STEPS, "out_of_steps")                                                                                    \
    X(ENERGY_BALANCE, "energy_balance")                                                                                \
    X(ENGINE_FAILED, "engine_failed")                                                                                  \
    X(ERROR, "error")     /* reported by an external simulator */                                                      \
    X(DEAD, "dead")       /* it ended without an answer */                                                             \
    X(TIMEOUT, "timeout") /* it gave none in time */                                                                   \
    X(GARBLED, "garbled") /* what it wrote is none */

typedef enum {
#define X(name, word) OUTCOME_##name,
    OUTCOME_LIST(X)
#undef X
        OUTCOME_COUNT
} Outcome;

const char *outcome_word(Outcome outcome);
Outcome outcome_of_word(const char *word); /* OUTCOME_COUNT: no outcome has that word */

/* Why a design was evaluated. */
#define KIND_LIST(X)                                                                                                   \
    X(SAMPLED, "sampled")       /* first sample, or given */                                                           \
    X(INFILL, "infill")         /* chosen on the surrogate */                                                          \
    X(OFFSPRING, "offspring")   /* of variation, without the surrogate */                                              \
    X(POLISHED, "polished")     /* from outside the search */                                                          \
    X(REPEAT, "repeat")         /* further replicates of a design that is there */                                     \
    X(SCREENED, "screened")     /* the cheap level alone (evaluate/problem.h): never on the front */                   \
    X(FINISHED, "finished")     /* screened before: now all of its simulations */                                      \
    X(KEPT, "kept")             /* from outside the search, of a page (serve/serve.h) */                               \
    X(UNFINISHED, "unfinished") /* its generation is not finished: not known yet */

typedef enum {
#define X(name, word) KIND_##name,
    KIND_LIST(X)
#undef X
        KIND_COUNT
} EvaluationKind;

/* From outside the search, which never sees it. */
static inline int kind_is_outside(EvaluationKind kind)
{
    return kind == KIND_POLISHED || kind == KIND_KEPT;
}

const char *kind_word(EvaluationKind kind);
EvaluationKind kind_of_word(const char *word); /* KIND_UNFINISHED: no other kind has that word */

enum { REASON_MAX = 160 };

/* The arrays of numbers of an evaluation: x, and what its simulations answer. */
#define RESULT_ARRAYS(X)     X(f, n_obj) X(sd, n_sd) X(extra, n_extra)
#define EVALUATION_ARRAYS(X) X(x, n_var) RESULT_ARRAYS(X)

typedef struct {
    long id, generation;
    EvaluationKind kind;
    Outcome outcome;
    const char *reason; /* why it failed, fit for a cell of a CSV file; else empty */
    char *room;         /* (REASON_MAX) for that text; NULL: there is none, for one that did not fail */
    int replicates;     /* simulations of each record behind f; 0: not known */
    double seconds;     /* of all its simulations; NAN: not known */
    double violation;   /* of the limits, sum of max(0, g): 0 where they hold; INFINITY: failed; NAN: not known */
    double *x, *f, *sd, *extra;
    double *err; /* (n_obj + n_extra) likely errors of f, then of extra; of no row of a table; NULL: not known */
    long level;  /* times that the steps of the settings were doubled for it */
} Evaluation;

/* Nothing is known: x and the room stay, every other number is NAN; OUTCOME_OK, KIND_UNFINISHED. */
void evaluation_forget(Evaluation *e, size_t n_obj, size_t n_extra);

/* Outcome and reason, for which there is room where it is not empty; the text becomes one of visible characters
 * and a cell of a CSV file (base/visible.h), of valid UTF-8 whatever a worker wrote. */
void evaluation_set_outcome(Evaluation *e, Outcome outcome, const char *reason);

typedef Status (*EvaluationFn)(const Evaluation *e, void *user, Err *err); /* the row holds until it returns */

typedef struct {
    size_t n, n_max;
    size_t n_var, n_obj, n_extra, n_sd; /* n_sd: n_obj, or 0 */
    Evaluation *row;                    /* (n) */
    double *x, *f, *sd, *extra;         /* (n, n_var) (n, n_obj) (n, n_sd) (n, n_extra) */
} EvaluationTable;

/* Empty; needs no memory. n_sd is n_obj, and may be set to 0. */
EvaluationTable evaluation_table(size_t n_var, size_t n_obj, size_t n_extra);

/* One more row behind the last: x of zeros, every other number not known, OUTCOME_OK, KIND_UNFINISHED. */
Status evaluation_table_add(EvaluationTable *t, Evaluation **row, Err *err);

Status evaluation_table_give_room(Evaluation *row, Err *err); /* for its reason */

/* Appends a copy of `from`, whose shapes are those of the table; NULL arrays are unknown. */
Status evaluation_table_append(EvaluationTable *t, const Evaluation *from, Err *err);

/* The commonest reason of those that failed, how many have it, and how many failed. */
const char *evaluation_table_failures(const EvaluationTable *t, size_t *n_failed, size_t *most);

/* STATUS_INTERNAL where there are rows and all failed, with the reason that most of them have. */
Status evaluation_table_check(const EvaluationTable *t, Err *err);

void evaluation_table_free(EvaluationTable *t); /* its shapes stay; {0} is fine */
