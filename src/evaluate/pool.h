/* evaluate/pool.h -- workers that are elsewhere: processes of this machine, and the ranks of a cluster (src/mpi). A
 * thread of the queue (evaluate/tasks.h) gives each its tasks and waits for them, all by these rules:
 *
 *   ended     with tasks, its task has failed; of several none has, and they are asked one by one. Asked again of a
 *             fresh worker is what it had no part in: its helper was killed; or, once, it had given answers before and
 *             ended by itself within a second of the request (may_leave)
 *   silent    for timeout_s of our own running time, the same: where the whole machine was suspended none was silent. A
 *             rank says now and then that it lives; one that does not ends everything, to be resumed
 *   stopped   what is under way gets grace_s to end, then it counts as never begun
 *
 * Life cycle  pool_open -> pool_do ... -> pool_close ({0} is fine)
 * Threads     pool_do by several, each for a worker of its own
 * Processes   each in its own process group, killed with it when it is done with (evaluate/helper.h); standard error is
 *             shared with ours. A command is started by the first task it gets, and kept */
#pragma once

#include "evaluate/helper.h"
#include "evaluate/problem.h"

enum { LINE_MAX_BYTES = 1 << 20 };

/* Time for tasks under way in a process to end after a stop. */
static const double PROCESS_GRACE_S = 5.0;

typedef struct {
    const Pool *pool;
    const Task *task; /* (n) under way, the first n_done are done; less n: the rest is given up */
    size_t n, n_done;
    double silent_s;
    Err why; /* of a fault that ends everything */
    Helper helper;
    int in, out, reader; /* reader: of `in`, so that none of us ever writes to nobody */
    char *line;          /* (LINE_MAX_BYTES) what has come of an answer */
    size_t n_line;
    char *request; /* room for `batch` designs */
    size_t batch;  /* designs that it wants at once */
    size_t n_request, n_sent;
    double asked;      /* the next answer */
    size_t n_answered; /* by this process */
    int is_second;     /* the request went to a fresh process */
    int how;           /* the last one ended (evaluate/helper.h) */
} Worker;

/* How one speaks with them. */
typedef struct {
    const char *name; /* of the setting */
    HelperWork work;
    size_t request_bytes; /* for one design */
    double timeout_s;     /* for one; of a worker that is no process, between two signs of life */
    double grace_s;
    int may_leave;
    size_t (*write)(void *self, const Worker *w, char *request);
    /* Sends the request if the worker is no process; answers are written to `in`, read at `out`. NULL: a process */
    void (*send)(void *self, const Worker *w);
    void (*look)(void *self, Worker *w); /* takes whole answers from `line`, each by pool_settle */
    /* reason: of an outcome, to be written into the task's part */
    void (*tell)(void *self, Worker *w, Outcome outcome, const char *reason);
    void *self;
} Protocol;

struct Pool {
    Protocol protocol;
    size_t n_workers;
    Worker *worker; /* (n_workers) */
};

Status pool_open(Pool *p, const Protocol *protocol, size_t n_workers, Err *err);
void pool_close(Pool *p);

static inline Pool *pool_of(const Simulator *s, void *self)
{
    return s->pool ? s->pool(self) : NULL;
}

/* n tasks, TASKS_MAX at most, by a worker; the first *n_done are done where a status ends it. And its two halves, for a
 * worker that takes n at once. */
Status pool_do(Pool *p, size_t worker, size_t n, const Task tasks[], size_t *n_done, Err *err);
Status pool_ask(Worker *w, size_t n, const Task tasks[], Err *err);
Status pool_wait(Worker *w, Err *err);

/* So many designs at once from now on, where there is memory. 0: it is no number from 1 to TASKS_MAX. */
int pool_batch(Worker *w, size_t n);

/* Ends the worker's next task with an outcome; kill_it: the worker cannot be trusted any more. */
__attribute__((format(printf, 4, 5))) void pool_settle(Worker *w, Outcome outcome, int kill_it, const char *format,
                                                       ...);
