/* evaluate/tasks.h -- the queue as an executor sees it (evaluate/queue.h): tasks to be done, and their results.
 *
 * Threads  any */
#pragma once

#include "evaluate/problem.h"

/* Up to n_max tasks for a worker, and how many; 0: there is none, now (wait 0) or ever more (wait 1). */
size_t queue_take(Queue *q, size_t worker, int wait, size_t n_max, Task tasks[]);

/* The task is done, its part lies at task->result; a status ends everything, `why` is its reason. */
void queue_give(Queue *q, const Task *task, Status status, const Err *why);

/* -- who does them ------------------------------------------------------------------------------------------------- */

/* Chooses the executor of a problem with n_workers: the ranks of the cluster (evaluate/cluster.h), with as many workers
 * each, if there are ranks and the problem has a recipe; else its own workers. */
void executor_choose(Problem *p);

/* Workers for a setting of so many threads; 0: one for each processor. */
size_t threads_wanted(long setting);
