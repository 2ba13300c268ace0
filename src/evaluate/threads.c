#include "evaluate/threads.h"

#include <omp.h>
#include <pthread.h>
#include <stdlib.h>

#include "evaluate/cluster.h"
#include "evaluate/tasks.h"

size_t threads_wanted(long setting)
{
    return setting > 0 ? (size_t)setting : (size_t)omp_get_num_procs();
}

static void do_task(Queue *q, size_t worker, const Task *task)
{
    const Problem *p = queue_problem(q);
    Err why = {0};
    const Status status = p->simulator->simulate(p->self, worker, task, &why);
    queue_give(q, task, status, &why);
}

/* -- a thread for each worker -------------------------------------------------------------------------------------- */

typedef struct {
    Queue *queue;
    size_t number;
    pthread_t thread;
} Worker;

typedef struct {
    size_t n;
    Worker worker[]; /* (n) */
} Threads;

static void *work(void *user)
{
    const Worker *w = user;
    Task task;
    while (queue_take(w->queue, 1, &task))
        do_task(w->queue, w->number, &task);
    return NULL;
}

static void threads_join(void *self)
{
    Threads *t = self;
    for (size_t i = 0; i < t->n; i++)
        pthread_join(t->worker[i].thread, NULL);
    free(t);
}

static Status threads_start(void **self, Queue *q, Err *err)
{
    const size_t n = queue_problem(q)->n_workers;
    Threads *t = calloc(1, sizeof *t + n * sizeof *t->worker);
    *self = t;
    if (!t)
        return fail(err, STATUS_NO_MEMORY, "no memory for %zu threads", n);
    for (; t->n < n; t->n++) {
        Worker *w = &t->worker[t->n];
        *w = (Worker){.queue = q, .number = t->n};
        if (pthread_create(&w->thread, NULL, work, w) != 0)
            return fail(err, STATUS_NO_MEMORY, "no thread for the simulations (%zu of %zu)", t->n + 1, n);
    }
    return STATUS_OK;
}

const Executor EXECUTOR_THREADS = {threads_start, NULL, threads_join};

/* -- the client itself --------------------------------------------------------------------------------------------- */

static Status client_start(void **self, Queue *q, Err *err)
{
    (void)err;
    *self = q;
    return STATUS_OK;
}

static void client_help(void *self)
{
    Task task;
    if (queue_take(self, 0, &task))
        do_task(self, 0, &task);
}

static void client_stop(void *self)
{
    (void)self;
}

const Executor EXECUTOR_CLIENT = {client_start, client_help, client_stop};

const Executor *executor_for(size_t n_workers)
{
    return n_workers > 1 ? &EXECUTOR_THREADS : &EXECUTOR_CLIENT;
}

void executor_choose(Problem *p)
{
    size_t n_ranks;
    const Executor *ranks = p->recipe ? cluster_executor(&n_ranks) : NULL;
    p->executor = ranks ? ranks : executor_for(p->n_workers);
    p->n_workers *= ranks ? n_ranks : 1;
}
