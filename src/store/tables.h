/* store/tables.h -- the tables of a run's database: how they are made and checked, and the rows of evaluations in them.
 *
 *   run          settings (INI), provenance (JSON), planned_evals, n_var, created, tried_to_polish, polished_at, digest
 *   evaluation   id, generation, kind (NULL: its generation is not finished), outcome, reason, seconds, violation,
 *                digest, and a REAL column, by its name, for every variable, objective and further measure; NULL: not
 *                known
 *   replicates   evaluation, NAME_sd of every objective: standard deviation of a single simulation; where it is known
 *   generation   number, simulated, failed, front, surrogate_error, hypervolume, seconds, finished, digest
 *   front        evaluation, entered, left: it was on the front of the generations entered <= g < left
 *   state        generation, bytes (moga/search.h), digest, front: of the last two generations
 *   session      started, ended, host, pid, program, threads, simulated_before, seconds, stopped, is_final,
 *                search, waited, surrogate
 *
 * Digests  check values by which a bit that the disk has changed is found, of the values as SQLite gives them back: it
 *          keeps no -0, and NULL for what is not finite. Not for adversaries
 * Threads  as Database
 * Errors   a row that cannot be read, or is not what was written: STATUS_IO with its id */
#ifndef IMTET_STORE_TABLES_H
#define IMTET_STORE_TABLES_H

#include <math.h>
#include <string.h>

#include "base/hash.h"
#include "evaluate/evaluation.h"
#include "store/database.h"
#include "store/run.h"

/* Whether SQLite has columns for all of it (2,000 in a table or an answer): STATUS_BAD_DATA with the number of
 * variables that the other columns leave. */
Status tables_have_room(const Schema *schema, Err *err);

/* The database of a new run at `path`. Made beside its place and renamed: it is there whole or not at all. */
Status tables_create(const char *path, const Schema *schema, const Settings *used, const char *provenance, Err *err);

Status tables_set_settings(Database *db, const Settings *used, const Run *run, Err *err);

/* Their text is what this program writes: a bit in it may have changed what a query does. */
Status tables_check(Database *db, const Schema *schema, Err *err);

/* Of "SELECT settings, provenance, planned_evals, n_var, ?, ?, digest FROM run": they are what was written. */
int tables_head_is_whole(sqlite3_stmt *row);

/* -- rows ---------------------------------------------------------------------------------------------------------- */

/* A row with that id is replaced. */
Status rows_insert(Database *db, const Schema *schema, const Evaluation *e, Err *err);

/* A row that had no kind yet gets it, and the generation that it belongs to; those of a generation lose it again. */
Status rows_finish(Database *db, long id, EvaluationKind kind, long generation, Err *err);
Status rows_unfinish(Database *db, long generation, Err *err);

/* Every evaluation for which `where` holds, in the order of the ids. */
Status rows_each(Database *db, const Schema *schema, const char *where, EvaluationFn take, void *user, Err *err);

/* -- digests ------------------------------------------------------------------------------------------------------- */

/* A step for 64 bits: FNV-1a a word at a time, its high bits mixed into the low ones. */
static inline uint64_t digest_whole(long value, uint64_t hash)
{
    hash = (hash ^ (uint64_t)value) * HASH_PRIME;
    return hash ^ hash >> 32;
}

static inline uint64_t digest_number(double value, uint64_t hash)
{
    const double known = isfinite(value) ? value + 0.0 : -1e308;
    long bits;
    memcpy(&bits, &known, sizeof bits);
    return digest_whole(bits, hash);
}

static inline uint64_t digest_text(const char *text, uint64_t hash)
{
    return hash_fnv1a(text, strlen(text) + 1, hash);
}

/* Joined to a row's digest by exclusive or, and so taken out again: both change after it is written. */
static inline uint64_t digest_kind(EvaluationKind kind, long generation)
{
    return kind == KIND_UNFINISHED ? 0 : digest_text(kind_word(kind), digest_whole(generation, HASH_SEED));
}

/* Of a member of a set, joined in any order. */
static inline uint64_t digest_member(long id)
{
    return digest_whole(id, HASH_SEED);
}

#endif
