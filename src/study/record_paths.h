/* study/record_paths.h -- where the ground motions and forces of a run are, also after they were moved.
 *
 * A run has its files by path and by content (FNV-1a, in its provenance): a file that was moved may be named by its
 * new path, another one may not take its place.
 *
 * Threads  no state
 * Errors   a file that is not there: STATUS_MISSING with what to say; other content: STATUS_BAD_DATA */
#pragma once

#include "store/run.h"

enum { MOVED_RECORD, MOVED_RECORDS, MOVED_FORCES, N_MOVED };
extern const char *const MOVED_KEY[N_MOVED]; /* motion.record, motion.records, motion.forces */

/* Where each is now, motion.records: all of the list; NULL: where it was. */
typedef struct {
    const char *path[N_MOVED];
} RecordPaths;

/* Every file of the run can be read, at its place or as `moved` says, and holds what the provenance (JSON) says; s then
 * names the new places. Runs on other problems have none. */
Status record_paths_find(Settings *s, const char *provenance, const RecordPaths *moved, Err *err);

/* Every file that the settings name can be read; where they name those of the run (NULL: of none), these hold what they
 * did there. */
Status record_paths_check(const Settings *s, const Run *run, Err *err);
