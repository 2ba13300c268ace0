/* evaluate/guard.h -- a process of our own that kills worker processes when we end without doing so: by a signal, out of
 * memory, kill -9.
 *
 * The workers themselves are killed by the kernel (evaluate/spawner.h), whatever becomes of the guard; it is for what they
 * have started.
 *
 * It holds one end of a pair of sockets. Their other end closes when we end, however that is; then every process group
 * that it knows of gets SIGKILL. It is in a session of its own, has no other file open, and uses no processor time.
 *
 * Life cycle  guard_start -> guard_tell, guard_look ... -> guard_end
 * Threads     guard_tell and guard_look may be called from several, guard_tell each for slots of its own
 * Errors      where it cannot be started; one that was killed is replaced by guard_look, as far as that can be done */
#ifndef IMTET_EVALUATE_GUARD_H
#define IMTET_EVALUATE_GUARD_H

#include <pthread.h>
#include <stddef.h>
#include <sys/types.h>

#include "base/status.h"

typedef struct {
    pid_t pid; /* 0: none */
    int to;
    size_t n_slots;
    pid_t *group; /* (n_slots) 0: none */
    pthread_mutex_t lock;
} Guard;

Status guard_start(Guard *g, size_t n_slots, Err *err);

/* The process group in that slot (0 .. n_slots-1) from now on; 0: none. */
void guard_tell(Guard *g, size_t slot, pid_t group);

/* Sees to it that there is a guard: to be called now and then. */
void guard_look(Guard *g);

void guard_end(Guard *g); /* {0} is fine */

#endif
