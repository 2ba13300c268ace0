/* evaluate/tasks.h -- the queue as an executor sees it (evaluate/queue.h): tasks to be done, and their results.
 *
 * Threads  any */
#ifndef IMTET_EVALUATE_TASKS_H
#define IMTET_EVALUATE_TASKS_H

#include "evaluate/problem.h"

const Problem *queue_problem(const Queue *q);

/* 1 and a task; 0: there is none, now (wait 0) or ever more (wait 1). */
int queue_take(Queue *q, int wait, Task *task);

/* The task is done, its part lies at task->result; a status ends everything, `why` is its reason. */
void queue_give(Queue *q, const Task *task, Status status, const Err *why);

#endif
