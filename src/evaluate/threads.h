/* evaluate/threads.h -- executors of this process, and which one a problem gets.
 *
 * An executor takes tasks of the queue, has the simulator do them and gives their parts; it knows nothing of designs.
 * Processes on other machines: evaluate/cluster.h. */
#ifndef IMTET_EVALUATE_THREADS_H
#define IMTET_EVALUATE_THREADS_H

#include "evaluate/problem.h"

extern const Executor EXECUTOR_THREADS; /* a thread for each worker of the problem */
extern const Executor EXECUTOR_CLIENT;  /* the client itself is worker 0, while it waits: no thread at all */

/* Threads where there are several workers, else the client. */
const Executor *executor_for(size_t n_workers);

/* Of a problem with n_workers of its own: the ranks of the cluster where there are some and it has a recipe, as many
 * workers each; else the same. */
void executor_choose(Problem *p);

/* Workers for a setting of so many threads; 0: one for each processor. */
size_t threads_wanted(long setting);

#endif
