/* evaluate/queue.h -- the one queue of evaluations, between its client (a search) and the executor.
 *
 *   client     queue_ask(x) ...      queue_next(): the next finished design
 *   executor   queue_take(task) -> Simulator.simulate -> queue_give(task)          (evaluate/tasks.h)
 *
 * A design is as many tasks as the problem has parts, and any worker takes any of them, in the order of asking: a few
 * designs with many replicates keep every worker busy. The last part given makes the Evaluation, whichever it is, so
 * that nothing depends on the order of arrival but the order itself:
 *
 *   QUEUE_AS_ASKED     queue_next gives designs in the order of asking: a batch is asked for, then taken. Numbered
 *                      n_before + 1, ... as they are asked for; independent of the number of workers
 *   QUEUE_AS_ARRIVED   in the order in which they are finished, and numbered so: no worker waits for the slowest.
 *                      With one worker both orders are one
 *
 * Known      evaluations that were made before the program was interrupted (queue_know) are not simulated again: as
 *            asked, a design with the same number and x has its evaluation at once; as arrived, they come first, in
 *            their order, whether asked for or not
 * Stops      on request of the observer, asked before each task: what is under way is finished, queue_next returns
 *            STATUS_STOPPED. On a fault likewise; of several the one of the task asked for first is reported, so that
 *            the message does not depend on the number of workers
 * Life cycle queue_open (starts the executor) -> queue_ask, queue_next ... -> queue_close (waits for what is under way)
 * Threads    take and give from any thread, the rest from the client's own
 * Memory     of a pending design all at once, used again for later ones */
#pragma once

#include "evaluate/tasks.h"

typedef enum { QUEUE_AS_ASKED, QUEUE_AS_ARRIVED } QueueOrder;

/* Borrows the problem. n_before: designs that were evaluated before this session. */
Status queue_open(Queue **out, const Problem *problem, QueueOrder order, long n_before, Err *err);
void queue_close(Queue *q); /* NULL is fine */

typedef struct {
    const double *x; /* (n_var), copied */
    size_t repeat;   /* evaluations of this design that there are already */
    EvaluationKind kind;
    size_t n_parts; /* the first parts alone; 0: all */
    Variant variant;
    const void *cheap_parts; /* (n_cheap) parts of this design that are there, copied; NULL: none */
} Asked;

Status queue_ask(Queue *q, const Asked *asked, Err *err);

typedef struct {
    const Evaluation *evaluation; /* kind: as asked; KIND_INFILL where it was not asked for */
    const double *f, *g;          /* (n_obj) (n_con) minimised, as the problem judges it */
    const void *parts;            /* (n_parts) of part_size as they were taken; NULL where the evaluation was known */
} Finished;

/* Waits for the next finished design of those pending; what `out` points to holds until the next call or queue_ask. */
Status queue_next(Queue *q, Finished *out, Err *err);

size_t queue_pending(const Queue *q); /* asked for and not given by queue_next */
int queue_has(const Queue *q, const double x[]);

/* Pending design i in the order of asking. */
Asked queue_design(const Queue *q, size_t i);

/* Designs of which no part is taken are no longer asked for. */
void queue_withdraw(Queue *q);

/* n rows, borrowed, before the first design is asked for; as asked: ascending ids. */
void queue_know(Queue *q, size_t n, const Evaluation rows[]);

/* A batch: X (n, n_var) asked for, all of it waited for; minimised F (n, n_obj), G (n, n_con), ok (n). Nothing may be
 * pending. repeat (n): as in Asked, NULL: 0. */
Status queue_evaluate(Queue *q, size_t n, const double X[], const size_t repeat[], double F[], double G[],
                      unsigned char ok[], Err *err);
