/* bench/ranks.c -- what rank 0 and the ways of messages cost, without a search: tasks that sleep, over the ranks of MPI.
 *
 *   mpirun -n N+1 imtet-bench-ranks MODE SECONDS TASKS      N ranks of one worker each
 *
 * prints   mode,workers,task_s,tasks,seconds,efficiency,rank0_s
 *
 *   async    one design is one task; WINDOW more than there are workers are pending at any time, as in a search
 *   batch    BATCH designs of PARTS tasks each (replicates, records) are asked for and waited for, then the next
 *   rate     as async, with MANY pending: seconds = 0 gives the service rate of rank 0
 *
 * efficiency = tasks task_s / (workers seconds); rank0_s: processor time of rank 0 */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#include "base/clock.h"
#include "evaluate/cluster.h"
#include "evaluate/queue.h"
#include "evaluate/tasks.h"

enum { WINDOW = 23, BATCH = 92, PARTS = 4, MANY = 4096 };

static Status simulate(void *self, size_t worker, const Task *task, Err *err)
{
    (void)self;
    (void)worker;
    (void)err;
    const double s = task->x[0];
    *(double *)task->result = s;
    if (s > 0.0)
        nanosleep(&(struct timespec){(time_t)s, (long)(1e9 * (s - (double)(time_t)s))}, NULL);
    return STATUS_OK;
}

static void combine(const Problem *p, size_t n, const void *parts, Evaluation *e)
{
    (void)p;
    (void)n;
    e->f[0] = *(const double *)parts;
    e->seconds = 0.0;
    e->replicates = 1;
}

static const Simulator SLEEPER = {.simulate = simulate, .combine = combine};

/* recipe: the number of parts */
static Status reopen(Problem *p, const void *recipe, size_t size, Err *err)
{
    (void)err;
    (void)size;
    size_t parts;
    memcpy(&parts, recipe, sizeof parts);
    *p = (Problem){.n_var = 1,
                   .n_obj = 1,
                   .simulator = &SLEEPER,
                   .n_parts = parts,
                   .part_size = sizeof(double),
                   .n_workers = 1,
                   .recipe = recipe,
                   .recipe_size = size};
    return STATUS_OK;
}

typedef struct {
    const char *mode;
    double task_s;
    size_t n_tasks;
} Order;

static Status keep_pending(Queue *q, const Order *o, size_t pending, Err *err)
{
    Finished done;
    for (size_t asked = 0, taken = 0; taken < o->n_tasks; taken++) {
        for (; asked < o->n_tasks && asked < taken + pending; asked++)
            TRY(queue_ask(q, &(Asked){.x = &o->task_s}, err));
        TRY(queue_next(q, &done, err));
    }
    return STATUS_OK;
}

static Status in_batches(Queue *q, const Order *o, Err *err)
{
    Finished done;
    for (size_t taken = 0; taken < o->n_tasks; taken += BATCH * PARTS) {
        for (int i = 0; i < BATCH; i++)
            TRY(queue_ask(q, &(Asked){.x = &o->task_s}, err));
        for (int i = 0; i < BATCH; i++)
            TRY(queue_next(q, &done, err));
    }
    return STATUS_OK;
}

static double processor_seconds(void)
{
    struct timespec t;
    clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &t);
    return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

static Status measure(Order o, Err *err)
{
    const int is_batch = strcmp(o.mode, "batch") == 0;
    const size_t parts = is_batch ? PARTS : 1, batch = BATCH * PARTS;
    Problem p;
    Queue *q;
    TRY(reopen(&p, &parts, sizeof parts, err));
    executor_choose(&p);
    TRY(queue_open(&q, &p, err));
    if (is_batch)
        o.n_tasks = (o.n_tasks + batch - 1) / batch * batch;
    Status status = keep_pending(q, &(Order){o.mode, o.task_s, 2 * p.n_workers}, p.n_workers, err); /* warm */
    const double began = clock_seconds(), processor = processor_seconds();
    if (status == STATUS_OK)
        status =
            is_batch ? in_batches(q, &o, err) : keep_pending(q, &o, *o.mode == 'r' ? MANY : p.n_workers + WINDOW, err);
    const double seconds = clock_seconds() - began;
    printf("%s,%zu,%g,%zu,%.6g,%.4f,%.4g\n", o.mode, p.n_workers, o.task_s, o.n_tasks, seconds,
           (double)o.n_tasks * o.task_s / ((double)p.n_workers * seconds), processor_seconds() - processor);
    queue_close(q);
    return status;
}

int main(int argc, char *argv[])
{
    Err err = {0};
    int serves;
    Status status = cluster_join(&argc, &argv, (char[CLUSTER_VERSION_MAX]){"imtet-bench-ranks"}, reopen, &serves, &err);
    if (status == STATUS_OK && !serves)
        status = argc == 4 ? measure((Order){argv[1], strtod(argv[2], NULL), strtoul(argv[3], NULL, 10)}, &err)
                           : fail(&err, STATUS_USAGE, "imtet-bench-ranks async|batch|rate SECONDS TASKS");
    if (status != STATUS_OK)
        fprintf(stderr, "imtet-bench-ranks: %s\n", err.text);
    fflush(stdout);
    cluster_leave(status_exit_code(status));
    return status_exit_code(status);
}
