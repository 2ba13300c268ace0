/* store/lock.h -- which process works on a run: a lock that ends with its process, however that ends.
 *
 * The file holds "PID HOST"; the lock itself is the system's (an open file description lock), so that a file left
 * behind by a process that was killed locks nothing. Across machines as far as the file system passes locks on.
 *
 * Life cycle  lock_take -> lock_release */
#ifndef IMTET_STORE_LOCK_H
#define IMTET_STORE_LOCK_H

#include "base/status.h"

typedef struct {
    long pid;
    char host[72];
} LockHolder;

/* fd for lock_release. Held by another process, and still so 1.5 s later: STATUS_IO, its id and host. */
Status lock_take(const char *path, int *fd, Err *err);
void lock_release(int fd); /* -1 is fine */

/* Whether a process holds it, and which. */
int lock_is_held(const char *path, LockHolder *holder);

#endif
