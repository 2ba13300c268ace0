/* mpi/message.h -- what rank 0 and the ranks that evaluate say to each other.
 *
 *   rank 0                                                        every other rank
 *   TASK   an Order of one of its workers                      ->  does it
 *                                                              <-  DONE    an Answer
 *                                                              <-  ALIVE   while it has tasks, every ALIVE_S
 *   OPEN   without a task                                      ->  ends
 *                                                              <-  LEFT
 *
 * epoch: of the queue that the tasks are of; what comes late from an earlier one is dropped.
 *
 * Threads  MPI is called by one thread at a time (MPI_THREAD_SERIALIZED) */
#pragma once

#include <time.h>

#include "evaluate/cluster.h"
#include "evaluate/pool.h"

/* In plain bytes, as all are the same program on the same kind of machine: Order, Task (n), x (n, n_var). */
typedef struct {
    int64_t epoch; /* comes back as it is, and so does worker */
    uint64_t worker, n;
} Order;

typedef struct {
    int64_t epoch;
    uint64_t worker, n_done;
    double seconds;
    Err why; /* of the task behind the first n_done */
    _Alignas(16) char parts[];
} Answer;

static inline size_t order_bytes(size_t n, size_t n_var)
{
    return sizeof(Order) + n * (sizeof(Task) + n_var * sizeof(double));
}

static inline double *order_numbers(Order *o)
{
    return (double *)((Task *)(o + 1) + o->n);
}

/* TAG_TASK + worker of the rank, 0 ...; the opener is one more, whose task is to open a problem: x is the recipe, and
 * the part Opened. */
enum { TAG_DONE = 1, TAG_ALIVE, TAG_LEFT, TAG_OPEN, TAG_TASK };

enum { HOST_MAX = 64 };

/* A rank with tasks says so often that it lives; one that did not for SILENT_S of rank 0's own running time is given
 * up. */
static const double ALIVE_S = 2.0, SILENT_S = 20.0;

typedef struct {
    uint64_t inputs; /* Problem.inputs as this rank has read them */
    uint64_t n_workers;
    char host[HOST_MAX];
} Opened;

typedef struct {
    int from, tag;
    size_t n;
    void *bytes; /* (n) for free */
} Message;

/* The next one of that tag, or MPI_ANY_TAG, from that rank, or MPI_ANY_SOURCE; 0: there is none. Without memory
 * the job ends. */
int message_receive(int from, int tag, Message *m);

/* Are those n bytes from one of n_workers? */
static inline int is_answer_of(const Answer *a, size_t n, size_t n_workers)
{
    return n >= sizeof *a && a->worker < n_workers;
}

/* What an answer of n_bytes says of the worker's tasks; 0: it is none to them. */
static inline int answer_take(const Answer *answer, size_t n_bytes, Worker *w)
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

/* Pauses between looks at MPI, which has no way to wait without using a processor: longer ones the longer nothing
 * comes. */
static const double PAUSE_MIN_S = 2e-5;
static inline double longer_pause(double pause, double longest)
{
    return MIN_OF(pause * 1.5, longest);
}
static inline void pause_s(double seconds)
{
    nanosleep(&(struct timespec){.tv_nsec = (long)(1e9 * seconds)}, NULL);
}

extern const Executor EXECUTOR_RANKS; /* ranks.c */

/* serve.c: does the tasks of rank 0 until that says LEAVE. */
Status serve(ReopenFn reopen, Err *err);

/* The name of this machine, cut where it is too long. */
void host_name(char host[HOST_MAX]);
