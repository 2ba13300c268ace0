/* store/run_read.h -- a run read from its database, also while it is worked on.
 *
 * Ownership  run_read and run_load allocate, run_free releases
 * Errors     no database there: STATUS_MISSING; damaged: STATUS_IO; the Run is empty then */
#pragma once

#include "store/database.h"
#include "store/run.h"

int run_is_there(const char *folder);
Status run_wanted(const char *folder, Err *err); /* else STATUS_MISSING */

/* Calls take for every run in a folder of runs, by version order of the names; -1, with errno: it cannot be read. */
typedef void (*RunFolderFn)(const char *folder, const char *name, void *user);
int runs_each(const char *folder, RunFolderFn take, void *user);

Status run_read(Run *run, const char *folder, Err *err);

Status run_load(Run *run, Database *d, const char *folder, RunParts parts, Err *err);
