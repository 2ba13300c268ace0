#include "store/run_read.h"

#include <jansson.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "base/stat.h"
#include "settings/settings.h"
#include "evaluate/measures.h"
#include "store/folder.h"
#include "store/repeats.h"
#include "store/rows.h"
#include "store/tables.h"
#include "store/digest.h"

typedef struct {
    Run *run;
    Database *d;
    RunPart part;
    const Results *known; /* NULL: none */
    FILE *out;            /* of the evaluations, where they are printed, with their header */
    RunHeader *header;
    const RunVisitor *visitor;
    void *user;               /* of the visitor */
    size_t row;               /* at or before the next design of the front */
    const char *digest;       /* the column of that name; NULL in a database of an earlier format */
    uint64_t front;           /* digest of the designs on the search's front */
    uint64_t front_as_stored; /* ... with the newest state */
    int has_front_as_stored;
    int has_generation_digest; /* from here on; a run that was made with an earlier format has none before */
    int has_state_digest;      /* the state that is taken: with it its generation was written */
} Loading;

/* -- evaluations --------------------------------------------------------------------------------------------------- */

static long id_of(const Run *run, size_t row)
{
    return row < run->n_ahead ? (long)row + 1 : run->table.row[row - run->n_ahead].id;
}

/* In the order of the ids, as the evaluations. */
static Status take_front(sqlite3_stmt *row, void *user, Err *err)
{
    Loading *l = user;
    Run *run = l->run;
    const long id = (long)sqlite3_column_int64(row, 0);
    const size_t n = run->n_ahead + run->table.n;
    (void)err;
    while (l->row < n && id_of(run, l->row) < id)
        l->row++;
    if (column_whole(row, 2, NEVER) == NEVER)
        l->front ^= digest_member(id);
    if (l->row < n && id_of(run, l->row) == id) {
        run->place[l->row].entered = (int)column_whole(row, 1, NEVER);
        run->place[l->row].left = (int)column_whole(row, 2, NEVER);
    }
    return STATUS_OK;
}

static int is_ok(const Run *run, const Evaluation *e)
{
    return e->outcome == OUTCOME_OK && all_finite(run->schema.n_obj, e->f);
}

static void place_all(Run *run)
{
    for (size_t i = 0; i < run->table.n; i++) {
        Evaluation *e = &run->table.row[i];
        RunPlace *place = &run->place[i];
        place->ok = is_ok(run, e);
        place->on_front = place->ok && place->entered != NEVER && place->left == NEVER;
        run->n_failed += !place->ok;
        run->n_repeats += e->kind == KIND_REPEAT;
        if (e->kind != KIND_REPEAT && e->kind != KIND_POLISHED)
            e->replicates = e->kind == KIND_SCREENED ? 1 : (int)run->settings->sim.replicates;
    }
}

static Status make_places(Loading *l, Err *err)
{
    Run *run = l->run;
    const size_t n = run->n_ahead + run->table.n;
    run->place = calloc(n + 1, sizeof *run->place);
    if (!run->place)
        return fail(err, STATUS_NO_MEMORY, "%s: no memory for %zu evaluations", database_path(l->d), n);
    for (size_t i = 0; i < n; i++)
        run->place[i] = (RunPlace){.entered = NEVER, .left = NEVER};
    return database_each(l->d, "SELECT evaluation, entered, left FROM front ORDER BY evaluation", take_front, l, err);
}

/* The table has what is behind the finished generations; what is on the front is there, and usable. */
static Status load_end(Loading *l, Err *err)
{
    Run *run = l->run;
    const Schema *s = &run->schema;
    run->n_ahead = (size_t)run->generation[run->n_generations - 1].simulated;
    run->table = evaluation_table(s->n_var, s->n_obj, s->n_extra);
    TRY(rows_read(l->d, &run->table, (long)run->n_ahead + 1, LONG_MAX, err));
    TRY(make_places(l, err));
    for (size_t i = 0; i < run->n_ahead; i++) {
        run->place[i].on_front = run->place[i].entered != NEVER && run->place[i].left == NEVER;
        run->n_front += run->place[i].on_front != 0;
    }
    for (size_t i = 0; i < run->table.n; i++)
        run->place[run->n_ahead + i].ok = is_ok(run, &run->table.row[i]);
    return STATUS_OK;
}

