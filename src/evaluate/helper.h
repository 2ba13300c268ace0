/* evaluate/helper.h -- a worker process, and beside it one of our own that kills it with all that it has started when
 * we end, however that is: by a signal, out of memory, kill -9.
 *
 * The helper has one end of a pair of sockets; the other closes with us. The worker has a process group of its own,
 * which gets SIGKILL then. Where the helper itself is killed the kernel kills the worker: Linux sends a child the
 * signal of PR_SET_PDEATHSIG when the thread that started it ends, and the helper has one thread. Of what we have open
 * (locks, a store) neither keeps anything.
 *
 * Life cycle  helper_start -> helper_end
 * Threads     any
 * Source      prctl(2), PR_SET_PDEATHSIG; vfork(2) */
#pragma once

#include "base/status.h"

/* How a worker is started. */
typedef struct {
    char *const *words;                     /* a command, up to NULL; NULL: */
    void (*serve)(void *self, size_t slot); /* ... in a fork of us */
    void *self;
} HelperWork;

typedef struct {
    pid_t pid, group; /* 0: there is none; of the worker */
    int to; /* readable when the worker has ended; where the system has no pidfd the end of its output tells */
} Helper;

/* A worker with these descriptors as standard input and output and no signal blocked. Returns 0, or errno of what
 * failed. */
int helper_start(Helper *h, const HelperWork *work, size_t slot, int in, int out);

/* The worker is done with, and killed with its group. Returns how it ended, as waitpid has it; -1: its helper was
 * killed, and it for that reason alone. */
int helper_end(Helper *h);
