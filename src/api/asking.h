/* api/asking.h -- a search for who asks and tells: its designs, and which of them are told.
 *
 *   designs   row i of the table has id i + 1, its number in the search: what was ever asked for, with the answer where
 *             it is told
 *
 * Life cycle  asking_init -> asking_open -> asking_advance, asking_tell ... -> asking_close
 * Threads     one at a time */
#pragma once

#include "moga/search.h"

typedef enum { DESIGN_FREE, DESIGN_OUT, DESIGN_TOLD } DesignPlace;

typedef struct {
    DesignPlace place;
    int is_named; /* in the answers at hand */
} AskedDesign;

typedef struct {
    Problem problem;
    SearchConfig config;
    Search *search;
    EvaluationTable table; /* extra: the constraint values */
    AskedDesign *design;   /* (table.n) */
    size_t room, n_told;
    size_t n_entered, n_state; /* of a saved one: rows that have entered its search, whose state is */
    unsigned char *state;      /* (n_state), until it is open */
    size_t threads;            /* of the search's own work */
    double began;              /* [s] of the clock */
    int is_over;
    StopReason reason;
} Asking;

/* Nothing is asked yet; the shape of the problem is set. */
void asking_init(Asking *a);

/* Bounds, kinds and judge of the problem, config and threads are set, and of a saved search designs and state. */
Status asking_open(Asking *a, Err *err);

/* The search goes on until it waits for answers, or ends: what may be asked for now is in the table. */
Status asking_advance(Asking *a, Err *err);

/* The answer is in this row. */
Status asking_tell(Asking *a, size_t row, Err *err);

void asking_close(Asking *a); /* the arrays of config and problem are the caller's */

/* Room for one more design, at the end of the table. */
Status asking_add(Asking *a, const double x[], Err *err);