/* The evaluations of finished generations have the ids 1, 2, ... without a gap: the first one that is not there. */
static Status tell_missing(const Loading *l, Err *err)
{
    double id;
    TRY(database_number(l->d,
                        "SELECT 1 + coalesce(max(id), 0) FROM (SELECT id, row_number() OVER (ORDER BY id) AS place "
                        "FROM evaluation) WHERE id = place",
                        0, &id, err));
    return fail(err, STATUS_IO, "%s: is damaged: evaluation %.0f is missing", database_path(l->d), id);
}

static Status load_evaluations(Loading *l, Err *err)
{
    Run *run = l->run;
    const Schema *s = &run->schema;
    /* repeats are found by their x, what a tower's front is said about needs it */
    const int has_all =
        l->part == RUN_WHOLE || l->part == RUN_ENDED || s->is_noisy || (l->part == RUN_REVIEWED && s->order.n_obj > 0);
    run->table = evaluation_table(has_all ? s->n_var : 0, s->n_obj, has_all ? s->n_extra : 0);
    if (!has_all && l->known)
        TRY(results_table(l->known, &run->table, err));
    TRY(rows_read(l->d, &run->table, run->table.n > 0 ? (long)run->table.n + 1 : 0, LONG_MAX, err));
    const size_t n = run->n_generations > 0 ? (size_t)run->generation[run->n_generations - 1].simulated : 0;
    if (n > 0 && (run->table.n < n || run->table.row[n - 1].id != (long)n))
        return tell_missing(l, err);
    run->F = s->is_noisy ? calloc(run->table.n * s->n_obj + 1, sizeof *run->F) : run->table.f;
    if (run->table.n > 0 && !run->F)
        return fail(err, STATUS_NO_MEMORY, "%s: no memory for %zu evaluations", database_path(l->d), run->table.n);
    if (run->table.n > 0 && run->F != run->table.f)
        memcpy(run->F, run->table.f, run->table.n * s->n_obj * sizeof *run->F);
    TRY(make_places(l, err));
    place_all(run);
    TRY(repeats_join(run, err));
    return run_settle_front(run, err);
}

long run_generation_digest(const RunGeneration *g)
{
    const long whole[] = {g->number, g->simulated, g->failed, g->front, g->predicted};
    const double numbers[] = {g->surrogate_error, g->hypervolume, g->seconds};
    uint64_t hash = HASH_SEED;
    for (size_t i = 0; i < sizeof whole / sizeof whole[0]; i++)
        hash = digest_whole(whole[i], hash);
    for (size_t i = 0; i < sizeof numbers / sizeof numbers[0]; i++)
        hash = digest_number(numbers[i], hash);
    return (long)digest_text(g->finished, hash);
}

long run_state_digest(long generation, const void *bytes, size_t n)
{
    return (long)hash_fnv1a(bytes, n, digest_whole(generation, HASH_SEED));
}

/* -- the rest ------------------------------------------------------------------------------------------------------ */

static void *one_more(void *list, size_t n, size_t size)
{
    return n & (n - 1) ? list : realloc(list, (n ? 2 * n : 1) * size); /* at powers of two */
}

static Status take_generation(sqlite3_stmt *row, void *user, Err *err)
{
    Loading *l = user;
    Run *run = l->run;
    RunGeneration *wider = one_more(run->generation, run->n_generations, sizeof *wider);
    if (!wider)
        return fail(err, STATUS_NO_MEMORY, "no memory for %zu generations", run->n_generations);
    run->generation = wider;
    RunGeneration *g = &wider[run->n_generations++];
    *g = (RunGeneration){.number = (long)sqlite3_column_int64(row, 0),
                         .simulated = (long)sqlite3_column_int64(row, 1),
                         .failed = (long)sqlite3_column_int64(row, 2),
                         .front = (long)sqlite3_column_int64(row, 3),
                         .predicted = (long)sqlite3_column_int64(row, 4),
                         .surrogate_error = column_number(row, 5),
                         .hypervolume = column_number(row, 6),
                         .seconds = column_number(row, 7)};
    snprintf(g->finished, sizeof g->finished, "%s", column_text(row, 8));
    l->has_generation_digest |= sqlite3_column_type(row, 9) != SQLITE_NULL;
    if (l->has_generation_digest && (long)sqlite3_column_int64(row, 9) != run_generation_digest(g))
        return fail(err, STATUS_IO, "%s: is damaged: generation %ld is not what was written", database_path(l->d),
                    g->number);
    return STATUS_OK;
}

