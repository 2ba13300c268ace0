/* evaluate/queue.h -- the one queue of evaluations, between its client (a search) and the executor.
 *
 *   client     queue_ask(x) ...      queue_next(): the next finished design
 *   executor   queue_take(task) -> Simulator.simulate -> queue_give(task)          (evaluate/tasks.h)
 *
 * A design is as many tasks as the problem has parts, and any worker takes any of them, in the order of asking: a few
 * designs with many replicates keep every worker busy. The last part given makes the Evaluation, whichever it is, so
 * that nothing depends on the order of arrival. queue_next gives designs in the order of asking.
 *
 * Stops      on request of the observer, asked before each task: what is under way is finished, queue_next returns
 *            STATUS_STOPPED. On a fault likewise; of several the one of the task asked for first is reported, so that
 *            the message does not depend on the number of workers
 * Life cycle queue_open (starts the executor) -> queue_ask, queue_next ... -> queue_close (waits for what is under way)
 * Threads    take and give from any thread, the rest from the client's own
 * Memory     of a pending design all at once, used again for later ones */
#pragma once

#include "evaluate/tasks.h"

/* Borrows the problem. */
Status queue_open(Queue **out, const Problem *problem, Err *err);
void queue_close(Queue *q); /* NULL is fine */

typedef struct {
    long id;         /* number of the evaluation, which keys random streams; 0: the next one */
    const double *x; /* (n_var), copied */
    size_t repeat;   /* evaluations of this design that there are already */
    EvaluationKind kind;
    size_t n_parts; /* the first parts alone; 0: all */
    Variant variant;
    const void *cheap_parts; /* (n_cheap) parts of this design that are there, copied; NULL: none */
} Asked;

Status queue_ask(Queue *q, const Asked *asked, Err *err);

typedef struct {
    const Evaluation *evaluation; /* id and kind: as asked */
    const double *f, *g;          /* (n_obj) (n_con) minimised, as the problem judges it */
    const void *parts;            /* (n_parts) of part_size as they were taken */
} Finished;

/* Waits for the next finished design of those pending; what `out` points to holds until the next call or queue_ask. */
Status queue_next(Queue *q, Finished *out, Err *err);

size_t queue_pending(const Queue *q); /* asked for and not given by queue_next */

/* A batch: X (n, n_var) asked for, all of it waited for; minimised F (n, n_obj), G (n, n_con), ok (n). Nothing may be
 * pending. repeat: of each, as in Asked. */
Status queue_evaluate(Queue *q, size_t n, const double X[], size_t repeat, double F[], double G[], unsigned char ok[],
                      Err *err);
