/* store/folder.h -- the folder of a run: which process works on it, the files in it, and the log that is appended to.
 *
 * The file `lock` holds "PID HOST N": the process, and how many evaluations the database has; the lock itself is the
 * system's (an open file description lock) and ends with its process, so that a file left behind by one that was killed
 * locks nothing. Across machines as far as the file system passes locks on.
 *
 * Life cycle  folder_take -> ... -> folder_release ({.lock = -1} is fine)
 * Links       in it are not followed when writing: the folder may come from elsewhere
 * Errors      STATUS_IO with path and cause */
#pragma once

#include <limits.h>

#include "base/status.h"

typedef struct {
    char path[PATH_MAX - 64];
    int lock;        /* -1: not taken */
    int is_new;      /* made by folder_take: removed again where no run came of it */
    size_t n_stored; /* evaluations that the database had when the folder was taken, as the lock says */
} Folder;

/* Made where it is not there, and locked; held by another process, and still so 1.5 s later: STATUS_IO, its id and
 * machine. fresh: the first of path, path-2, path-3, ... that holds no run and that no process works on. */
Status folder_take(Folder *folder, const char *path, int fresh, Err *err);
void folder_release(Folder *folder);

/* So many evaluations are on the disk: a database with fewer has lost its journal. */
void folder_note(const Folder *folder, size_t n_stored);

typedef struct {
    long pid;
    char host[72];
    size_t n_stored;
} LockHolder;

/* Whether a process holds the folder's lock, and which. */
int folder_is_held(const char *folder, LockHolder *holder);

/* FOLDER/NAME, cut where it is longer. */
void folder_path(const char *folder, const char *name, char path[PATH_MAX]);
int folder_has(const char *folder, const char *name);

/* Has it held a run? */
int folder_is_run(const char *path);

/* Is it a file that a run keeps in its folder? What leads there by a link is. */
int folder_keeps(const char *path);

/* Who names the database means the run: of RUN/run.sqlite the folder is left. Returns whether it was one. */
int run_drop_name(char *path);

/* Appends advice to the message about a damaged or empty run.sqlite. Returns status. */
Status folder_advise(const char *path, Status status, Err *err);

/* Appends to log.jsonl. */
Status folder_log(const char *folder, const char *text, Err *err);

/* 2026-01-31T23:59:59Z, now */
void utc_now(char text[24]);
