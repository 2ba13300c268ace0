#include "run/lock.h"

#include <errno.h>
#include <fcntl.h>
#include <stdio.h>
#include <string.h>
#include <unistd.h>

static void read_holder(int fd, LockHolder *holder)
{
    char text[96] = "";
    *holder = (LockHolder){0, "an unknown machine"};
    if (pread(fd, text, sizeof text - 1, 0) > 0)
        sscanf(text, "%ld %71s", &holder->pid, holder->host);
}

Status lock_take(const char *path, int *fd, Err *err)
{
    struct flock whole = {.l_type = F_WRLCK, .l_whence = SEEK_SET};
    char host[65] = "", text[96];
    *fd = open(path, O_RDWR | O_CREAT | O_CLOEXEC, 0666);
    if (*fd < 0)
        return fail(err, STATUS_IO, "%s: cannot be written: %s", path, strerror(errno));
    if (fcntl(*fd, F_OFD_SETLK, &whole) != 0) {
        const int cause = errno;
        LockHolder holder;
        read_holder(*fd, &holder);
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
        const int cause = errno;
        lock_release(*fd);
        *fd = -1;
        return fail(err, STATUS_IO, "%s: cannot be written: %s", path, strerror(cause));
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
    return held;
}
