#include "store/tables.h"

#include <errno.h>
#include <limits.h>
#include <stdio.h>
#include <stdlib.h>
#include <unistd.h>

#include "settings/settings.h"
#include "store/folder.h"
#include "store/output.h"

/* -- the text of the tables ---------------------------------------------------------------------------------------- */

static const char BEFORE_EVALUATION[] =
    "CREATE TABLE run(id INTEGER PRIMARY KEY CHECK (id = 1), settings TEXT NOT NULL, provenance TEXT NOT NULL,"
    " planned_evals INTEGER NOT NULL, n_var INTEGER NOT NULL, created TEXT NOT NULL,"
    " tried_to_polish INTEGER NOT NULL DEFAULT 0, polished_at INTEGER NOT NULL DEFAULT 0, digest INTEGER NOT NULL);"
    "CREATE TABLE generation(number INTEGER PRIMARY KEY, simulated INTEGER NOT NULL, failed INTEGER NOT NULL,"
    " front INTEGER NOT NULL, surrogate_error REAL, hypervolume REAL,"
    " seconds REAL NOT NULL, finished TEXT NOT NULL, digest INTEGER NOT NULL);"
    "CREATE TABLE front(evaluation INTEGER PRIMARY KEY REFERENCES evaluation(id), entered INTEGER NOT NULL,"
    " left INTEGER);"
    "CREATE TABLE state(generation INTEGER PRIMARY KEY, bytes BLOB NOT NULL, digest INTEGER NOT NULL, front INTEGER);"
    "CREATE TABLE session(number INTEGER PRIMARY KEY, started TEXT NOT NULL, ended TEXT, host TEXT, pid INTEGER,"
    " program TEXT, threads INTEGER, simulated_before INTEGER, seconds REAL, stopped TEXT, is_final INTEGER,"
    " search REAL, waited REAL, surrogate REAL);"
    "CREATE TABLE evaluation(id INTEGER PRIMARY KEY, generation INTEGER NOT NULL, kind TEXT, outcome TEXT NOT NULL,"
    " reason TEXT NOT NULL, seconds REAL, violation REAL, digest INTEGER NOT NULL";
static const char REPLICATES[] = ");CREATE TABLE replicates(evaluation INTEGER PRIMARY KEY"
                                 " REFERENCES evaluation(id) ON DELETE CASCADE";

enum { N_TABLES = 7 };

/* Columns of `evaluation` before the numbers; of `replicates` there is one. */
enum { ID, GENERATION, KIND, OUTCOME, REASON, SECONDS, VIOLATION, DIGEST, N_FIXED };

static size_t n_numbers(const Schema *s)
{
    return s->n_var + s->n_obj + s->n_extra;
}

/* Both tables are read by one query. */
Status tables_have_room(const Schema *s, Err *err)
{
    enum { COLUMNS_MAX = 2000 }; /* SQLITE_MAX_COLUMN as SQLite is built by default */
    const size_t others = N_FIXED + 1 + 2 * s->n_obj + s->n_extra;
    return s->n_var + others <= COLUMNS_MAX ? STATUS_OK
                                            : fail(err, STATUS_BAD_DATA,
                                                   "problem.variables = %zu: a run has room for %zu variables beside "
                                                   "%zu objectives (SQLite: %d columns)",
                                                   s->n_var, COLUMNS_MAX - others, s->n_obj, COLUMNS_MAX);
}

/* Names become identifiers of SQL: in double quotes, which are doubled inside. */
static void put_column(FILE *f, const char *name, const char *end)
{
    fputs(", \"", f);
    for (; *name; name++)
        fputs(*name == '"' ? "\"\"" : (char[]){*name, 0}, f);
    fprintf(f, "%s\" REAL", end);
}

/* To be freed. */
static Status tables_text(const Schema *s, char **text, Err *err)
{
    size_t length;
    *text = NULL;
    FILE *f = open_memstream(text, &length);
    if (!f)
        return fail(err, STATUS_NO_MEMORY, "no memory for the names of the columns");
    fputs(BEFORE_EVALUATION, f);
    for (size_t c = 0; c < n_numbers(s); c++)
        put_column(f, s->column[c].name, "");
    fputs(REPLICATES, f);
    for (size_t k = 0; k < s->n_obj; k++)
        put_column(f, schema_objective(s, k)->name, "_sd");
    fputs(");", f);
    return fclose(f) == 0 ? STATUS_OK : fail(err, STATUS_NO_MEMORY, "no memory for the names of the columns");
}

