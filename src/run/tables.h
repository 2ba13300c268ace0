/* run/tables.h -- the tables of a run's database (run/store.h has their columns): how they are made and filled.
 *
 * Threads  as Database */
#ifndef IMTET_RUN_TABLES_H
#define IMTET_RUN_TABLES_H

#include "run/database.h"
#include "run/store.h"

/* The database of a new run at `path`. Made beside its place and renamed: it is there whole or not at all. */
Status tables_create(const char *path, const Schema *schema, const Settings *used, const char *provenance, Err *err);

/* One evaluation; kind NULL: its generation is not finished. A row with that id is replaced. */
Status tables_insert(Database *db, const Schema *schema, long id, long generation, const char *kind,
                     const StoredDesign *design, Err *err);
Status tables_set_settings(Database *db, const Settings *used, Err *err);

/* 2026-01-31T23:59:59Z, now */
void utc_now(char text[24]);

#endif
