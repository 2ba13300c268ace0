/* mpi/message.h -- what rank 0 and the ranks that evaluate say to each other.
 *
 *   rank 0                                                  every other rank
 *   OPEN   OpenMessage, then the recipe by broadcast    ->  opens the problem
 *                                                       <-  OPENED  OpenedMessage
 *   TASK   TaskMessage, then x (n_var)                  ->  does it
 *                                                       <-  DONE    DoneMessage and the part, or the reason of a
 *                                                                   status that is not ok
 *                                                       <-  ALIVE   while it has tasks, every ALIVE_S
 *   STOP   epoch                                        ->  tasks that are not begun come back at once, STATUS_STOPPED
 *   LEAVE                                               ->  ends
 *                                                       <-  LEFT
 *
 * epoch: of the queue that the tasks are of; what comes late from an earlier one is dropped. Plain bytes: all ranks
 * are the same program on the same kind of machine.
 *
 * Threads  MPI is called by one thread at a time (MPI_THREAD_SERIALIZED) */
#pragma once

#include <time.h>

#include "evaluate/cluster.h"

enum { TAG_OPEN = 1, TAG_OPENED, TAG_TASK, TAG_DONE, TAG_ALIVE, TAG_STOP, TAG_LEAVE, TAG_LEFT };

enum { HOST_MAX = 64 };

/* A rank with tasks sends something so often; one that did not for SILENT_S of rank 0's own running time is given
 * up. */
static const double ALIVE_S = 2.0, SILENT_S = 20.0;

typedef struct {
    int64_t epoch;
    uint64_t recipe_size, part_size;
} OpenMessage;

typedef struct {
    int64_t epoch;
    uint64_t inputs; /* Problem.inputs as this rank has read them */
    uint64_t n_workers;
    int32_t status;
    char host[HOST_MAX];
    char why[sizeof((Err *)0)->text];
} OpenedMessage;

typedef struct {
    int64_t epoch;
    uint64_t ticket; /* rank 0's */
    int64_t id;
    uint64_t part, repeat;
    Variant variant;
    double x[]; /* (n_var) */
} TaskMessage;

typedef struct {
    int64_t epoch;
    uint64_t ticket;
    double seconds;
    int64_t status;
    char part[]; /* or the reason */
} DoneMessage;

enum { WHY_BYTES = sizeof((Err *)0)->text };

/* Does a message of n bytes hold a result of one of n_tickets? */
static inline int is_done_message(const DoneMessage *m, size_t n, size_t part_size, size_t n_tickets)
{
    return n >= sizeof *m && m->ticket < n_tickets && m->status >= 0 && m->status < STATUS_COUNT &&
           n == sizeof *m + (m->status == STATUS_OK ? part_size : WHY_BYTES);
}

/* Pauses between looks at MPI, which has no way to wait without using a processor: longer ones the longer nothing
 * comes. */
static inline double longer_pause(double pause, double longest)
{
    return MIN_OF(pause * 1.5, longest);
}
static const double PAUSE_MIN_S = 2e-5;
static inline void pause_s(double seconds)
{
    nanosleep(&(struct timespec){.tv_nsec = (long)(1e9 * seconds)}, NULL);
}

extern const Executor EXECUTOR_RANKS; /* ranks.c */

/* serve.c: does the tasks of rank 0 until that says LEAVE. */
Status serve(ReopenFn reopen, Err *err);

/* The name of this machine, cut where it is too long. */
void host_name(char host[HOST_MAX]);
