/* study/moved.h -- the ground motions of a run, also where they lie elsewhere by now.
 *
 * A run knows its records by path and by content (FNV-1a, in its provenance): a file that was moved may be named by its new path,
 * another one may not take its place.
 *
 * Threads  no state
 * Errors   a record that is not there: STATUS_MISSING with what to say; other content: STATUS_BAD_DATA */
#ifndef IMTET_STUDY_MOVED_H
#define IMTET_STUDY_MOVED_H

#include <stdint.h>
#include "base/status.h"

typedef struct Settings Settings;

typedef struct {
    const char *record;  /* where motion.record is now; NULL: where it was */
    const char *records; /* the same for the list motion.records, all of it */
} Moved;

/* Every record of the run can be read, at its place or as `moved` says, and what was moved holds what the provenance
 * (JSON; NULL: none) says; s then names the new places. Runs on other problems have none. */
Status moved_find(Settings *s, const char *provenance, const Moved *moved, Err *err);

/* Of several records in their order, from the hash of each: FNV-1a, a word at a time. */
uint64_t moved_hash(uint64_t so_far, uint64_t file_hash);

#endif
