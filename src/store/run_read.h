/* store/run_read.h -- a run read from its database, also while it is worked on.
 *
 * Ownership  run_read and run_load allocate, run_free releases
 * Errors     no database there: STATUS_MISSING; damaged: STATUS_IO; the Run is empty then */
#ifndef IMTET_STORE_RUN_READ_H
#define IMTET_STORE_RUN_READ_H

#include <stdio.h>

#include "store/database.h"
#include "store/results.h"
#include "store/rows.h"
#include "store/run.h"

/* The database of a run's folder; 1 where there is one. */
int run_path(const char *folder, char path[], size_t size);

Status run_read(Run *run, const char *folder, Err *err);
Status run_load(Run *run, Database *d, const char *folder, Err *err);

/* What takes half of the time and of the memory may be left out: then the table has neither x nor extra (its n_var and
 * n_extra are 0), and what looks at the variables of a run may not be called. Noisy runs have all of it in any case. */
typedef enum {
    RUN_WHOLE,
    RUN_RESULTS,  /* no x, no extra */
    RUN_REVIEWED, /* ... of a tower all: study/front_review.h */
    RUN_ENDED, /* to be resumed: of a plain search of which nothing is damaged or polished the finished evaluations stay
                     where they are (n_ahead, unchecked, n_front of them on the front without a list); else all of it */
} RunPart;
Status run_read_part(Run *run, const char *folder, RunPart part, Err *err);
Status run_load_part(Run *run, Database *d, const char *folder, RunPart part, Err *err);

/* RUN_REVIEWED of a run some of whose results are known: if no more is wanted of them they are not read. */
Status run_review(Run *run, Database *d, const char *folder, const Results *known, Err *err);

/* A run whose results are read (RUN_RESULTS) and whose numbers pass by, row for row, as they are stored (store/rows.h), all in
 * one state. A null function is not called. */
typedef struct {
    Status (*begin)(const Run *run, void *user, Err *err);
    Status (*row)(const Run *run, size_t row, const RowNumbers *stored, void *user, Err *err);
    Status (*end)(const Run *run, void *user, Err *err);
} RunVisitor;
Status run_visit(const char *folder, const RunVisitor *visitor, void *user, Err *err);

/* All evaluations as lines of evaluations.csv, unfinished ones too, behind a header (export_evaluations_header). No more
 * than a row is kept in memory; where it fails, a part may be written. */
typedef void RunHeader(FILE *f, const Schema *schema);
Status run_print_evaluations(const char *folder, RunHeader *header, FILE *f, Err *err);

/* Check values (store/digest.h) of a generation and of the state of the search at its end. */
long run_generation_digest(const RunGeneration *g);
long run_state_digest(long generation, const void *bytes, size_t n);

#endif
