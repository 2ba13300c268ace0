/* store/folder.h -- the folder of a run, its lock, and files in it that are replaced whole or appended to.
 *
 * Life cycle  folder_take -> folder_write, append_open ... -> folder_release ({.lock = -1} is fine)
 * Links       in it are not followed when writing: the folder may come from elsewhere
 * Errors      STATUS_IO with path and cause */
#ifndef IMTET_STORE_FOLDER_H
#define IMTET_STORE_FOLDER_H

#include <limits.h>
#include <stdio.h>

#include "base/status.h"

typedef struct {
    char path[PATH_MAX - 64];
    int lock; /* -1: not taken */
} Folder;

/* Made where it is not there, and locked (store/lock.h). fresh: the first of path, path-2, path-3, ... that holds no run
 * and that no process works on. */
Status folder_take(Folder *folder, const char *path, int fresh, Err *err);
void folder_release(Folder *folder);

void folder_path(const Folder *folder, const char *name, char path[PATH_MAX]);
int folder_has(const Folder *folder, const char *name);
size_t folder_rows(const Folder *folder, const char *name); /* of a CSV file, its header left out; no file: 0 */

/* Has it held a run? */
int folder_is_run(const char *path);
/* Is it a file that a run keeps in its folder? What leads there by a link is. */
int folder_keeps(const char *path);

/* Behind the message of a run.sqlite that is damaged or empty: what to do, by what evaluations.csv beside it still knows.
 * Returns status. */
Status folder_advise(const char *path, Status status, Err *err);

/* The file replaced as a whole (store/output.h). */
typedef void (*WriteFn)(FILE *f, const void *content);
Status folder_write(const Folder *folder, const char *name, WriteFn write, const void *content, Err *err);

/* A file that only grows. {0} may be freed. */
typedef struct {
    FILE *stream; /* NULL: not open */
    char path[PATH_MAX];
} Append;
Status append_open(Append *a, const Folder *folder, const char *name, Err *err);
Status append_flush(const Append *a, Err *err); /* an earlier write that failed is an error too */
Status append_close(Append *a, Err *err);       /* on the disk */
void append_free(Append *a);

#endif