typedef struct {
    const char *text;
    int n_known;
} Known;

/* SQLite keeps the statements as they were written. */
static Status count_known(sqlite3_stmt *row, void *user, Err *err)
{
    Known *k = user;
    const char *text = column_text(row, 0), *found = strstr(k->text, text);
    (void)err;
    k->n_known += found && strncmp(text, "CREATE", 6) == 0 && found[strlen(text)] == ';';
    return STATUS_OK;
}

Status tables_check(Database *db, const Schema *schema, Err *err)
{
    char *text;
    TRY(tables_text(schema, &text, err));
    Known k = {.text = text};
    const Status status = database_each(db, "SELECT sql FROM sqlite_schema", count_known, &k, err);
    free(text);
    TRY(status);
    return k.n_known == N_TABLES ? STATUS_OK
                                 : database_damaged(db, err, "%d of its %d tables are not those of this run",
                                                    N_TABLES - k.n_known, N_TABLES);
}

/* -- a new database ------------------------------------------------------------------------------------------------ */

static Status settings_text(const Settings *s, char **text, Err *err)
{
    size_t length;
    FILE *f = open_memstream(text, &length);
    if (f)
        settings_write(s, f, SETTINGS_PLAIN);
    return f && fclose(f) == 0 ? STATUS_OK : fail(err, STATUS_NO_MEMORY, "no memory for the settings");
}

static long digest_of_head(const char *settings, const char *provenance, long planned_evals, long n_var)
{
    return (long)digest_whole(n_var,
                              digest_whole(planned_evals, digest_text(provenance, digest_text(settings, HASH_SEED))));
}

int tables_head_is_whole(sqlite3_stmt *row)
{
    return column_whole(row, 6, 0) ==
           digest_of_head(column_text(row, 0), column_text(row, 1), column_whole(row, 2, 0), column_whole(row, 3, 0));
}

static Status fill_new_database(Database *db, const Schema *schema, const char *tables, const Settings *used,
                                const char *provenance, Err *err)
{
    char created[24], *text = NULL;
    utc_now(created);
    TRY(settings_text(used, &text, err));
    Status status = database_do(db, err, "BEGIN", "");
    if (status == STATUS_OK)
        status = database_do(db, err, tables, "");
    if (status == STATUS_OK)
        status = database_do(db, err,
                             "INSERT INTO run(id, settings, provenance, planned_evals, n_var, created, digest) "
                             "VALUES (1, ?, ?, ?, ?, ?, ?)",
                             "ttiiti", text, provenance, used->search.max_evals, (long)schema->n_var, created,
                             digest_of_head(text, provenance, used->search.max_evals, (long)schema->n_var));
    if (status == STATUS_OK)
        status = database_do(db, err, "COMMIT", "");
    free(text);
    return status;
}

Status tables_create(const char *path, const Schema *schema, const Settings *used, const char *provenance, Err *err)
{
    char temporary[PATH_MAX + 8], *tables;
    Database *db = NULL;
    snprintf(temporary, sizeof temporary, "%s.tmp", path);
    unlink(temporary);
    TRY(tables_have_room(schema, err));
    Status status = tables_text(schema, &tables, err);
    if (status == STATUS_OK)
        status = database_create(&db, temporary, err);
    if (status == STATUS_OK)
        status = fill_new_database(db, schema, tables, used, provenance, err);
    database_close(db);
    free(tables);
    TRY(status);
    database_remove_journal(path);
    if (rename(temporary, path) != 0)
        return fail(err, STATUS_IO, "%s: cannot be put in place: %s", path, strerror(errno));
    output_sync_folder(path);
    return STATUS_OK;
}

Status tables_set_settings(Database *db, const Settings *used, const Run *run, Err *err)
{
    char *text = NULL;
    TRY(settings_text(used, &text, err));
    const Status status =
        database_do(db, err, "UPDATE run SET settings = ?, digest = ?", "ti", text,
                    digest_of_head(text, run->provenance, run->planned_evals, (long)run->schema.n_var));
    free(text);
    return status;
}

