/* serve/kept.h -- what is kept of every run that a page has asked for: its simulated designs and its what-if.
 *
 * A run that was made anew in the place of another (other settings or provenance) has other designs, bounds and motions: its
 * own is opened, the other one goes with its last user.
 *
 * Life cycle  kept_open -> kept_take, kept_give ... -> kept_close
 * Ownership   a KeptRun is shared; the last kept_give releases one that was replaced
 * Threads     any */
#ifndef IMTET_SERVE_KEPT_H
#define IMTET_SERVE_KEPT_H

#include "serve/detail_cache.h"
#include "serve/what_if.h"

enum { KEPT_MAX = 1024 };

typedef struct Kept Kept;
typedef struct KeptRun KeptRun;

Status kept_open(Kept **out, Err *err);
void kept_close(Kept *k); /* NULL is fine; no KeptRun is used any more */

/* number < KEPT_MAX; run: as it is now. */
Status kept_take(Kept *k, size_t number, const Run *run, KeptRun **out, Err *err);
void kept_give(Kept *k, KeptRun *r); /* NULL is fine */

DetailCache *kept_details(KeptRun *r);

/* Opened when it is first asked for. */
Status kept_what_if(KeptRun *r, const Run *run, const RecordPaths *moved, WhatIf **out, Err *err);

#endif
