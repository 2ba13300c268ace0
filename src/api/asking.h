/* api/asking.h -- a search that stops wherever it needs evaluations, for who asks and tells.
 *
 * The search (moga/search.h) runs in a thread of its own, in turns with the caller's: an executor takes the tasks of a
 * batch from its queue and gives the turn back; when every design is told the next turn begins. Of the two threads one
 * runs at a time, so that nothing here needs a lock.
 *
 *   designs    row i of the table has id i + 1: what the search has ever asked for, with the answer where it is told
 *   state      of the last generation's end, with the rows that were finished then: from both it can be resumed
 *
 * Life cycle  asking_open -> asking_advance, answers into the table ... -> asking_close
 * Threads     one, and the process that opened it */
#pragma once

#include <semaphore.h>

#include "evaluate/queue.h"
#include "moga/search.h"

typedef enum { DESIGN_FREE, DESIGN_OUT, DESIGN_TOLD } DesignPlace;

typedef struct {
    DesignPlace place;
    int is_named; /* in the answers at hand */
    int is_due;   /* the search waits for it, */
    size_t slot;  /* in this slot of its queue */
} AskedDesign;

typedef struct {
    Problem problem;
    SearchConfig config;
    EvaluationTable table; /* extra: the constraint values */
    AskedDesign *design;   /* (table.n) */
    size_t room, n_told;
    size_t n_finished, n_state; /* rows at the end of the generation whose state is */
    unsigned char *state;       /* (n_state); NULL: none is finished */
    EvaluationTable known;      /* rows that it was resumed from */
    Queue *queue;
    pthread_t thread;
    sem_t go, back;
    size_t threads; /* of the search's own work */
    int is_running, is_closing, is_over;
    StopReason reason;
    Status status; /* that it ended with */
    Err why;
} Asking;

/* Nothing is asked yet; the shape of the problem is set. Its bounds, kinds and judge, config, threads, and of a search
 * that is resumed table, designs and state, before the first turn. */
void asking_open(Asking *a);

/* Where every design is told: the search goes on until it asks for others, or ends. */
Status asking_advance(Asking *a, Err *err);

void asking_close(Asking *a); /* the arrays of config and problem are the caller's */

/* Room for one more design, at the end of the table. */
Status asking_add(Asking *a, const double x[], Err *err);
