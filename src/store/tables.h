/* store/tables.h -- the tables of a run's database (store/store.h has their columns): how they are made and filled.
 *
 * Threads  as Database */
#ifndef IMTET_STORE_TABLES_H
#define IMTET_STORE_TABLES_H

#include "store/database.h"
#include "store/run.h"

typedef struct Settings Settings;

/* The database of a new run at `path`. Made beside its place and renamed: it is there whole or not at all. */
Status tables_create(const char *path, const Schema *schema, const Settings *used, const char *provenance, Err *err);

Status tables_set_settings(Database *db, const Settings *used, const Run *run, Err *err);

/* Their text is what this program writes: a bit in it may have changed what a query does. */
Status tables_check(Database *db, Err *err);

/* Of "SELECT settings, provenance, planned_evals, n_var, ?, ?, digest FROM run": they are what was written. */
int tables_head_is_whole(sqlite3_stmt *row);

/* A database of an earlier format, which may be read but not written, becomes one of the present format. All of its
 * evaluations: their digests change. */
Status tables_upgrade(Database *db, const EvaluationTable *evaluations, Err *err);

#endif
