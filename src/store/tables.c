#include "store/tables.h"

#include <errno.h>
#include <limits.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>
#include <unistd.h>

#include "store/digest.h"
#include "store/logs.h"
#include "store/output.h"
#include "store/rows.h"
#include "settings/settings.h"

/* -- a new database ------------------------------------------------------------------------------------------------ */

static const char TABLES[] =
    "CREATE TABLE run(id INTEGER PRIMARY KEY CHECK (id = 1), settings TEXT NOT NULL, provenance TEXT NOT NULL,"
    " planned_evals INTEGER NOT NULL, n_var INTEGER NOT NULL, created TEXT NOT NULL,"
    " tried_to_polish INTEGER NOT NULL DEFAULT 0, polished_at INTEGER NOT NULL DEFAULT 0, digest INTEGER);"
    "CREATE TABLE evaluation(id INTEGER PRIMARY KEY, generation INTEGER NOT NULL, kind TEXT, outcome TEXT NOT NULL,"
    " reason TEXT NOT NULL, seconds REAL, x TEXT NOT NULL, f TEXT, spread TEXT, violation REAL, extra TEXT,"
    " digest INTEGER);"
    "CREATE TABLE generation(number INTEGER PRIMARY KEY, simulated INTEGER NOT NULL, failed INTEGER NOT NULL,"
    " front INTEGER NOT NULL, predicted INTEGER NOT NULL, surrogate_error REAL, hypervolume REAL, seconds REAL NOT "
    "NULL,"
    " finished TEXT NOT NULL, digest INTEGER);"
    "CREATE TABLE front(evaluation INTEGER PRIMARY KEY REFERENCES evaluation(id), entered INTEGER NOT NULL,"
    " left INTEGER);"
    "CREATE TABLE state(generation INTEGER PRIMARY KEY, bytes BLOB NOT NULL, digest INTEGER, front INTEGER);"
    "CREATE TABLE session(number INTEGER PRIMARY KEY, started TEXT NOT NULL, ended TEXT, host TEXT, pid INTEGER,"
    " program TEXT, threads INTEGER, simulated_before INTEGER, seconds REAL, stopped TEXT, is_final INTEGER,"
    " search REAL, waited REAL, surrogate REAL);";

enum { N_TABLES = 6 };

/* The statement that makes a table, without the semicolon. */
static Status table_text(const char *name, char **text, Err *err)
{
    char head[64];
    snprintf(head, sizeof head, "CREATE TABLE %s(", name);
    const char *from = strstr(TABLES, head);
    *text = strndup(from, strcspn(from, ";"));
    return *text ? STATUS_OK : fail(err, STATUS_NO_MEMORY, "no memory for the table %s", name);
}

/* SQLite keeps the statements as they were written. */
static Status count_known(sqlite3_stmt *row, void *n, Err *err)
{
    const char *text = (const char *)sqlite3_column_text(row, 0), *found = text ? strstr(TABLES, text) : NULL;
    (void)err;
    *(int *)n += found && strncmp(text, "CREATE", 6) == 0 && found[strlen(text)] == ';';
    return STATUS_OK;
}

Status tables_check(Database *db, Err *err)
{
    int n = 0;
    if (database_format(db) < DATABASE_FORMAT)
        return STATUS_OK;
    TRY(database_each(db, "SELECT sql FROM sqlite_schema WHERE type = 'table'", count_known, &n, err));
    return n == N_TABLES ? STATUS_OK
                         : fail(err, STATUS_IO, "%s: is damaged: %d of its %d tables are not those of a run",
                                database_path(db), N_TABLES - n, N_TABLES);
}

/* Names become identifiers of SQL: in double quotes, which are doubled inside. */
static void put_name(FILE *f, const char *name)
{
    fputc('"', f);
    for (; *name; name++)
        fputs(*name == '"' ? "\"\"" : (char[]){*name, 0}, f);
    fputc('"', f);
}

enum { VIEW_COLUMNS_MAX = 1000 };

