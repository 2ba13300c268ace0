#include "store/folder.h"

#include <errno.h>
#include <fcntl.h>
#include <signal.h>
#include <sys/stat.h>
#include <time.h>
#include <unistd.h>

void utc_now(char text[24])
{
    struct tm parts;
    const time_t now = time(NULL);
    gmtime_r(&now, &parts);
    strftime(text, 24, "%FT%TZ", &parts);
}

void folder_path(const char *folder, const char *name, char path[PATH_MAX])
{
    snprintf(path, PATH_MAX, "%s/%s", folder, name);
}

int folder_has(const char *folder, const char *name)
{
    char path[PATH_MAX];
    return snprintf(path, sizeof path, "%s/%s", folder, name) < PATH_MAX && access(path, F_OK) == 0;
}

int folder_is_run(const char *path)
{
    return folder_has(path, "run.sqlite") || folder_has(path, "lock");
}

int run_drop_name(char *path)
{
    char *name = basename(path);
    if (strcmp(name, "run.sqlite") != 0)
        return 0;
    if (name == path)
        strcpy(path, ".");
    else
        name[name - path > 1 ? -1 : 0] = 0; /* of /run.sqlite the root is left */
    return 1;
}

int folder_keeps(const char *path)
{
    static const char *const NAMES[] = {"settings.ini", "provenance.json", "log.jsonl",  "lock",         "front.csv",
                                        "nearest.csv",  "notes.json",      "run.sqlite", "verdicts.json"};
    char real[PATH_MAX];
    if (!realpath(path, real))
        snprintf(real, sizeof real, "%s%s", strchr(path, '/') ? "" : "./", path);
    char *name = strrchr(real, '/');
    *name++ = 0;
    for (size_t k = 0; k < N_OF(NAMES); k++)
        if (strcmp(name, NAMES[k]) == 0 || strncmp(name, "run.sqlite-", 11) == 0)
            return folder_is_run(*real ? real : "/");
    return 0;
}

Status folder_advise(const char *path, Status status, Err *err)
{
    char front[PATH_MAX];
    if (status == STATUS_OK || (err->sub != SUB_DAMAGED && err->sub != SUB_NO_RUN && err->sub != SUB_EMPTY))
        return status;
    folder_path(path, "front.csv", front);
    if (access(front, R_OK) == 0) /* it was one */
        return fail_sub(err, STATUS_IO, err->sub,
                        "%.250s; --new --set search.start=%s begins another run with its last front", err->text, front);
    return err->sub == SUB_EMPTY
               ? fail_sub(err, status, err->sub, "%.250s; remove it and `lock`, and the run begins again", err->text)
               : status;
}

/* -- the lock ------------------------------------------------------------------------------------------------------ */

static void read_holder(int fd, LockHolder *holder)
{
    char text[96] = "";
    *holder = (LockHolder){.host = "an unknown machine"};
    if (pread(fd, text, sizeof text - 1, 0) > 0)
        sscanf(text, "%ld %71s %zu", &holder->pid, holder->host, &holder->n_stored);
}

/* Padded, so that a later line is as long. */
static Status write_holder(int fd, size_t n_stored)
{
    char host[65] = "", text[128];
    gethostname(host, sizeof host - 1);
    const int n = snprintf(text, sizeof text, "%ld %s %-12zu\n", (long)getpid(), host, n_stored);
    return pwrite(fd, text, n, 0) == n && ftruncate(fd, n) == 0 ? STATUS_OK : STATUS_IO;
}

/* On a full disk the number before stays, which is no more than there are. */
void folder_note(const Folder *folder, size_t n_stored)
{
    write_holder(folder->lock, n_stored);
}

void folder_release(Folder *folder)
{
    char path[PATH_MAX];
    if (folder->lock >= 0 && folder->is_new && !folder_has(folder->path, "run.sqlite")) {
        folder_path(folder->path, "lock", path);
        unlink(path);
        rmdir(folder->path);
    }
    if (folder->lock >= 0)
        close(folder->lock);
    folder->lock = -1;
}

int folder_is_held(const char *folder, LockHolder *holder)
{
    char path[PATH_MAX], host[72] = "";
    struct flock whole = {.l_type = F_WRLCK, .l_whence = SEEK_SET};
    folder_path(folder, "lock", path);
    const int fd = open(path, O_RDONLY | O_CLOEXEC);
    if (fd < 0)
        return 0;
    const int held = fcntl(fd, F_OFD_GETLK, &whole) == 0 && whole.l_type != F_UNLCK;
    read_holder(fd, holder);
    close(fd);
    gethostname(host, sizeof host - 1);
    const int is_gone = strcmp(host, holder->host) == 0 && kill((pid_t)holder->pid, 0) != 0 && errno == ESRCH;
    return held && !is_gone;
}