/* -- rows ---------------------------------------------------------------------------------------------------------- */

static uint64_t digest_numbers(size_t n, const double values[], uint64_t hash)
{
    for (size_t i = 0; i < n; i++)
        hash = digest_number(values[i], hash);
    return hash;
}

/* Of all but kind and generation. */
static uint64_t digest_row(const Schema *s, const Evaluation *e)
{
    uint64_t hash = digest_whole(e->id, HASH_SEED);
    hash = digest_text(e->reason, digest_text(outcome_word(e->outcome), hash));
    hash = digest_number(e->violation, digest_number(e->seconds, hash));
    hash = digest_numbers(s->n_obj, e->f, digest_numbers(s->n_var, e->x, hash));
    return digest_numbers(s->n_obj, e->sd, digest_numbers(s->n_extra, e->extra, hash));
}

/* INSERT with n places. */
static Status prepare_insert(Database *db, const char *table, size_t n, sqlite3_stmt **s, Err *err)
{
    char sql[4200]; /* 2 for each of 2,000 columns */
    int at = snprintf(sql, sizeof sql, "INSERT OR REPLACE INTO %s VALUES (?", table);
    for (size_t i = 1; i < n; i++, at += 2)
        memcpy(sql + at, ",?", 2);
    memcpy(sql + at, ")", 2);
    return database_statement(db, sql, s, err);
}

/* Behind column `at`; NULL is bound for what is not known. */
static int bind_numbers(sqlite3_stmt *s, int at, size_t n, const double values[])
{
    for (size_t i = 0; i < n; i++)
        if (isfinite(values[i]))
            sqlite3_bind_double(s, ++at, values[i]);
        else
            sqlite3_bind_null(s, ++at);
    return at;
}

static Status insert_numbers(Database *db, const Schema *schema, const Evaluation *e, Err *err)
{
    sqlite3_stmt *s;
    TRY(prepare_insert(db, "evaluation", N_FIXED + n_numbers(schema), &s, err));
    sqlite3_bind_int64(s, ID + 1, e->id);
    sqlite3_bind_int64(s, GENERATION + 1, e->generation);
    if (e->kind != KIND_UNFINISHED)
        sqlite3_bind_text(s, KIND + 1, kind_word(e->kind), -1, SQLITE_STATIC);
    else
        sqlite3_bind_null(s, KIND + 1);
    sqlite3_bind_text(s, OUTCOME + 1, outcome_word(e->outcome), -1, SQLITE_STATIC);
    int code = sqlite3_bind_text(s, REASON + 1, e->reason, -1, SQLITE_TRANSIENT);
    bind_numbers(s, SECONDS, 2, (const double[]){e->seconds, e->violation});
    sqlite3_bind_int64(s, DIGEST + 1, (long)(digest_row(schema, e) ^ digest_kind(e->kind, e->generation)));
    int at = bind_numbers(s, N_FIXED, schema->n_var, e->x);
    at = bind_numbers(s, at, schema->n_obj, e->f);
    bind_numbers(s, at, schema->n_extra, e->extra);
    return code == SQLITE_OK ? database_run(db, s, err)
                             : fail(err, STATUS_NO_MEMORY, "%s: out of memory", database_path(db));
}

Status rows_insert(Database *db, const Schema *schema, const Evaluation *e, Err *err)
{
    double none[OBJECTIVES_MAX];
    Evaluation row = *e;
    sqlite3_stmt *s;
    for (size_t k = 0; k < schema->n_obj; k++)
        none[k] = NAN;
    row.reason = e->reason ? e->reason : "";
    row.f = e->outcome == OUTCOME_OK ? e->f : none;
    row.sd = e->sd ? e->sd : none;
    TRY(insert_numbers(db, schema, &row, err));
    size_t k = 0;
    while (k < schema->n_obj && !isfinite(row.sd[k]))
        k++;
    if (k == schema->n_obj)
        return STATUS_OK;
    TRY(prepare_insert(db, "replicates", 1 + schema->n_obj, &s, err));
    sqlite3_bind_int64(s, 1, row.id);
    bind_numbers(s, 1, schema->n_obj, row.sd);
    return database_run(db, s, err);
}

