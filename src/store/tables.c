#include "store/tables.h"

#include <errno.h>
#include <limits.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>
#include <unistd.h>

#include "base/hash.h"
#include "store/output.h"
#include "settings/settings.h"

void utc_now(char text[24])
{
    struct tm parts;
    const time_t now = time(NULL);
    gmtime_r(&now, &parts);
    strftime(text, 24, "%FT%TZ", &parts);
}

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

/* -- rows ---------------------------------------------------------------------------------------------------------- */

/* "[1,2.5,null]" into *text, which the caller frees; NULL where no number is finite. */
static Status numbers_text(size_t n, const double values[], char **text, Err *err)
{
    size_t length, known = 0;
    *text = NULL;
    for (size_t i = 0; values && i < n; i++)
        known += isfinite(values[i]) != 0;
    if (known == 0)
        return STATUS_OK;
    FILE *f = open_memstream(text, &length);
    for (size_t i = 0; f && i < n; i++) {
        fputc(i == 0 ? '[' : ',', f);
        if (isfinite(values[i]))
            print_number(f, values[i]);
        else
            fputs("null", f);
    }
    if (f)
        fputc(']', f);
    return f && fclose(f) == 0 ? STATUS_OK : fail(err, STATUS_NO_MEMORY, "no memory for %zu numbers", n);
}

long tables_digest(const RowContent *row)
{
    const double numbers[] = {row->seconds, row->violation};
    uint64_t hash = hash_fnv1a(&row->id, sizeof row->id, HASH_SEED);
    for (size_t i = 0; i < sizeof numbers / sizeof numbers[0]; i++) {
        const double known = isfinite(numbers[i]) ? numbers[i] + 0.0 : -1e308; /* SQLite keeps no -0 */
        hash = hash_fnv1a(&known, sizeof known, hash);
    }
    for (size_t i = 0; i < ROW_TEXTS; i++) {
        const char *text = row->text[i] ? row->text[i] : "";
        hash = hash_fnv1a(text, strlen(text) + 1, hash);
    }
    return (long)hash;
}

Status tables_insert(Database *db, const Schema *schema, long id, long generation, const char *kind,
                     const StoredDesign *d, Err *err)
{
    const int ok = strcmp(d->verdict.outcome, "ok") == 0;
    char *x = NULL, *f = NULL, *spread = NULL, *extra = NULL;
    Status status = numbers_text(schema->n_var, d->x, &x, err);
    if (status == STATUS_OK && ok)
        status = numbers_text(schema->n_obj, d->f, &f, err);
    if (status == STATUS_OK)
        status = numbers_text(schema->n_obj, d->spread, &spread, err);
    if (status == STATUS_OK)
        status = numbers_text(schema->n_extra, d->verdict.extra, &extra, err);
    const RowContent row = {
        id, d->verdict.seconds, d->violation, {d->verdict.outcome, d->verdict.reason, x, f, spread, extra}};
    if (status == STATUS_OK)
        status = database_do(db, err,
                             "INSERT OR REPLACE INTO evaluation(id, generation, kind, outcome, reason, seconds, x, f, "
                             "spread, violation, extra, digest) VALUES (?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?)",
                             "iitttdtttdti", id, generation, kind, d->verdict.outcome, d->verdict.reason,
                             d->verdict.seconds, x, f, spread, d->violation, extra, tables_digest(&row));
    free(x);
    free(f);
    free(spread);
    free(extra);
    return status;
}
