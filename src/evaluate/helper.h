/* evaluate/helper.h -- a process of our own that starts worker processes, and kills them with all that they have
 * started when we end, however that is: by a signal, out of memory, kill -9.
 *
 * It has one end of a pair of sockets; the other one closes with us. Every worker has a process group of its own, which
 * gets SIGKILL then. Where the helper itself is killed the kernel kills the workers: Linux sends a child the signal of
 * PR_SET_PDEATHSIG when the thread that started it ends, and the helper has one thread, which lives as long as it does.
 * Another helper takes its place with the next worker that is started.
 *
 * Life cycle  helper_start -> helper_run, helper_release ... -> helper_end ({0} is fine)
 * Threads     helper_run and helper_release may be called from several, each for slots of its own
 * Source      prctl(2), PR_SET_PDEATHSIG; unix(7), SCM_RIGHTS; vfork(2) */
#pragma once

#include <pthread.h>
#include <sys/types.h>

#include "base/status.h"

typedef struct {
    pid_t pid; /* 0: none */
    int to;
    char *const *words;
    size_t n_slots;
    pid_t *group; /* (n_slots) of the workers, 0: none */
    pthread_mutex_t lock;
} Helper;

/* words: the command of every worker, up to NULL. */
Status helper_start(Helper *h, char *const words[], size_t n_slots, Err *err);

/* A worker in that slot (0 .. n_slots-1), with these descriptors as standard input and output and no signal blocked.
 * Returns 0, or errno of what failed. */
int helper_run(Helper *h, size_t slot, int in, int out, pid_t *pid);

/* Its worker is done with: killed with its group, or, where it has ended, its group left alone. */
void helper_release(Helper *h, size_t slot, int kill_it);

/* The helper has ended, and all its workers with it. */
int helper_is_lost(Helper *h);

void helper_end(Helper *h);