/* The evaluations with a column per variable, objective and measure. */
static Status create_view(Database *db, const Schema *s, Err *err)
{
    const struct {
        const char *list;
        size_t first, n;
    } part[] = {{"x", 0, s->n_var}, {"f", s->n_var, s->n_obj}, {"extra", s->n_var + s->n_obj, s->n_extra}};
    char *sql = NULL;
    size_t length;
    if (s->n_var + s->n_obj + s->n_extra > VIEW_COLUMNS_MAX)
        return STATUS_OK;
    FILE *f = open_memstream(&sql, &length);
    if (!f)
        return fail(err, STATUS_NO_MEMORY, "no memory for the names of the columns");
    fputs("CREATE VIEW designs AS SELECT id, generation, kind, outcome, reason, seconds", f);
    for (size_t p = 0; p < 3; p++)
        for (size_t j = 0; j < part[p].n; j++) {
            fprintf(f, ", json_extract(%s, '$[%zu]') AS ", part[p].list, j);
            put_name(f, s->column[part[p].first + j].name);
        }
    fputs(" FROM evaluation", f);
    const Status status = fclose(f) == 0 ? database_do(db, err, sql, "")
                                         : fail(err, STATUS_NO_MEMORY, "no memory for the names of the columns");
    free(sql);
    return status;
}

static Status settings_text(const Settings *s, char **text, Err *err)
{
    size_t length;
    FILE *f = open_memstream(text, &length);
    if (f)
        settings_write(s, f, 0);
    return f && fclose(f) == 0 ? STATUS_OK : fail(err, STATUS_NO_MEMORY, "no memory for the settings");
}

static long digest_of_head(const char *settings, const char *provenance, long planned_evals, long n_var)
{
    return (long)digest_whole(n_var,
                              digest_whole(planned_evals, digest_text(provenance, digest_text(settings, HASH_SEED))));
}

int tables_head_is_whole(sqlite3_stmt *row)
{
    return column_whole(row, 6, 0) == 0 ||
           column_whole(row, 6, 0) == digest_of_head(column_text(row, 0), column_text(row, 1), column_whole(row, 2, 0),
                                                     column_whole(row, 3, 0));
}

static Status fill_new_database(Database *db, const Schema *schema, const Settings *used, const char *provenance,
                                Err *err)
{
    char created[24], *text = NULL;
    utc_now(created);
    TRY(settings_text(used, &text, err));
    Status status = database_do(db, err, "BEGIN", "");
    if (status == STATUS_OK)
        status = database_do(db, err, TABLES, "");
    if (status == STATUS_OK)
        status = create_view(db, schema, err);
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
    char temporary[PATH_MAX + 8];
    Database *db;
    snprintf(temporary, sizeof temporary, "%s.tmp", path);
    unlink(temporary);
    TRY(database_create(&db, temporary, err));
    const Status status = fill_new_database(db, schema, used, provenance, err);
    database_close(db);
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

/* -- a database of an earlier format ------------------------------------------------------------------------------- */

static Status renew_table(Database *db, const char *name, const char *columns, Err *err)
{
    char *text, sql[200];
    snprintf(sql, sizeof sql, "ALTER TABLE %s RENAME TO old_%s", name, name);
    TRY(database_do(db, err, sql, ""));
    TRY(table_text(name, &text, err));
    const Status status = database_do(db, err, text, "");
    free(text);
    TRY(status);
    snprintf(sql, sizeof sql, "INSERT INTO %s SELECT %s FROM old_%s; DROP TABLE old_%s", name, columns, name, name);
    return database_do(db, err, sql, "");
}

static Status upgrade(Database *db, Err *err)
{
    char sql[64];
    snprintf(sql, sizeof sql, "PRAGMA user_version = %d", DATABASE_FORMAT);
    TRY(renew_table(db, "run", "*, NULL", err));
    TRY(renew_table(db, "generation", "*, NULL", err));
    TRY(renew_table(db, "state", "generation, bytes, NULL, NULL", err));
    return database_do(db, err, sql, "");
}

/* Of a run whose rows had none, or others: those that are read alone are refused beside those that come. */
static Status write_digests(Database *db, const EvaluationTable *t, Err *err)
{
    for (size_t i = 0; i < t->n; i++)
        TRY(rows_insert(db, (RowShape){t->n_var, t->n_obj, t->n_extra}, &t->row[i], err));
    return STATUS_OK;
}

Status tables_upgrade(Database *db, const EvaluationTable *evaluations, Err *err)
{
    double without;
    const int is_old = database_format(db) < DATABASE_FORMAT;
    TRY(database_number(db, "SELECT count(*) FROM evaluation WHERE digest IS NULL", 0, &without, err));
    if (!is_old && without == 0)
        return STATUS_OK;
    TRY(database_do(db, err, "BEGIN IMMEDIATE", ""));
    Status status = is_old ? upgrade(db, err) : STATUS_OK;
    if (status == STATUS_OK)
        status = write_digests(db, evaluations, err);
    if (status == STATUS_OK)
        status = database_do(db, err, "COMMIT", "");
    if (status == STATUS_OK)
        database_set_format(db, DATABASE_FORMAT);
    else
        database_do(db, NULL, "ROLLBACK", "");
    return status;
}