static Status take_session(sqlite3_stmt *row, void *user, Err *err)
{
    Run *run = ((Loading *)user)->run;
    RunSession *wider = one_more(run->session, run->n_sessions, sizeof *wider);
    if (!wider)
        return fail(err, STATUS_NO_MEMORY, "no memory for %zu sessions", run->n_sessions);
    run->session = wider;
    RunSession *s = &wider[run->n_sessions++];
    *s = (RunSession){.pid = (long)sqlite3_column_int64(row, 3),
                      .threads = (long)sqlite3_column_int64(row, 4),
                      .simulated_before = (long)sqlite3_column_int64(row, 5),
                      .seconds = column_number(row, 6),
                      .is_final = sqlite3_column_int(row, 8),
                      .search_s = column_number(row, 9),
                      .waited_s = column_number(row, 10),
                      .surrogate_s = column_number(row, 11)};
    snprintf(s->started, sizeof s->started, "%s", column_text(row, 0));
    snprintf(s->ended, sizeof s->ended, "%s", column_text(row, 1));
    snprintf(s->host, sizeof s->host, "%s", column_text(row, 2));
    snprintf(s->stopped, sizeof s->stopped, "%s", column_text(row, 7));
    return STATUS_OK;
}

/* The newest first; one that is not what was written gives way to the one before. Of an earlier format, it has neither
 * digest nor front. */
static Status take_state(sqlite3_stmt *row, void *user, Err *err)
{
    Loading *l = user;
    Run *run = l->run;
    const long generation = (long)sqlite3_column_int64(row, 0);
    const size_t n = (size_t)sqlite3_column_bytes(row, 1);
    const void *bytes = sqlite3_column_blob(row, 1);
    const int is_whole = sqlite3_column_type(row, 2) == SQLITE_NULL
                             ? sqlite3_column_type(row, 3) == SQLITE_NULL
                             : (long)sqlite3_column_int64(row, 2) == run_state_digest(generation, bytes, n);
    if (!run->state && sqlite3_column_type(row, 3) != SQLITE_NULL) {
        l->has_front_as_stored = 1;
        l->front_as_stored = (uint64_t)sqlite3_column_int64(row, 3);
    }
    if (run->state && (!run->state_is_damaged || !is_whole))
        return STATUS_OK;
    free(run->state);
    run->state_generation = generation;
    run->state_is_damaged = !is_whole;
    l->has_state_digest = is_whole && sqlite3_column_type(row, 2) != SQLITE_NULL;
    run->n_state = n;
    run->state = malloc(n + 1);
    if (!run->state)
        return fail(err, STATUS_NO_MEMORY, "no memory for a state of %zu bytes", n);
    if (n > 0)
        memcpy(run->state, bytes, n);
    return STATUS_OK;
}

/* Of the building of a tower: by the variables that are one per floor, else as the provenance says. */
static int floors_of(const Run *run, int n_var)
{
    int n = design_space_floors(&run->settings->design, run->settings->core.section, n_var);
    if (n > 0)
        return n;
    json_t *all = json_loads(run->provenance, 0, NULL);
    n = (int)json_integer_value(json_object_get(json_object_get(all, "inputs"), "floors"));
    json_decref(all);
    return n > 0 && n <= FLOORS_MAX ? n : 0;
}

static Status take_head(sqlite3_stmt *row, void *user, Err *err)
{
    const Loading *l = user;
    Run *run = l->run;
    run->settings = calloc(1, sizeof *run->settings);
    if (!run->settings)
        return fail(err, STATUS_NO_MEMORY, "%s: no memory for its settings", database_path(l->d));
    settings_defaults(run->settings);
    run->settings->core.theory = CORE_EULER_BERNOULLI; /* of runs from before the setting: their only theory */
    run->settings->search.objectives[0] = 0;
    TRY(settings_parse(run->settings, database_path(l->d), column_text(row, 0), err));
    run->provenance = strdup(column_text(row, 1));
    if (!run->provenance)
        return fail(err, STATUS_NO_MEMORY, "%s: no memory for its provenance", database_path(l->d));
    run->planned_evals = (long)sqlite3_column_int64(row, 2);
    const long n_var = (long)sqlite3_column_int64(row, 3);
    run->tried_to_polish = (long)sqlite3_column_int64(row, 4);
    run->polished_at = (long)sqlite3_column_int64(row, 5);
    const int is_tower = run->settings->problem.kind == PROBLEM_TOWER;
    if (n_var < (is_tower ? 3 : 1) || n_var > 10000 || (!is_tower && n_var != run->settings->problem.variables))
        return fail(err, STATUS_IO, "%s: is damaged: it has %ld variables", database_path(l->d), n_var);
    if (!tables_head_is_whole(row))
        return fail(err, STATUS_IO, "%s: is damaged: its settings are not what was written", database_path(l->d));
    const int n_floors = is_tower ? floors_of(run, (int)n_var) : 0;
    if (!run->settings->search.objectives[0]) /* from before the setting: the paper's seven */
        snprintf(run->settings->search.objectives, OPTION_TEXT_MAX, "%s",
                 measure_exists(MEASURE_ED5_10, n_floors) ? "auto" : "paper");
    TRY(schema_of(&run->schema, run->settings, n_floors, err));
    return run->schema.n_var == (size_t)n_var
               ? STATUS_OK
               : fail(err, STATUS_IO, "%s: is damaged: it has %ld variables", database_path(l->d), n_var);
}

