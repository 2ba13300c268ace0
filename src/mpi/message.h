/* mpi/message.h -- what rank 0 and the ranks that evaluate say to each other.
 *
 *   rank 0                                                  every other rank
 *   OPEN   OpenMessage, then the recipe by broadcast    ->  opens the problem
 *                                                       <-  OPENED  OpenedMessage
 *   TASKS  epoch, n times TaskMessage and x (n_var)     ->  does them
 *                                                       <-  DONE    epoch, n times DoneMessage and the part, or the
 *                                                                   reason of a status that is not ok
 *                                                       <-  ALIVE   while it has tasks, every ALIVE_S
 *   STOP   epoch                                        ->  tasks that are not begun come back at once, STATUS_STOPPED
 *   LEAVE                                               ->  ends
 *                                                       <-  LEFT
 *
 * epoch: of the queue that the tasks are of; what comes late from an earlier one is dropped. Plain bytes: all ranks are the
 * same program on the same kind of machine.
 *
 * Threads  MPI is called by one thread at a time (MPI_THREAD_SERIALIZED) */
#ifndef IMTET_MPI_MESSAGE_H
#define IMTET_MPI_MESSAGE_H

#include <stddef.h>
#include <stdint.h>
#include <string.h>

#include "evaluate/cluster.h"

enum { TAG_OPEN = 1, TAG_OPENED, TAG_TASKS, TAG_DONE, TAG_ALIVE, TAG_STOP, TAG_LEAVE, TAG_LEFT };

enum { HOST_MAX = 64 };

/* A message of tasks, and one of parts, unless a single one is longer. */
enum { TASKS_BYTES = 1 << 14, DONE_BYTES = 1 << 18 };

/* A rank with tasks sends something so often; one that did not for SILENT_S of rank 0's own running time is given up. */
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
    uint64_t ticket; /* rank 0's */
    int64_t id;
    uint64_t part, repeat;
    Variant variant;
} TaskMessage;

typedef struct {
    uint64_t ticket;
    double seconds;
    int64_t status;
} DoneMessage;

typedef struct {
    char *bytes;
    size_t n, n_max;
} Buffer;

static inline void *buffer_put(Buffer *b, const void *from, size_t n)
{
    void *at = b->bytes + b->n;
    memcpy(at, from, n);
    b->n += n;
    return at;
}

/* The next n bytes; they are there: both sides are the same program. */
static inline void buffer_get(Buffer *b, void *to, size_t n)
{
    memcpy(to, b->bytes + b->n, n);
    b->n += n;
}

static inline size_t task_bytes(size_t n_var)
{
    return sizeof(TaskMessage) + n_var * sizeof(double);
}

static inline size_t done_bytes(size_t part_size)
{
    const size_t why = sizeof((Err *)0)->text;
    return sizeof(DoneMessage) + (part_size > why ? part_size : why);
}

static inline size_t at_least(size_t bytes, size_t one)
{
    return sizeof(int64_t) + (bytes > one ? bytes : one);
}

/* The next result of a message of n bytes, its part or reason at *part: 1; 0: there is none more; -1: what follows is none. */
static inline int buffer_get_done(Buffer *b, size_t n, size_t part_size, size_t n_tickets, DoneMessage *m,
                                  const char **part)
{
    if (b->n == n)
        return 0;
    if (n - b->n < sizeof *m)
        return -1;
    buffer_get(b, m, sizeof *m);
    const size_t size = m->status == STATUS_OK ? part_size : sizeof((Err *)0)->text;
    if (m->ticket >= n_tickets || m->status < 0 || m->status >= STATUS_COUNT || n - b->n < size)
        return -1;
    *part = b->bytes + b->n;
    b->n += size;
    return 1;
}

/* Pauses between looks at MPI, which has no way to wait without using a processor: longer ones the longer nothing comes. */
static inline double longer_pause(double pause, double longest)
{
    return pause * 1.5 < longest ? pause * 1.5 : longest;
}
static const double PAUSE_MIN_S = 2e-5;

extern const Executor EXECUTOR_RANKS; /* ranks.c */

/* serve.c: does the tasks of rank 0 until that says LEAVE. */
Status serve(ReopenFn reopen, Err *err);

/* The name of this machine, cut where it is too long. */
void host_name(char host[HOST_MAX]);

#endif
