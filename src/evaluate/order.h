/* evaluate/order.h -- what processes of our own are asked and answer, in plain bytes: all are the same program on the
 * same kind of machine.
 *
 *   Order, Task (n), x (n, n_var)     ->     Answer, parts of the first n_done tasks
 *
 * Threads  no state */
#pragma once

#include "evaluate/pool.h"

typedef struct {
    int64_t epoch; /* comes back as it is, and so does worker */
    uint64_t worker, n;
} Order;

typedef struct {
    int64_t epoch;
    uint64_t worker, n_done;
    double seconds;
    Err why; /* of the task behind those that are done */
    _Alignas(16) char parts[];
} Answer;

/* Who does them. */
typedef struct {
    const Simulator *simulator;
    void *self;
    size_t n_var;
    const Observer *observer; /* of the tasks */
} Doer;

static inline size_t order_bytes(size_t n, size_t n_var)
{
    return sizeof(Order) + n * (sizeof(Task) + n_var * sizeof(double));
}

/* Into room for it; its bytes. */
size_t order_write(Order *to, const Worker *w, size_t n_var);

/* As `worker`; the answer, to be freed, NULL: there is no memory. */
Answer *order_do(Order *order, size_t worker, const Doer *doer, size_t *n_bytes);

/* Takes an answer of n_bytes to the worker's tasks; 0: it answers none of them. */
int order_take(const Answer *answer, size_t n_bytes, Worker *w);
