/* serve/watch.h -- the runs that are served, each as it is now: read again when its files have changed.
 *
 * It is read, as `imtet status` does, by whoever asks for it where its files have changed since then; nothing is
 * written and no lock kept, so that the run does not know of it. A tenth of a processor at most is spent on reading
 * one; a run that is not asked for again in time is released with the next question, and what was simulated of it with
 * it.
 *
 * Life cycle  watch_open -> watch_take, watch_give ... -> watch_stop -> watch_close
 * Ownership   a Snapshot is shared and read-only; it is released by the last watch_give
 * Threads     any */
#pragma once

#include <stdatomic.h>

#include "serve/on_demand.h"
#include "study/progress.h"

typedef struct Watch Watch;

typedef struct {
    Run run;
    Standing standing;
    OnDemand *on_demand; /* the same for all readings of one run */
    atomic_int n_users;
} Snapshot;

typedef struct {
    Snapshot *snapshot;
    long version; /* 1, 2, ...: of this run, each a change */
    Err why;      /* code: of the last reading; where it failed the snapshot is of an earlier one */
} View;

/* folder: a run, or a folder that holds runs; moved: borrowed. */
Status watch_open(Watch **out, const char *folder, const RecordPaths *moved, Err *err);
void watch_stop(Watch *w); /* watch_next waits no more */
void watch_close(Watch *w);

/* Runs keep their numbers; those of a folder that came since then are found by watch_find. */
void watch_find(Watch *w);
size_t watch_n(Watch *w);
const char *watch_name(Watch *w, size_t i); /* NULL: gone by watch_move */

/* Another name for its folder, NULL: none and it is removed with all that is in it. Not while a process works on it. */
Status watch_move(Watch *w, size_t i, const char *name, Err *err);

/* The run as it is now, kept for so many seconds more. One that could not be read is tried again
 * after AGAIN_S; until then the reason is the answer, or stands beside the snapshot before. */
Status watch_take(Watch *w, size_t i, double seconds, View *view, Err *err);
void watch_give(View *view); /* one without a snapshot is fine */

/* A view later than version `seen`, within so many seconds, for which the run is kept too; else without a snapshot. */
View watch_next(Watch *w, size_t i, long seen, double seconds);
int watch_is_stopped(Watch *w);
