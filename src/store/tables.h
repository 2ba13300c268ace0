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

Status tables_set_settings(Database *db, const Settings *used, Err *err);

#endif
