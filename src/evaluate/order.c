#include "evaluate/order.h"

#include "base/clock.h"

/* Where x begins. */
static double *numbers_of(Order *o)
{
    return (double *)((Task *)(o + 1) + o->n);
}

size_t order_write(Order *to, const Worker *w, size_t n_var)
{
    to->n = w->n;
    memcpy(to + 1, w->task, w->n * sizeof *w->task);
    for (size_t i = 0; i < w->n; i++)
        copy_values(n_var, w->task[i].x, numbers_of(to) + i * n_var);
    return order_bytes(w->n, n_var);
}

Answer *order_do(Order *order, size_t worker, const Doer *doer, size_t *n_bytes)
{
    Task *task = (Task *)(order + 1);
    const double began = clock_seconds();
    const size_t size = task->size;
    size_t n_done = 0;
    Pool *pool = pool_of(doer->simulator, doer->self);
    Answer *a = calloc(1, sizeof *a + order->n * size);
    if (!a)
        return NULL;
    a->epoch = order->epoch;
    a->worker = order->worker;
    for (size_t i = 0; i < order->n; i++) {
        task[i].x = numbers_of(order) + i * doer->n_var;
        task[i].result = a->parts + i * size;
        task[i].observer = doer->observer;
    }
    if (pool)
        pool_do(pool, worker, order->n, task, &n_done, &a->why);
    while (!pool && n_done < order->n &&
           doer->simulator->simulate(doer->self, worker, &task[n_done], &a->why) == STATUS_OK)
        n_done++;
    a->n_done = n_done;
    a->seconds = clock_seconds() - began;
    *n_bytes = sizeof *a + a->n_done * size;
    return a;
}

int order_take(const Answer *answer, size_t n_bytes, Worker *w)
{
    const size_t size = w->task->size;
    if (n_bytes < sizeof *answer || answer->n_done > w->n || answer->why.code >= STATUS_COUNT ||
        (answer->n_done < w->n) != (answer->why.code != STATUS_OK) || n_bytes != sizeof *answer + answer->n_done * size)
        return 0;
    for (size_t i = 0; i < answer->n_done; i++)
        memcpy(w->task[i].result, answer->parts + i * size, size);
    w->n = w->n_done = answer->n_done;
    w->why = answer->why;
    return 1;
}