/* The columns, with the digest where the format has one, from the rest of the query. */
static Status each(Loading *l, const char *columns, const char *from, DatabaseRowFn take, Err *err)
{
    char sql[320];
    snprintf(sql, sizeof sql, "SELECT %s, %s FROM %s", columns, l->digest, from);
    return database_each(l->d, sql, take, l, err);
}

static Status load_states(Loading *l, Err *err)
{
    const char *query = database_format(l->d) < 3
                            ? "SELECT generation, bytes, NULL, NULL FROM state LIMIT 1"
                            : "SELECT generation, bytes, digest, front FROM state ORDER BY generation DESC LIMIT 2";
    TRY(database_each(l->d, query, take_state, l, err));
    if (l->has_state_digest && !l->has_generation_digest)
        return fail(err, STATUS_IO,
                    "%s: is damaged: its generations have no digest, as if they were not what was written",
                    database_path(l->d));
    return !l->has_front_as_stored || l->front == l->front_as_stored
               ? STATUS_OK
               : fail(err, STATUS_IO, "%s: is damaged: its front is not what was written", database_path(l->d));
}

/* Settings, schema and provenance. */
static Status load_head(Loading *l, Err *err)
{
    TRY(tables_check(l->d, err));
    TRY(each(l, "settings, provenance, planned_evals, n_var, tried_to_polish, polished_at", "run LIMIT 1", take_head,
             err));
    return l->run->schema.column ? STATUS_OK
                                 : fail(err, STATUS_IO, "%s: is damaged: it has no settings", database_path(l->d));
}

/* What the end of a plain search is resumed from is all there. */
static int is_plain_end(const Run *run)
{
    return run->state && !run->state_is_damaged &&
           run->state_generation == run->generation[run->n_generations - 1].number && !run_has_polished(run) &&
           (run->table.n == 0 || run->table.row[0].kind == KIND_UNFINISHED);
}

static int counts(const Loading *l, long n, const char *where, long id)
{
    char sql[120];
    double count;
    snprintf(sql, sizeof sql, "SELECT count(*) FROM evaluation WHERE %s %ld", where, id);
    return database_number(l->d, sql, -1, &count, &(Err){0}) == STATUS_OK && count == (double)n;
}

/* None is missing, and none without a digest beside others, which is refused where rows are read together: here they are
 * not. */
static int can_be_left(const Loading *l, long n)
{
    return counts(l, n, "id <=", n) && counts(l, 0, "digest IS NULL AND id = 1 OR digest IS NULL AND id >", n);
}

static int may_stay(const Loading *l)
{
    const Run *run = l->run;
    return l->part == RUN_ENDED && database_format(l->d) == DATABASE_FORMAT && run->n_generations > 0 &&
           run->generation[run->n_generations - 1].simulated > 0 && !run->schema.is_noisy && !run->schema.has_spread &&
           run->schema.n_limited == 0 && run->settings->search.asynchronous == SWITCH_OFF &&
           can_be_left(l, run->generation[run->n_generations - 1].simulated);
}

static Status load(Loading *l, Err *err)
{
    Database *d = l->d;
    TRY(load_head(l, err));
    TRY(each(l, "number, simulated, failed, front, predicted, surrogate_error, hypervolume, seconds, finished",
             "generation ORDER BY number", take_generation, err));
    TRY(may_stay(l) ? load_end(l, err) : load_evaluations(l, err));
    TRY(database_each(
        d,
        "SELECT started, ended, host, pid, threads, simulated_before, seconds, stopped, is_final, search, "
        "waited, surrogate FROM session ORDER BY number",
        take_session, l, err));
    return load_states(l, err);
}

/* By `load`, as one state of a run that is worked on. */
static Status load_at_once(Loading *l, Status (*load_it)(Loading *l, Err *err), Err *err)
{
    Run *run = l->run;
    l->digest = database_format(l->d) < 3 ? "NULL" : "digest";
    memset(run, 0, sizeof *run);
    TRY(database_do(l->d, err, "BEGIN", ""));
    Status status = load_it(l, err);
    const Status end = database_do(l->d, status == STATUS_OK ? err : NULL, "COMMIT", "");
    status = status == STATUS_OK ? end : status;
    if (status != STATUS_OK)
        run_free(run);
    return status;
}

