/* store/lock.h -- who works on a run: a lock that ends with its process, however that ends.
 *
 * The file holds "PID HOST"; the lock itself is the system's (an open file description lock), so that a file left
 * behind by a process that was killed locks nobody out. Across machines as far as the file system passes locks on.
 *
 * Life cycle  lock_take -> lock_release */
#ifndef IMTET_STORE_LOCK_H
#define IMTET_STORE_LOCK_H

#include "base/status.h"

typedef struct {
    long pid;
    char host[72];
} LockHolder;

/* fd for lock_release. Held by somebody else, and still so 1.5 s later: STATUS_IO, who and where. */
Status lock_take(const char *path, int *fd, Err *err);
void lock_release(int fd); /* -1 is fine */

/* Whether somebody holds it, and who. */
int lock_is_held(const char *path, LockHolder *holder);

#endif
