#include "base/whole_file.h"

#include <errno.h>
#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

void folder_of(const char *path, char folder[PATH_MAX])
{
    const char *slash = strrchr(path, '/');
    snprintf(folder, PATH_MAX, "%.*s", slash ? (int)(slash - path + 1) : 1, slash ? path : ".");
}

static const char OWN_FILES[] = "/proc/self/fd";

/* A file without a name, of which a process that is killed leaves nothing. Where the file system has none, a new file:
 * what lies there under that name, a prepared link say, is removed. */
static Status open_at(Output *o, const char *path, int in_place, Err *err)
{
    char folder[PATH_MAX];
    memset(o, 0, sizeof *o);
    const int to_stdout = strcmp(path, "-") == 0;
    const int n = snprintf(o->path, sizeof o->path, "%s", path);
    const int m = snprintf(o->temporary, sizeof o->temporary, "%s.%ld.tmp", path, (long)getpid());
    if (n >= PATH_MAX || m >= PATH_MAX)
        return fail(err, STATUS_IO, "%.200s...: the path is too long", path);
    if (in_place || to_stdout) {
        o->temporary[0] = 0;
        /* Not /dev/stdout: opening that again would cut off what a file behind it holds already. */
        o->stream = to_stdout ? fdopen(dup(STDOUT_FILENO), "w") : fopen(o->path, "w");
    } else {
        folder_of(o->temporary, folder);
        unlink(o->temporary);
        const int fd = access(OWN_FILES, X_OK) == 0 ? open(folder, O_TMPFILE | O_WRONLY | O_CLOEXEC, 0666) : -1;
        o->stream = fd >= 0 ? fdopen(fd, "w") : fopen(o->temporary, "wxe");
    }
    if (!o->stream)
        return fail_errno(err, path, "cannot be written");
    return STATUS_OK;
}

Status output_open(Output *o, const char *path, Err *err)
{
    static const char MAGIC[] = "SQLite format 3";
    char head[sizeof MAGIC] = "";
    struct stat there;
    const int is_there = lstat(path, &there) == 0, is_file = is_there && S_ISREG(there.st_mode);
    FILE *f = is_file ? fopen(path, "re") : NULL;
    const int is_database = f && fread(head, sizeof MAGIC - 1, 1, f) == 1 && strcmp(head, MAGIC) == 0;
    if (f)
        fclose(f);
    return is_database ? misused(err, "%s is a database, which is not replaced; name another file", path)
                       : open_at(o, path, is_there && !is_file, err);
}

Status output_open_inside(Output *o, const char *path, Err *err)
{
    return open_at(o, path, 0, err);
}

void output_sync_folder(const char *path)
{
    char folder[PATH_MAX];
    folder_of(path, folder);
    const int fd = open(folder, O_RDONLY | O_DIRECTORY);
    if (fd >= 0) {
        fsync(fd);
        close(fd);
    }
}

Status output_close(Output *o, Err *err)
{
    char own[64];
    struct stat is;
    const int fd = fileno(o->stream);
    Status status = STATUS_OK;

    /* On the disk; a pipe or a terminal has none to wait for. */
    errno = 0;
    if (fflush(o->stream) != 0 || ferror(o->stream))
        status = fail(err, status_of_errno(errno, STATUS_IO), "%s: cannot be written: %s", o->path,
                      errno ? strerror(errno) : "an earlier write failed, as on a full disk");
    else if (fsync(fd) != 0 && errno != EINVAL && errno != EROFS && errno != ENOTSUP)
        status = fail_errno(err, o->path, "cannot be brought to the disk");

    /* The temporary file gets its name, if it has none yet, and then its place. */
    snprintf(own, sizeof own, "%s/%d", OWN_FILES, fd);
    if (status == STATUS_OK && o->temporary[0] && fstat(fd, &is) == 0 && is.st_nlink == 0 &&
        linkat(AT_FDCWD, own, AT_FDCWD, o->temporary, AT_SYMLINK_FOLLOW) != 0)
        status = fail_errno(err, o->path, "cannot be written");
    if (fclose(o->stream) != 0)
        THEN(status, fail_errno(err, o->path, "cannot be written"));
    o->stream = NULL;
    if (!o->temporary[0])
        return status;
    if (status == STATUS_OK && rename(o->temporary, o->path) != 0)
        status = fail_errno(err, o->path, "cannot be put in place");
    if (status == STATUS_OK)
        output_sync_folder(o->path);
    else
        unlink(o->temporary);
    return status;
}

void output_abandon(Output *o)
{
    if (o->stream)
        fclose(o->stream);
    if (o->stream && o->temporary[0])
        unlink(o->temporary);
    o->stream = NULL;
}

Status output_end(Output *o, Status status, Err *err)
{
    if (status == STATUS_OK)
        return output_close(o, err);
    output_abandon(o);
    return status;
}
