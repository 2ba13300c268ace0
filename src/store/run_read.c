#include "store/run_read.h"

#include <limits.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "settings/settings.h"
#include "store/repeats.h"
#include "store/tables.h"

/* -- rows ---------------------------------------------------------------------------------------------------------- */

typedef struct {
    Run *h;
    Database *d;
    size_t n_max;
} Loading;

static const char *text_at(sqlite3_stmt *row, int column)
{
    const char *text = (const char *)sqlite3_column_text(row, column);
    return text ? text : "";
}

static double number_at(sqlite3_stmt *row, int column)
{
    return sqlite3_column_type(row, column) == SQLITE_NULL ? NAN : sqlite3_column_double(row, column);
}

static Status damaged(const Loading *l, const char *what, long id, Err *err)
{
    return fail(err, STATUS_IO, "%s: is damaged: %s of evaluation %ld cannot be read", database_path(l->d), what, id);
}

/* "[1,2.5,null]"; no text at all: n times NAN. */
static int parse_numbers(const char *text, size_t n, double values[])
{
    const int known = text[0] != 0;
    for (size_t i = 0; i < n; i++)
        values[i] = NAN;
    for (size_t i = 0; i < n && known; i++) {
        char *end;
        if (*text++ != (i == 0 ? '[' : ','))
            return 0;
        if (strncmp(text, "null", 4) == 0) {
            text += 4;
            continue;
        }
        values[i] = strtod(text, &end);
        if (end == text || !isfinite(values[i]))
            return 0;
        text = end;
    }
    return !known || strcmp(text, "]") == 0;
}

static Status widen(Loading *l, Err *err)
{
    Run *h = l->h;
    if (h->n < l->n_max)
        return STATUS_OK;
    const size_t n = l->n_max > 0 ? 2 * l->n_max : 16;
    void *row = realloc(h->row, n * sizeof *h->row);
    h->row = row ? row : h->row;
    void *X = realloc(h->X, n * h->schema.n_var * sizeof *h->X);
    h->X = X ? X : h->X;
    void *F = realloc(h->F, n * h->schema.n_obj * sizeof *h->F);
    h->F = F ? F : h->F;
    void *spread = realloc(h->spread, n * h->schema.n_obj * sizeof *h->spread);
    h->spread = spread ? spread : h->spread;
    void *answer = realloc(h->answer, n * h->schema.n_obj * sizeof *h->answer);
    h->answer = answer ? answer : h->answer;
    if (!row || !X || !F || !spread || !answer)
        return fail(err, STATUS_NO_MEMORY, "%s: no memory for %zu evaluations", database_path(l->d), n);
    l->n_max = n;
    return STATUS_OK;
}

static const char EVALUATIONS[] =
    "SELECT e.id, e.generation, e.kind, e.outcome, e.reason, e.seconds, e.x, e.f, e.spread, e.violation, e.extra, "
    "f.entered, f.left, e.digest FROM evaluation e LEFT JOIN front f ON f.evaluation = e.id "
    "WHERE e.id BETWEEN %ld AND %ld ORDER BY e.id";

/* What was read is what was written. A row without a digest was put there by somebody else. */
static Status check_digest(const Loading *l, sqlite3_stmt *row, const RunRow *r, Err *err)
{
    const RowContent content = {.id = r->id,
                                .seconds = r->verdict.seconds,
                                .violation = r->violation,
                                .text = {text_at(row, 3), text_at(row, 4), text_at(row, 6), text_at(row, 7),
                                         text_at(row, 8), text_at(row, 10)}};
    if (sqlite3_column_type(row, 13) == SQLITE_NULL || sqlite3_column_int64(row, 13) == tables_digest(&content))
        return STATUS_OK;
    return fail(err, STATUS_IO, "%s: is damaged: evaluation %ld is not what was written", database_path(l->d), r->id);
}

