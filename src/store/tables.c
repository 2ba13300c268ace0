#include "store/tables.h"

#include <errno.h>
#include <limits.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>
#include <unistd.h>

#include "store/logs.h"
#include "store/output.h"
#include "settings/settings.h"

/* -- a new database ------------------------------------------------------------------------------------------------ */

static const char TABLES[] =
    "CREATE TABLE run(id INTEGER PRIMARY KEY CHECK (id = 1), settings TEXT NOT NULL, provenance TEXT NOT NULL,"
    " planned_evals INTEGER NOT NULL, n_var INTEGER NOT NULL, created TEXT NOT NULL,"
    " tried_to_polish INTEGER NOT NULL DEFAULT 0, polished_at INTEGER NOT NULL DEFAULT 0);"
    "CREATE TABLE evaluation(id INTEGER PRIMARY KEY, generation INTEGER NOT NULL, kind TEXT, outcome TEXT NOT NULL,"
    " reason TEXT NOT NULL, seconds REAL, x TEXT NOT NULL, f TEXT, spread TEXT, violation REAL, extra TEXT,"
    " digest INTEGER);"
    "CREATE TABLE generation(number INTEGER PRIMARY KEY, simulated INTEGER NOT NULL, failed INTEGER NOT NULL,"
    " front INTEGER NOT NULL, predicted INTEGER NOT NULL, surrogate_error REAL, hypervolume REAL, seconds REAL NOT "
    "NULL,"
    " finished TEXT NOT NULL);"
    "CREATE TABLE front(evaluation INTEGER PRIMARY KEY REFERENCES evaluation(id), entered INTEGER NOT NULL,"
    " left INTEGER);"
    "CREATE TABLE state(id INTEGER PRIMARY KEY CHECK (id = 1), generation INTEGER NOT NULL, bytes BLOB NOT NULL);"
    "CREATE TABLE session(number INTEGER PRIMARY KEY, started TEXT NOT NULL, ended TEXT, host TEXT, pid INTEGER,"
    " program TEXT, threads INTEGER, simulated_before INTEGER, seconds REAL, stopped TEXT, is_final INTEGER,"
    " search REAL, waited REAL, surrogate REAL);";

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
                             "INSERT INTO run(id, settings, provenance, planned_evals, n_var, created) "
                             "VALUES (1, ?, ?, ?, ?, ?)",
                             "ttiit", text, provenance, used->search.max_evals, (long)schema->n_var, created);
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
    if (rename(temporary, path) != 0)
        return fail(err, STATUS_IO, "%s: cannot be put in place: %s", path, strerror(errno));
    output_sync_folder(path);
    return STATUS_OK;
}

Status tables_set_settings(Database *db, const Settings *used, Err *err)
{
    char *text = NULL;
    TRY(settings_text(used, &text, err));
    const Status status = database_do(db, err, "UPDATE run SET settings = ?", "t", text);
    free(text);
    return status;
}
