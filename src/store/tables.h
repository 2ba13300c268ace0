/* store/tables.h -- the tables of a run's database, each by one description (tables.c) from which it is made, checked,
 * written and read.
 *
 *   run          settings (INI), provenance (JSON), planned_evals, n_var, created, tried_to_polish, polished_at, digest
 *   evaluation   the fields of Evaluation (kind NULL: its generation is not finished), digest, and a REAL column, by
 *                its name, for every variable, objective and further measure; NAME_sd of every objective where
 *                designs are several simulations: standard deviation of a single one. NULL: not known
 *   finer        designs that a study names, by their ids, simulated with more steps: how often these were doubled, and
 *                the columns above without variables; NAME_sd of every objective where every gap is changed by 1 um,
 *                err_NAME of every number: its likely error; reason: `unpredictable`, or empty. Until the search
 *                goes on
 *   generation   the fields of RunGeneration; digest
 *   front        the fields of RunMark: evaluation was on the front of the generations entered <= g < left
 *   session      the fields of RunSession
 *   state        copy, generation, bytes (moga/search.h), digest: of the last generation, twice
 *
 * Digests  check values by which a bit that the disk has changed is found, of the values as SQLite gives them back: it
 *          keeps no -0, and NULL for what is not finite. Not for adversaries
 * Threads  as Database
 * Errors   a row that is not what was written: STATUS_IO with its number */
#pragma once

#include "evaluate/evaluation.h"
#include "store/database.h"
#include "store/run.h"

/* Whether SQLite has columns for all of it (2,000 in a table), of different names: STATUS_BAD_DATA with the number of
 * variables that the other columns leave, or the name. */
Status tables_have_room(const Schema *schema, Err *err);

/* The database of a new run at `path`. Made beside its place and renamed: it is there whole or not at all. */
Status tables_create(const char *path, const Schema *schema, const Settings *used, const char *provenance, Err *err);

/* With the provenance of the run. */
Status tables_set_settings(Database *db, const Settings *used, const Run *run, Err *err);

/* Their columns are those that this program makes, but for numbers of an evaluation that another version of it has or
 * lacks: a bit in the text of a table may have changed what a query does. */
Status tables_check(Database *db, const Schema *schema, Err *err);

/* Whether the row of "SELECT settings, provenance, planned_evals, n_var, ?, ?, digest FROM run" is as written. */
int tables_head_is_whole(sqlite3_stmt *row);

/* Tables of evaluations, whose finer rows have err, of n_obj + n_extra numbers, behind extra; tables of records. */
typedef enum {
    ROWS_EVALUATION,
    ROWS_FINER,
    N_ROW_TABLES,
    TABLE_GENERATION = N_ROW_TABLES,
    TABLE_FRONT,
    TABLE_SESSION,
    N_DESCRIBED
} RunTable;

/* -- records of the run -------------------------------------------------------------------------------------------- */

/* A record, which stays as it is, as a row, in the place of the one with its number. */
Status record_put(Database *db, RunTable table, void *record, Err *err);

/* All of them by their numbers. list: the address of a pointer to the array, NULL before, to be freed. */
Status records_read(Database *db, RunTable table, void *list, size_t *n, Err *err);

/* -- rows of evaluations ------------------------------------------------------------------------------------------- */

/* A number of an evaluation: the offset of its array in the record, and its place there. */
typedef struct {
    size_t array, i; /* array 0: a result that this program does not know */
} NumberPlace;

/* The numbers that a file's table has, in the order of its columns: those that this program knows by their names.
 * Results that the file lacks are NAN in what is read, and are not kept. */
typedef struct {
    RunTable table;
    size_t n;
    NumberPlace *place; /* (n), to be freed */
} RowColumns;

Status tables_columns(Database *db, RunTable table, const Schema *schema, RowColumns *columns, Err *err);

/* A row with that id is replaced. */
Status rows_insert(Database *db, const RowColumns *columns, const Schema *schema, const Evaluation *e, Err *err);

/* A row that had no kind yet gets it, and the generation that it belongs to. */
Status rows_finish(Database *db, long id, EvaluationKind kind, long generation, Err *err);

/* Every evaluation for which `where` holds, in the order of the ids. */
Status rows_each(Database *db, RunTable table, const Schema *schema, const char *where, EvaluationFn take, void *user,
                 Err *err);

/* -- digests ------------------------------------------------------------------------------------------------------- */

/* Digest of a member of a set; digests are joined in any order by exclusive or. */
uint64_t digest_member(long id);
long state_digest(long generation, const void *bytes, size_t n);