static Status take_evaluation(sqlite3_stmt *row, void *user, Err *err)
{
    Loading *l = user;
    Run *h = l->h;
    TRY(widen(l, err));
    RunRow *r = &h->row[h->n];
    const Schema *schema = &h->schema;
    *r = (RunRow){.id = (long)sqlite3_column_int64(row, 0),
                  .generation = (long)sqlite3_column_int64(row, 1),
                  .kind = kind_of_word(text_at(row, 2)),
                  .violation = number_at(row, 9),
                  .entered = sqlite3_column_type(row, 11) == SQLITE_NULL ? NEVER : sqlite3_column_int(row, 11),
                  .left = sqlite3_column_type(row, 12) == SQLITE_NULL ? NEVER : sqlite3_column_int(row, 12)};
    verdict_set(&r->verdict, text_at(row, 3), text_at(row, 4));
    r->verdict.seconds = number_at(row, 5);
    if (!text_at(row, 6)[0] || !parse_numbers(text_at(row, 6), schema->n_var, h->X + h->n * schema->n_var))
        return damaged(l, "x", r->id, err);
    double *f = h->F + h->n * schema->n_obj;
    if (!parse_numbers(text_at(row, 7), schema->n_obj, f))
        return damaged(l, "f", r->id, err);
    if (!parse_numbers(text_at(row, 8), schema->n_obj, h->spread + h->n * schema->n_obj))
        return damaged(l, "spread", r->id, err);
    if (schema->n_extra > 0 && !parse_numbers(text_at(row, 10), schema->n_extra, r->verdict.extra))
        return damaged(l, "extra", r->id, err);
    TRY(check_digest(l, row, r, err));
    memcpy(h->answer + h->n * schema->n_obj, f, schema->n_obj * sizeof *f);
    h->n_repeats += r->kind == KIND_REPEAT;
    r->ok = strcmp(r->verdict.outcome, "ok") == 0;
    for (size_t k = 0; k < schema->n_obj; k++)
        r->ok = r->ok && isfinite(f[k]);
    r->on_front = r->ok && r->entered != NEVER && r->left == NEVER;
    h->n_failed += !r->ok;
    h->n++;
    return STATUS_OK;
}

Status run_load_rows(Run *h, Database *d, long first, long last, Err *err)
{
    char sql[sizeof EVALUATIONS + 48];
    Loading l = {h, d, 0};
    snprintf(sql, sizeof sql, EVALUATIONS, first, last);
    return database_each(d, sql, take_evaluation, &l, err);
}

/* -- the rest ------------------------------------------------------------------------------------------------------ */

static void *one_more(void *list, size_t n, size_t size)
{
    return n & (n - 1) ? list : realloc(list, (n ? 2 * n : 1) * size); /* at powers of two */
}

static Status take_generation(sqlite3_stmt *row, void *user, Err *err)
{
    Run *h = ((Loading *)user)->h;
    RunGeneration *wider = one_more(h->generation, h->n_generations, sizeof *wider);
    if (!wider)
        return fail(err, STATUS_NO_MEMORY, "no memory for %zu generations", h->n_generations);
    h->generation = wider;
    RunGeneration *g = &wider[h->n_generations++];
    *g = (RunGeneration){.number = (long)sqlite3_column_int64(row, 0),
                         .simulated = (long)sqlite3_column_int64(row, 1),
                         .failed = (long)sqlite3_column_int64(row, 2),
                         .front = (long)sqlite3_column_int64(row, 3),
                         .predicted = (long)sqlite3_column_int64(row, 4),
                         .surrogate_error = number_at(row, 5),
                         .hypervolume = number_at(row, 6),
                         .seconds = number_at(row, 7)};
    snprintf(g->finished, sizeof g->finished, "%s", text_at(row, 8));
    return STATUS_OK;
}

static Status take_session(sqlite3_stmt *row, void *user, Err *err)
{
    Run *h = ((Loading *)user)->h;
    RunSession *wider = one_more(h->session, h->n_sessions, sizeof *wider);
    if (!wider)
        return fail(err, STATUS_NO_MEMORY, "no memory for %zu sessions", h->n_sessions);
    h->session = wider;
    RunSession *s = &wider[h->n_sessions++];
    *s = (RunSession){.pid = (long)sqlite3_column_int64(row, 3),
                      .threads = (long)sqlite3_column_int64(row, 4),
                      .simulated_before = (long)sqlite3_column_int64(row, 5),
                      .seconds = number_at(row, 6),
                      .is_final = sqlite3_column_int(row, 8),
                      .search_s = number_at(row, 9),
                      .waited_s = number_at(row, 10),
                      .surrogate_s = number_at(row, 11)};
    snprintf(s->started, sizeof s->started, "%s", text_at(row, 0));
    snprintf(s->ended, sizeof s->ended, "%s", text_at(row, 1));
    snprintf(s->host, sizeof s->host, "%s", text_at(row, 2));
    snprintf(s->stopped, sizeof s->stopped, "%s", text_at(row, 7));
    return STATUS_OK;
}