/* -- taking it ----------------------------------------------------------------------------------------------------- */

/* Makes the folder, with those above it, and takes its lock. The system takes moments to tear a killed process down,
 * and one that is killed while it starts a worker leaves the lock to it until that one has begun its own program: every
 * holder gets PATIENCE, 1.5 s, to let go. */
static Status take_lock(Folder *folder, Err *err)
{
    enum { PATIENCE = 75, PAUSE_NS = 20000000 };
    char path[PATH_MAX];
    struct flock whole = {.l_type = F_WRLCK, .l_whence = SEEK_SET};
    LockHolder holder;
    folder->is_new = access(folder->path, F_OK) != 0;
    for (const char *end = folder->path + 1;; end++) {
        if (*end && *end != '/')
            continue;
        snprintf(path, sizeof path, "%.*s", (int)(end - folder->path), folder->path);
        if (mkdir(path, 0777) != 0 && errno != EEXIST)
            return fail_errno(err, path, "cannot be made a folder");
        if (!*end)
            break;
    }
    folder_path(folder->path, "lock", path);
    const int fd = open(path, O_RDWR | O_CREAT | O_CLOEXEC | O_NOFOLLOW, 0666);
    if (fd < 0)
        return fail_errno(err, path, "cannot be written");
    int cause = 0, is_held = 0;
    for (int i = 0; fcntl(fd, F_OFD_SETLK, &whole) != 0; i++) {
        cause = errno;
        is_held = cause == EAGAIN || cause == EACCES;
        if (!is_held || i == PATIENCE)
            break;
        cause = 0;
        nanosleep(&(struct timespec){.tv_nsec = PAUSE_NS}, NULL);
    }
    read_holder(fd, &holder);
    Status status = STATUS_OK;
    if (cause != 0)
        status = is_held
                     ? fail(err, STATUS_IO, "%s: is in use by process %ld on %s", folder->path, holder.pid, holder.host)
                     : fail(err, STATUS_IO, "%s: cannot be locked: %s", path, strerror(cause));
    else if (write_holder(fd, holder.n_stored) != STATUS_OK)
        status = fail_errno(err, path, "cannot be written");
    if (status != STATUS_OK) {
        close(fd);
        return status;
    }
    folder->lock = fd;
    folder->n_stored = holder.n_stored;
    return STATUS_OK;
}

/* Free: no run, nothing that one has left, and no process. */
static int is_free(const Folder *folder, int is_own)
{
    LockHolder holder = {0};
    const int is_held = folder_is_held(folder->path, &holder) && !is_own;
    return !is_held && holder.n_stored == 0 && !folder_has(folder->path, "run.sqlite");
}

/* A free folder is looked at again once its lock is held: another process may have had a whole run meanwhile. */
Status folder_take(Folder *folder, const char *path, int fresh, Err *err)
{
    int n = snprintf(folder->path, sizeof folder->path, "%s", path);
    folder->lock = -1;
    for (int i = 2; n < (int)sizeof folder->path; i++) {
        if (!fresh)
            return take_lock(folder, err);
        if (is_free(folder, 0)) {
            const Status status = take_lock(folder, err);
            if (status != STATUS_OK && is_free(folder, 0))
                return status;
            if (status == STATUS_OK && is_free(folder, 1))
                return STATUS_OK;
            folder_release(folder);
        }
        n = snprintf(folder->path, sizeof folder->path, "%s-%d", path, i);
    }
    return fail(err, STATUS_IO, "%.200s...: the path is too long", path);
}

/* -- files --------------------------------------------------------------------------------------------------------- */

/* O_NONBLOCK: a pipe without a reader is refused, not waited for. */
Status folder_log(const char *folder, const char *text, Err *err)
{
    char path[PATH_MAX];
    struct stat about = {0};
    folder_path(folder, "log.jsonl", path);
    if (lstat(path, &about) == 0 && !S_ISREG(about.st_mode))
        return fail(err, STATUS_IO, "%s: is a link or no file, which is not written to; remove it", path);
    const size_t n = strlen(text);
    const int fd = open(path, O_WRONLY | O_APPEND | O_CREAT | O_CLOEXEC | O_NOFOLLOW | O_NONBLOCK, 0666);
    errno = fd < 0 ? errno : ENOSPC; /* of a line that is written in part */
    const int is_whole = fd >= 0 && write(fd, text, n) == (ssize_t)n;
    const Status status = is_whole ? STATUS_OK : fail_errno(err, path, "cannot be written");
    if (fd >= 0)
        close(fd);
    return status;
}
