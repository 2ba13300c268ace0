#include "store/folder.h"

#include <errno.h>
#include <fcntl.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "store/lock.h"
#include "store/output.h"

void folder_path(const Folder *folder, const char *name, char path[PATH_MAX])
{
    snprintf(path, PATH_MAX, "%s/%s", folder->path, name);
}

int folder_has(const Folder *folder, const char *name)
{
    char path[PATH_MAX];
    folder_path(folder, name, path);
    return access(path, F_OK) == 0;
}

size_t folder_rows(const Folder *folder, const char *name)
{
    char path[PATH_MAX], bytes[1 << 16];
    size_t lines = 0;
    ssize_t n;
    folder_path(folder, name, path);
    const int fd = open(path, O_RDONLY | O_CLOEXEC | O_NONBLOCK);
    struct stat about;
    if (fd < 0)
        return 0;
    while (fstat(fd, &about) == 0 && S_ISREG(about.st_mode) && (n = read(fd, bytes, sizeof bytes)) > 0)
        for (const char *at = bytes; (at = memchr(at, '\n', (size_t)(bytes + n - at))); at++)
            lines++;
    close(fd);
    return lines > 0 ? lines - 1 : 0;
}

int folder_is_run(const char *path)
{
    Folder f = {.lock = -1};
    snprintf(f.path, sizeof f.path, "%s", path);
    return folder_has(&f, "run.sqlite") || folder_has(&f, "lock");
}

int folder_keeps(const char *path)
{
    static const char *const NAMES[] = {"settings.ini",    "provenance.json", "log.txt",     "log.jsonl", "lock",
                                        "evaluations.csv", "front.csv",       "nearest.csv", "run.sqlite"};
    char real[PATH_MAX];
    if (!realpath(path, real))
        snprintf(real, sizeof real, "%s%s", strchr(path, '/') ? "" : "./", path);
    char *name = strrchr(real, '/');
    *name++ = 0;
    for (size_t k = 0; k < sizeof NAMES / sizeof NAMES[0]; k++)
        if (strcmp(name, NAMES[k]) == 0 || strncmp(name, "run.sqlite-", 11) == 0)
            return folder_is_run(real[0] ? real : "/");
    return 0;
}

Status folder_advise(const char *path, Status status, Err *err)
{
    Folder f = {.lock = -1};
    const int is_empty = strstr(err->text, ": is empty") != NULL;
    if (status != STATUS_IO ||
        (!is_empty && !strstr(err->text, ": is damaged") && !strstr(err->text, ": is no database")))
        return status;
    snprintf(f.path, sizeof f.path, "%s", path);
    const size_t n = folder_rows(&f, "evaluations.csv");
    if (n > 0)
        return fail(err, status,
                    "%.250s; evaluations.csv beside it has %zu evaluations: --new --set "
                    "search.start=%s/evaluations.csv begins another run with these designs",
                    err->text, n, path);
    return is_empty ? fail(err, status, "%.250s; remove it, and the run begins again", err->text) : status;
}

static Status make_folders(const char *folder, Err *err)
{
    char part[PATH_MAX];
    for (const char *end = folder + 1;; end++) {
        if (*end && *end != '/')
            continue;
        snprintf(part, sizeof part, "%.*s", (int)(end - folder), folder);
        if (mkdir(part, 0777) != 0 && errno != EEXIST)
            return fail(err, STATUS_IO, "%s: cannot be made a folder: %s", part, strerror(errno));
        if (!*end)
            return STATUS_OK;
    }
}

static Status take_lock(Folder *folder, Err *err)
{
    char path[PATH_MAX];
    TRY(make_folders(folder->path, err));
    folder_path(folder, "lock", path);
    return lock_take(path, &folder->lock, err);
}

static int holds_run(const Folder *folder)
{
    return folder_has(folder, "run.sqlite") || folder_rows(folder, "evaluations.csv") > 0;
}

/* It is looked at again once the lock is held: another process may have had a whole run meanwhile. */
static Status take_free_folder(Folder *folder, const char *path, Err *err)
{
    char lock[PATH_MAX];
    LockHolder holder;
    for (int i = 2;; i++) {
        folder_path(folder, "lock", lock);
        if (!holds_run(folder) && !lock_is_held(lock, &holder)) {
            const Status status = take_lock(folder, err);
            if (status != STATUS_OK && !lock_is_held(lock, &holder))
                return status;
            if (status == STATUS_OK && !holds_run(folder))
                return STATUS_OK;
            folder_release(folder);
        }
        if (snprintf(folder->path, sizeof folder->path, "%s-%d", path, i) >= (int)sizeof folder->path)
            return fail(err, STATUS_IO, "%.200s...: the path is too long", path);
    }
}

Status folder_take(Folder *folder, const char *path, int fresh, Err *err)
{
    folder->lock = -1;
    if (snprintf(folder->path, sizeof folder->path, "%s", path) >= (int)sizeof folder->path)
        return fail(err, STATUS_IO, "%.200s...: the path is too long", path);
    return fresh ? take_free_folder(folder, path, err) : take_lock(folder, err);
}

void folder_release(Folder *folder)
{
    lock_release(folder->lock);
    folder->lock = -1;
}

/* -- files --------------------------------------------------------------------------------------------------------- */

Status folder_write(const Folder *folder, const char *name, WriteFn write, const void *content, Err *err)
{
    char path[PATH_MAX], room[1 << 16];
    Output o;
    folder_path(folder, name, path);
    TRY(output_open_inside(&o, path, err));
    setvbuf(o.stream, room, _IOFBF, sizeof room);
    write(o.stream, content);
    return output_close(&o, err);
}

Status append_open(Append *a, const Folder *folder, const char *name, Err *err)
{
    folder_path(folder, name, a->path);
    struct stat about;
    if (lstat(a->path, &about) == 0 && !S_ISREG(about.st_mode))
        return fail(err, STATUS_IO, "%s: is a link or no file, which is not written to; remove it", a->path);
    a->stream = fopen(a->path, "ae");
    return a->stream ? STATUS_OK : fail(err, STATUS_IO, "%s: cannot be written: %s", a->path, strerror(errno));
}

Status append_flush(const Append *a, Err *err)
{
    errno = EIO; /* of an earlier write whose cause is gone */
    if (fflush(a->stream) != 0 || ferror(a->stream))
        return fail(err, STATUS_IO, "%s: cannot be written: %s", a->path, strerror(errno));
    return STATUS_OK;
}

Status append_close(Append *a, Err *err)
{
    TRY(output_sync(a->stream, a->path, err));
    append_free(a); /* all of it is on the disk */
    return STATUS_OK;
}

void append_free(Append *a)
{
    if (a->stream)
        fclose(a->stream);
    a->stream = NULL;
}