static Status load_from(Loading *l, const char *folder, Err *err)
{
    TRY(load_at_once(l, load, err));
    if (l->run->n_ahead > 0 && !is_plain_end(l->run)) {
        run_free(l->run);
        return run_load(l->run, l->d, folder, err);
    }
    snprintf(l->run->folder, sizeof l->run->folder, "%s", folder);
    return STATUS_OK;
}

Status run_load_part(Run *run, Database *d, const char *folder, RunPart part, Err *err)
{
    return load_from(&(Loading){.run = run, .d = d, .part = part}, folder, err);
}

Status run_review(Run *run, Database *d, const char *folder, const Results *known, Err *err)
{
    return load_from(&(Loading){.run = run, .d = d, .part = RUN_REVIEWED, .known = known}, folder, err);
}

Status run_load(Run *run, Database *d, const char *folder, Err *err)
{
    return run_load_part(run, d, folder, RUN_WHOLE, err);
}

int run_path(const char *folder, char path[], size_t size)
{
    return snprintf(path, size, "%s/run.sqlite", folder) < (int)size && access(path, F_OK) == 0;
}

static Status open_to_read(Database **d, const char *folder, Err *err)
{
    char path[PATH_MAX];
    *d = NULL;
    if (!run_path(folder, path, sizeof path))
        return fail(err, STATUS_MISSING, "%.200s: holds no run: run.sqlite is not there", folder);
    return database_open(d, path, DATABASE_READ, err);
}

Status run_read_part(Run *run, const char *folder, RunPart part, Err *err)
{
    Database *d;
    memset(run, 0, sizeof *run);
    Status status = open_to_read(&d, folder, err);
    if (status == STATUS_OK)
        status = run_load_part(run, d, folder, part, err);
    database_close(d);
    return folder_advise(folder, status, err);
}

Status run_read(Run *run, const char *folder, Err *err)
{
    return run_read_part(run, folder, RUN_WHOLE, err);
}

static Status visit_row(const RowNumbers *stored, void *loading, Err *err)
{
    Loading *l = loading;
    const size_t row = l->row++;
    if (row >= l->run->table.n || l->run->table.row[row].id != stored->id)
        return fail(err, STATUS_IO, "%s: is damaged: evaluation %ld is not where it was", database_path(l->d),
                    stored->id);
    return l->visitor->row(l->run, row, stored, l->user, err);
}

static Status visit(Loading *l, Err *err)
{
    const RunVisitor *v = l->visitor;
    TRY(load(l, err));
    if (v->begin)
        TRY(v->begin(l->run, l->user, err));
    l->row = 0;
    TRY(rows_each_text(l->d, visit_row, l, err));
    return v->end ? v->end(l->run, l->user, err) : STATUS_OK;
}

/* As load_at_once does it, from the folder; nothing stays. */
static Status look_at_once(Loading *l, const char *folder, Status (*look)(Loading *l, Err *err), Err *err)
{
    Status status = open_to_read(&l->d, folder, err);
    if (status == STATUS_OK)
        status = load_at_once(l, look, err);
    run_free(l->run);
    database_close(l->d);
    return folder_advise(folder, status, err);
}

Status run_visit(const char *folder, const RunVisitor *visitor, void *user, Err *err)
{
    Run run = {0};
    Loading l = {.run = &run, .part = RUN_RESULTS, .visitor = visitor, .user = user};
    return look_at_once(&l, folder, visit, err);
}

static Status print_evaluations(Loading *l, Err *err)
{
    size_t n;
    double finished;
    TRY(load_head(l, err));
    const Schema *s = &l->run->schema;
    l->header(l->out, s);
    TRY(rows_print(l->d, l->out, (RowShape){s->n_var, s->n_obj, s->n_extra}, 0, LONG_MAX, 1, &n, err));
    TRY(database_number(l->d, "SELECT simulated FROM generation ORDER BY number DESC LIMIT 1", 0, &finished, err));
    return counts(l, (long)n - (long)finished, "id >", (long)finished) ? STATUS_OK : tell_missing(l, err);
}

Status run_print_evaluations(const char *folder, RunHeader *header, FILE *f, Err *err)
{
    Run run = {0};
    Loading l = {.run = &run, .out = f, .header = header};
    return look_at_once(&l, folder, print_evaluations, err);
}