/* The exclusive or that SQL lacks is (a | b) - (a & b). */
Status rows_finish(Database *db, long id, EvaluationKind kind, long generation, Err *err)
{
    const long digest = (long)digest_kind(kind, generation);
    TRY(database_do(db, err,
                    "UPDATE evaluation SET kind = ?, generation = ?, digest = (digest | ?) - (digest & ?) WHERE id = ?",
                    "tiiii", kind_word(kind), generation, digest, digest, id));
    return database_changes(db) == 1
               ? STATUS_OK
               : fail(err, STATUS_INTERNAL, "%s: the search knows of evaluation %ld, which is not stored",
                      database_path(db), id);
}

Status rows_unfinish(Database *db, long generation, Err *err)
{
    for (EvaluationKind kind = 0; kind < KIND_UNFINISHED; kind++) {
        const long digest = (long)digest_kind(kind, generation);
        if (kind != KIND_POLISHED)
            TRY(database_do(db, err,
                            "UPDATE evaluation SET kind = NULL, digest = (digest | ?) - (digest & ?) "
                            "WHERE kind = ? AND generation = ?",
                            "iiti", digest, digest, kind_word(kind), generation));
    }
    return STATUS_OK;
}

typedef struct {
    Database *db;
    const Schema *schema;
    EvaluationTable room; /* of one row */
    EvaluationFn take;
    void *user;
    int has_replicates;
} Reading;

static int take_numbers(sqlite3_stmt *row, int at, size_t n, double values[])
{
    for (size_t i = 0; i < n; i++, at++)
        values[i] = column_number(row, at);
    return at;
}

static Status take_row(sqlite3_stmt *row, void *user, Err *err)
{
    Reading *r = user;
    const Schema *s = r->schema;
    const Evaluation *e = r->room.row;
    Evaluation *to = r->room.row;
    to->id = (long)sqlite3_column_int64(row, ID);
    to->generation = (long)sqlite3_column_int64(row, GENERATION);
    to->kind = kind_of_word(column_text(row, KIND));
    to->seconds = column_number(row, SECONDS);
    to->violation = column_number(row, VIOLATION);
    const Outcome outcome = outcome_of_word(column_text(row, OUTCOME));
    if (outcome == OUTCOME_COUNT)
        return database_damaged(r->db, err, "the outcome of evaluation %ld cannot be read", e->id);
    to->outcome = outcome;
    to->reason = column_text(row, REASON);
    int at = take_numbers(row, N_FIXED, s->n_var, to->x);
    at = take_numbers(row, at, s->n_obj, to->f);
    at = take_numbers(row, at, s->n_extra, to->extra);
    if (r->has_replicates)
        take_numbers(row, at + 1, s->n_obj, to->sd);
    if ((uint64_t)sqlite3_column_int64(row, DIGEST) != (digest_row(s, e) ^ digest_kind(e->kind, e->generation)))
        return database_damaged(r->db, err, "evaluation %ld is not what was written", e->id);
    evaluation_set_outcome(to, outcome, to->reason);
    return r->take(e, r->user, err);
}

Status rows_each(Database *db, const Schema *s, const char *where, EvaluationFn take, void *user, Err *err)
{
    char sql[200];
    double has_replicates;
    Evaluation *row;
    TRY(database_number(db, "SELECT EXISTS (SELECT * FROM replicates)", 0, &has_replicates, err));
    Reading r = {db, s, evaluation_table(s->n_var, s->n_obj, s->n_extra), take, user, has_replicates > 0.0};
    snprintf(sql, sizeof sql, "SELECT * FROM evaluation%s WHERE %s ORDER BY id",
             r.has_replicates ? " LEFT JOIN replicates ON replicates.evaluation = id" : "", where);
    Status status = evaluation_table_add(&r.room, &row, err);
    if (status == STATUS_OK)
        status = evaluation_table_give_room(row, err);
    if (status == STATUS_OK)
        status = database_each(db, sql, take_row, &r, err);
    evaluation_table_free(&r.room);
    return status;
}
