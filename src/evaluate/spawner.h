/* evaluate/spawner.h -- starts worker processes that the kernel kills when this program ends, however that is.
 *
 * Linux sends a child the signal of PR_SET_PDEATHSIG when the thread that started it ends. So that a worker does not end
 * with the thread that asked for it, all are started by one thread, which lives as long as the spawner. What a worker
 * starts itself is the business of evaluate/guard.h.
 *
 * Life cycle  spawner_start -> spawner_run ... -> spawner_end ({0} is fine), which ends the workers that are left
 * Threads     spawner_run may be called from several; it waits its turn
 * Errors      no thread: STATUS_NO_MEMORY
 * Source      prctl(2), PR_SET_PDEATHSIG; vfork(2) */
#ifndef IMTET_EVALUATE_SPAWNER_H
#define IMTET_EVALUATE_SPAWNER_H

#include <pthread.h>
#include <sys/types.h>

#include "base/status.h"

typedef struct SpawnJob SpawnJob;

typedef struct {
    int is_running, is_ending;
    pthread_t thread;
    pthread_mutex_t lock;
    pthread_cond_t changed;
    SpawnJob *job; /* that is to be done; NULL: none */
} Spawner;

Status spawner_start(Spawner *s, Err *err);

/* The command in a process group of its own, with these descriptors as standard input and output and no signal blocked.
 * Returns 0, or errno of what failed. */
int spawner_run(Spawner *s, char *const words[], int in, int out, pid_t *pid);

void spawner_end(Spawner *s);

#endif