static Status take_state(sqlite3_stmt *row, void *user, Err *err)
{
    Run *h = ((Loading *)user)->h;
    h->n_state = (size_t)sqlite3_column_bytes(row, 0);
    h->state = malloc(h->n_state + 1);
    if (!h->state)
        return fail(err, STATUS_NO_MEMORY, "no memory for a state of %zu bytes", h->n_state);
    if (h->n_state > 0)
        memcpy(h->state, sqlite3_column_blob(row, 0), h->n_state);
    return STATUS_OK;
}

static Status take_head(sqlite3_stmt *row, void *user, Err *err)
{
    const Loading *l = user;
    Run *h = l->h;
    h->settings = calloc(1, sizeof *h->settings);
    if (!h->settings)
        return fail(err, STATUS_NO_MEMORY, "%s: no memory for its settings", database_path(l->d));
    settings_defaults(h->settings);
    TRY(settings_parse(h->settings, database_path(l->d), text_at(row, 0), err));
    h->provenance = strdup(text_at(row, 1));
    if (!h->provenance)
        return fail(err, STATUS_NO_MEMORY, "%s: no memory for its provenance", database_path(l->d));
    h->planned_evals = (long)sqlite3_column_int64(row, 2);
    const long n_var = (long)sqlite3_column_int64(row, 3);
    h->tried_to_polish = (long)sqlite3_column_int64(row, 4);
    h->polished_at = (long)sqlite3_column_int64(row, 5);
    const int is_tower = h->settings->problem.kind == PROBLEM_TOWER;
    if (n_var < (is_tower ? 3 : 1) || n_var > 10000 || (!is_tower && n_var != h->settings->problem.variables))
        return fail(err, STATUS_IO, "%s: is damaged: it tells of %ld variables", database_path(l->d), n_var);
    return schema_of(&h->schema, h->settings, (int)n_var - 2, err);
}

static void count_members(Run *h)
{
    for (size_t i = 0; i < h->n; i++)
        if (h->row[i].kind != KIND_REPEAT && h->row[i].kind != KIND_POLISHED)
            h->row[i].members = h->settings->sim.ensemble;
}

static Status load(Loading *l, Err *err)
{
    Run *h = l->h;
    Database *d = l->d;
    TRY(database_each(
        d, "SELECT settings, provenance, planned_evals, n_var, tried_to_polish, polished_at FROM run LIMIT 1",
        take_head, l, err));
    if (!h->schema.column)
        return fail(err, STATUS_IO, "%s: is damaged: it has no settings", database_path(d));
    TRY(run_load_rows(h, d, 0, LONG_MAX, err));
    count_members(h);
    TRY(repeats_join(h, err));
    TRY(run_settle_front(h, err));
    TRY(database_each(d,
                      "SELECT number, simulated, failed, front, predicted, surrogate_error, hypervolume, seconds, "
                      "finished FROM generation ORDER BY number",
                      take_generation, l, err));
    TRY(database_each(
        d,
        "SELECT started, ended, host, pid, threads, simulated_before, seconds, stopped, is_final, search, "
        "waited, surrogate FROM session ORDER BY number",
        take_session, l, err));
    return database_each(d, "SELECT bytes FROM state LIMIT 1", take_state, l, err);
}

Status run_load(Run *h, Database *d, const char *folder, Err *err)
{
    Loading l = {h, d, 0};
    memset(h, 0, sizeof *h);
    snprintf(h->folder, sizeof h->folder, "%s", folder);
    TRY(database_do(d, err, "BEGIN", "")); /* one moment of a run that goes on */
    Status status = load(&l, err);
    const Status end = database_do(d, status == STATUS_OK ? err : NULL, "COMMIT", "");
    status = status == STATUS_OK ? end : status;
    if (status != STATUS_OK)
        run_free(h);
    return status;
}

int run_path(const char *folder, char path[], size_t size)
{
    return snprintf(path, size, "%s/run.sqlite", folder) < (int)size && access(path, F_OK) == 0;
}

Status run_read(Run *h, const char *folder, Err *err)
{
    char path[PATH_MAX];
    Database *d;
    memset(h, 0, sizeof *h);
    if (!run_path(folder, path, sizeof path))
        return fail(err, STATUS_MISSING, "%.200s: holds no run: run.sqlite is not there", folder);
    TRY(database_open(&d, path, DATABASE_READ, err));
    const Status status = run_load(h, d, folder, err);
    database_close(d);
    return status;
}
