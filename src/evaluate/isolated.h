/* evaluate/isolated.h -- simulations in processes of their own (run.isolate): one that crashes ends its design alone.
 *
 * Every worker of a queue has a child, forked with the first task, which has all that is open then and does task after
 * task; it answers with the bytes of the part. A child that has ended is replaced with the next task. When we end,
 * however that is, the sockets close and the children end.
 *
 * Life cycle  isolated_open -> isolated_run ... -> isolated_close (NULL is fine)
 * Threads     isolated_run by several, each for a worker of its own
 * Stops       may_go_on of the task is asked five times a second; the child is killed then */
#pragma once

#include "evaluate/problem.h"

typedef struct Isolated Isolated;

/* What a child does with a task, whose x has n_var numbers. */
typedef struct {
    Status (*simulate)(void *self, size_t worker, const Task *task, Err *err);
    void *self;
    size_t n_var;
} IsolatedWork;

Status isolated_open(Isolated **out, size_t n_workers, const IsolatedWork *work, Err *err);
void isolated_close(Isolated *q);

/* *how: the signal that ended the child meanwhile, or -1 where it ended otherwise, and the part is not written; 0: it
 * answered. */
Status isolated_run(Isolated *q, size_t worker, const Task *task, int *how, Err *err);
