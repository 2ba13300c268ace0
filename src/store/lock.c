#include "store/lock.h"

#include <errno.h>
#include <fcntl.h>
#include <signal.h>
#include <stdio.h>
#include <string.h>
#include <time.h>
#include <unistd.h>

static void read_holder(int fd, LockHolder *holder)
{
    char text[96] = "";
    *holder = (LockHolder){0, "an unknown machine"};
    if (pread(fd, text, sizeof text - 1, 0) > 0)
        sscanf(text, "%ld %71s", &holder->pid, holder->host);
}

static int is_gone(const LockHolder *holder)
{
    char host[72] = "";
    gethostname(host, sizeof host - 1);
    return strcmp(host, holder->host) == 0 && kill((pid_t)holder->pid, 0) != 0 && errno == ESRCH;
}

/* The system takes moments to tear a killed process down, and one that is killed while it starts a worker leaves the
 * lock to it until that one has begun its own program: every holder gets PATIENCE, 1.5 s, to let go. */
static int try_lock(int fd, LockHolder *holder)
{
    enum { PATIENCE = 75, PAUSE_NS = 20000000 };
    struct flock whole = {.l_type = F_WRLCK, .l_whence = SEEK_SET};
    for (int i = 0; fcntl(fd, F_OFD_SETLK, &whole) != 0; i++) {
        const int cause = errno;
        if ((cause != EAGAIN && cause != EACCES) || i == PATIENCE) {
            read_holder(fd, holder);
            return cause;
        }
        nanosleep(&(struct timespec){.tv_nsec = PAUSE_NS}, NULL);
    }
    return 0;
}

Status lock_take(const char *path, int *fd, Err *err)
{
    LockHolder holder = {0};
    char host[65] = "", text[96];
    *fd = open(path, O_RDWR | O_CREAT | O_CLOEXEC | O_NOFOLLOW, 0666);
    if (*fd < 0)
        return fail(err, STATUS_IO, "%s: cannot be written: %s", path, strerror(errno));
    const int cause = try_lock(*fd, &holder);
    if (cause != 0) {
        close(*fd);
        *fd = -1;
        return cause == EAGAIN || cause == EACCES
                   ? fail(err, STATUS_IO, "%.*s: is in use by process %ld on %s", (int)(strrchr(path, '/') - path),
                          path, holder.pid, holder.host)
                   : fail(err, STATUS_IO, "%s: cannot be locked: %s", path, strerror(cause));
    }
    gethostname(host, sizeof host - 1);
    const int n = snprintf(text, sizeof text, "%ld %s\n", (long)getpid(), host);
    if (ftruncate(*fd, 0) != 0 || pwrite(*fd, text, (size_t)n, 0) != n) {
        const int why = errno;
        lock_release(*fd);
        *fd = -1;
        return fail(err, STATUS_IO, "%s: cannot be written: %s", path, strerror(why));
    }
    return STATUS_OK;
}

void lock_release(int fd)
{
    if (fd >= 0)
        close(fd);
}

int lock_is_held(const char *path, LockHolder *holder)
{
    struct flock whole = {.l_type = F_WRLCK, .l_whence = SEEK_SET};
    const int fd = open(path, O_RDONLY | O_CLOEXEC);
    if (fd < 0)
        return 0;
    const int held = fcntl(fd, F_OFD_GETLK, &whole) == 0 && whole.l_type != F_UNLCK;
    read_holder(fd, holder);
    close(fd);
    return held && !is_gone(holder);
}
