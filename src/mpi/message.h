/* mpi/message.h -- what rank 0 and the ranks that evaluate say to each other.
 *
 *   rank 0                                                        every other rank
 *   TASK   an Order (evaluate/order.h) of one of its workers   ->  does it
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
#include "evaluate/order.h"

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
