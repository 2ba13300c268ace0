/* study/record_paths.h -- where the ground motions of a run are, also after they were moved.
 *
 * A run has its records by path and by content (FNV-1a, in its provenance): a file that was moved may be named by its
 * new path, another one may not take its place.
 *
 * Threads  no state
 * Errors   a record that is not there: STATUS_MISSING with what to say; other content: STATUS_BAD_DATA */
#ifndef IMTET_STUDY_RECORD_PATHS_H
#define IMTET_STUDY_RECORD_PATHS_H

#include "base/status.h"

typedef struct Settings Settings;

typedef struct {
    const char *record;  /* where motion.record is now; NULL: where it was */
    const char *records; /* the same for the list motion.records, all of it */
} RecordPaths;

/* Every record of the run can be read, at its place or as `moved` says, and what was moved holds what the provenance
 * (JSON; NULL: none) says; s then names the new places. Runs on other problems have none. */
Status record_paths_find(Settings *s, const char *provenance, const RecordPaths *moved, Err *err);

#endif
