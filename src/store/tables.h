/* store/tables.h -- the tables of a run's database (store/store.h has their columns): how they are made and filled.
 *
 * Threads  as Database */
#ifndef IMTET_STORE_TABLES_H
#define IMTET_STORE_TABLES_H

#include "store/database.h"
#include "simulator/schema.h"

typedef struct Settings Settings;

/* The database of a new run at `path`. Made beside its place and renamed: it is there whole or not at all. */
Status tables_create(const char *path, const Schema *schema, const Settings *used, const char *provenance, Err *err);

/* What is stored of a design. */
typedef struct {
    const double *x, *f;  /* (n_var); (n_obj) natural signs, not read unless the outcome is ok */
    const double *spread; /* (n_obj) standard deviations, NAN or NULL where not known */
    double violation;     /* of the user's limits: 0 where they hold */
    Verdict verdict;
} StoredDesign;

/* One evaluation; kind NULL: its generation is not finished. A row with that id is replaced. */
Status tables_insert(Database *db, const Schema *schema, long id, long generation, const char *kind,
                     const StoredDesign *design, Err *err);
Status tables_set_settings(Database *db, const Settings *used, Err *err);

/* 2026-01-31T23:59:59Z, now */
void utc_now(char text[24]);

/* What is known of an evaluation when it is stored; its generation and kind come later. */
enum { ROW_TEXTS = 6 };
typedef struct {
    long id;
    double seconds, violation;   /* NAN: not known */
    const char *text[ROW_TEXTS]; /* outcome, reason, x, f, spread, extra as stored; NULL: none */
} RowContent;

/* FNV-1a of it: the column `digest`, by which a row is found that the disk has changed. */
long tables_digest(const RowContent *row);

#endif
