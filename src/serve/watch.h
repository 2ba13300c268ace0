/* serve/watch.h -- the runs that are served, each as it is now: read again when its files have changed.
 *
 * One thread reads, as `imtet status` does; it writes nothing and keeps no lock, so that the run does not know of it. It
 * looks every POLL_S for changes of the runs that are asked for and spends a tenth of a processor at most on reading one; a
 * run that is not asked for again in time is released.
 *
 * Life cycle  watch_open -> watch_take, watch_give ... -> watch_stop -> watch_close
 * Ownership   a Look is shared and read-only; it is released by the last watch_give
 * Threads     any */
#ifndef IMTET_SERVE_WATCH_H
#define IMTET_SERVE_WATCH_H

#include "store/run.h"
#include "study/progress.h"

typedef struct Watch Watch;

typedef struct {
    Run run;
    Standing standing;
    long version; /* 1, 2, ...: readings of this run */
    int n_users;  /* the watch's */
} Look;

/* folder: a run, or a folder that holds runs. */
Status watch_open(Watch **out, const char *folder, Err *err);
void watch_stop(Watch *w); /* whoever waits goes on without */
void watch_close(Watch *w);

/* Runs keep their numbers; those of a folder that came since then are found by watch_find. */
void watch_find(Watch *w);
size_t watch_n(Watch *w);
const char *watch_name(Watch *w, size_t i);

/* Waits for the first reading; the run is kept for so many seconds more. One that could not be read is tried again after
 * AGAIN_S; until then the reason is the answer. */
Status watch_take(Watch *w, size_t i, double seconds, Look **look, Err *err);
void watch_give(Watch *w, Look *look); /* NULL is fine */

/* A reading later than version `seen`, within so many seconds, for which the run is kept too; NULL: there is none, or the
 * watch is stopped. */
Look *watch_next(Watch *w, size_t i, long seen, double seconds);
int watch_is_stopped(Watch *w);

#endif
