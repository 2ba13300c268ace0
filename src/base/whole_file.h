/* base/whole_file.h -- writing files so that a reader, or a crash, finds the old content or the new, never a half.
 *
 * Life cycle  output_open -> fprintf(o.stream, ...) -> output_close, or output_abandon to leave things as they were
 * A regular file (or one that is not there yet) is written without a name and put into its place after fsync; a device
 * or a pipe is written in place; the path "-" is standard output. Errors of every write are seen by output_close:
 * STATUS_IO with file and cause. */
#pragma once

#include <limits.h>

#include "base/status.h"

/* The folder that a path is in, with its slash; . where it names none. */
void folder_of(const char *path, char folder[PATH_MAX]);

typedef struct {
    FILE *stream;
    char path[PATH_MAX], temporary[PATH_MAX]; /* temporary: empty when written in place */
} Output;

Status output_open(Output *o, const char *path, Err *err);

/* A file whose name was not typed, in the folder of a run that may come from elsewhere: whatever is there, a link too,
 * is replaced and never followed. */
Status output_open_inside(Output *o, const char *path, Err *err);
Status output_close(Output *o, Err *err);
void output_abandon(Output *o); /* a closed Output is fine */

/* Closed; where status says that writing failed, abandoned and the status returned. */
Status output_end(Output *o, Status status, Err *err);

/* A rename is on the disk when the folder of `path` is. Not every file system allows it: then the file is still whole.
 */
void output_sync_folder(const char *path);
