#include "store/run_read.h"

#include <dirent.h>
#include <errno.h>
#include <jansson.h>
#include <unistd.h>

#include "base/stat.h"
#include "evaluate/measures.h"
#include "moga/archive.h"
#include "settings/settings.h"
#include "store/folder.h"
#include "store/tables.h"
#include "scene/neighbour.h"

typedef struct {
    Run *run;
    Database *d;
    RunParts parts;
    size_t n, n_of_search;    /* rows that have passed */
    EvaluationTable polished; /* rows that go behind those of the search */
} Loading;

/* -- settings and generations -------------------------------------------------------------------------------------- */

/* A number 0..most of the inputs that the provenance names. */
static long input_of(const Run *run, const char *key, long most)
{
    json_t *all = json_loads(run->provenance, 0, NULL);
    const long n = json_integer_value(json_object_get(json_object_get(all, "inputs"), key));
    json_decref(all);
    return n > 0 && n <= most ? n : 0;
}

/* Settings, provenance and what follows from them: the columns of the run. */
static Status take_head(sqlite3_stmt *row, void *user, Err *err)
{
    const Loading *l = user;
    Run *run = l->run;
    run->settings = calloc(1, sizeof *run->settings);
    run->provenance = strdup(column_text(row, 1));
    if (!run->settings || !run->provenance)
        return fail_memory(err, 1, "a run");
    if (!tables_head_is_whole(row))
        return database_damaged(l->d, err, "its settings are not what was written");
    settings_defaults(run->settings);
    TRY(settings_parse(run->settings, database_path(l->d), column_text(row, 0), err));
    run->planned_evals = column_whole(row, 2, 0);
    const long n_var = column_whole(row, 3, 0);
    run->tried_to_polish = column_whole(row, 4, 0);
    run->polished_at = column_whole(row, 5, 0);
    const int is_tower = run->settings->problem.kind == PROBLEM_TOWER;
    run->settings->problem.constraints = input_of(run, "constraints", CONSTRAINTS_MAX);
    /* The floors of the building: by the variables that are one per floor, else as the provenance says. */
    int n_floors = 0;
    if (is_tower)
        n_floors = design_space_floors(&run->settings->design, core_section(&run->settings->core), (int)n_var);
    if (is_tower && n_floors <= 0)
        n_floors = (int)input_of(run, "floors", FLOORS_MAX);
    TRY(schema_of(&run->schema, run->settings, n_floors, err));
    return run->schema.n_var == (size_t)n_var ? STATUS_OK : database_damaged(l->d, err, "it has %ld variables", n_var);
}

/* Of two copies the first that is what was written. */
static Status take_state(sqlite3_stmt *row, void *user, Err *err)
{
    const Loading *l = user;
    Run *run = l->run;
    const size_t n = sqlite3_column_bytes(row, 1);
    const void *bytes = sqlite3_column_blob(row, 1);
    if (run->state && !run->state_is_damaged)
        return STATUS_OK;
    free(run->state);
    run->state_is_damaged = sqlite3_column_int64(row, 2) != state_digest(column_whole(row, 0, 0), bytes, n);
    run->n_state = n;
    run->state = malloc(n + 1);
    if (!run->state)
        return fail_memory(err, n, "bytes of a state");
    if (n > 0)
        memcpy(run->state, bytes, n);
    return STATUS_OK;
}

/* All but the rows. The designs that are on the front must be those of which the last generation has the digest. */
static Status load_head(Loading *l, Err *err)
{
    Run *run = l->run;
    TRY(database_each(
        l->d, "SELECT settings, provenance, planned_evals, n_var, tried_to_polish, polished_at, digest FROM run",
        take_head, l, err));
    if (!run->schema.column)
        return database_damaged(l->d, err, "it has no settings");
    TRY(tables_check(l->d, &run->schema, err));
    TRY(records_read(l->d, TABLE_GENERATION, &run->generation, &run->n_generations, err));
    TRY(records_read(l->d, TABLE_SESSION, &run->session, &run->n_sessions, err));
    TRY(records_read(l->d, TABLE_FRONT, &run->mark, &run->n_marks, err));
    TRY(database_each(l->d, "SELECT generation, bytes, digest FROM state ORDER BY copy", take_state, l, err));
    if (run->n_generations == 0)
        return STATUS_OK;
    const RunGeneration *last = &run->generation[run->n_generations - 1];
    uint64_t members = 0;
    for (size_t i = 0; i < run->n_marks; i++)
        members ^= run->mark[i].left == NEVER ? digest_member(run->mark[i].id) : 0;
    run->n_finished = last->simulated;
    run->state_is_damaged |= !run->state;
    return (long)members == last->members ? STATUS_OK
                                          : database_damaged(l->d, err, "its front is not what was written");
}

/* -- evaluations --------------------------------------------------------------------------------------------------- */

static int by_id(const void *id, const void *mark)
{
    const long other = ((const RunMark *)mark)->id;
    return (*(const long *)id > other) - (*(const long *)id < other);
}

/* When a design was on the front of the search. */
static RunMark mark_of(const Run *run, long id)
{
    const RunMark *mark = run->n_marks > 0 ? bsearch(&id, run->mark, run->n_marks, sizeof *run->mark, by_id) : NULL;
    return mark ? *mark : (RunMark){id, NEVER, NEVER};
}

static int has_succeeded(const Run *run, const Evaluation *e)
{
    return e->outcome == OUTCOME_OK && all_finite(run->schema.n_obj, e->f);
}

/* Every row is checked and counted as it passes: the finished ones have the ids 1, 2, ... but for polished ones,
 * without a gap. */
static Status take_row(const Evaluation *e, void *user, Err *err)
{
    Loading *l = user;
    Run *run = l->run;
    const int is_outside = kind_is_outside(e->kind), ok = has_succeeded(run, e);
    const long expected = (long)++l->n;
    if (!is_outside && ++l->n_of_search <= run->n_finished && e->id != expected)
        return database_damaged(l->d, err, "evaluation %ld is missing", expected);
    run->n_failed += !ok;
    run->n_repeats += e->kind == KIND_REPEAT;
    for (size_t i = 0; i < run->schema.n_extra && ok; i++) {
        run->extra_min[i] = fmin(run->extra_min[i], e->extra[i]);
        run->extra_max[i] = fmax(run->extra_max[i], e->extra[i]);
    }
    if (l->parts == RUN_FRONT && !is_outside && ok) {
        const RunMark mark = mark_of(run, e->id);
        if (mark.entered == NEVER || (mark.left != NEVER && run->finer.n == 0))
            return STATUS_OK; /* never on the front */
    }
    return evaluation_table_append(is_outside ? &l->polished : &run->table, e, err);
}

/* When a design was on the front, whether it succeeded, of how many simulations it is. */
static Status make_places(Run *run, Err *err)
{
    TRY_ROOM(run->place, run->table.n + 1, "evaluations", err);
    for (size_t i = 0; i < run->table.n; i++) {
        Evaluation *e = &run->table.row[i];
        const RunMark mark = mark_of(run, e->id);
        const int ok = has_succeeded(run, e);
        run->place[i] = (RunPlace){mark.entered, mark.left, ok, ok && mark.entered != NEVER && mark.left == NEVER};
        if (e->kind != KIND_REPEAT && !kind_is_outside(e->kind))
            e->replicates = e->kind == KIND_SCREENED ? 1 : (int)run->settings->sim.replicates;
    }
    return STATUS_OK;
}

static int is_known_to_search(const Evaluation *r)
{
    return r->kind != KIND_UNFINISHED && !kind_is_outside(r->kind);
}

/* Designs as the search sees them, in its archive: each with the mean of its evaluations. */
static Status join_repeats(Run *run, Err *err)
{
    const size_t m = run->schema.n_obj;
    double f[OBJECTIVES_MAX];
    Archive a;
    TRY(pareto_archive_init(&a, run->table.n, run->schema.n_var, m, 0, err));
    Status status = STATUS_OK;
    for (size_t i = 0; i < run->table.n; i++) {
        const Evaluation *r = &run->table.row[i];
        for (size_t k = 0; k < m; k++)
            f[k] = schema_objective(&run->schema, k)->sense * r->f[k];
        if (is_known_to_search(r))
            THEN(status, pareto_archive_insert(&a, r->x, f, NULL, run->place[i].ok, r->kind, r->generation, err));
    }
    if (status == STATUS_OK)
        pareto_archive_update_noise(&a);
    for (size_t i = 0, at = 0; i < run->table.n && status == STATUS_OK; i++) {
        Evaluation *r = &run->table.row[i];
        if (!is_known_to_search(r))
            continue;
        if (a.replicates[at] > 0)
            r->replicates = (int)(a.replicates[at] * run->schema.replicates);
        for (size_t k = 0; k < m && a.replicates[at] > 0 && a.usable[at]; k++) {
            run->F[i * m + k] = schema_objective(&run->schema, k)->sense * a.F[at * m + k];
            if (a.n_replicates > 0)
                r->sd[k] = a.sd[at * m + k] * sqrt((double)run->schema.replicates);
        }
        at++;
    }
    pareto_archive_free(&a);
    return status;
}

static Status take_finer(const Evaluation *e, void *run, Err *err)
{
    return evaluation_table_append(&((Run *)run)->finer, e, err);
}

/* Designs that a study names have the numbers of their simulation with more steps. */
static Status join_finer(Loading *l, Err *err)
{
    Run *run = l->run;
    const Schema *s = &run->schema;
    for (size_t i = 0; i < run->finer.n; i++) {
        Evaluation *better = &run->finer.row[i];
        const size_t row = run_find(run, better->id);
        if (row == run->table.n)
            return database_damaged(l->d, err, "evaluation %ld is missing", better->id);
        Evaluation *e = &run->table.row[row];
        better->err = e->err = better->extra + s->n_extra;
        e->violation = better->violation;
        e->level = better->level;
        memcpy(e->f, better->f, s->n_obj * sizeof *e->f);
        if (e->sd)
            memcpy(e->sd, better->sd, s->n_obj * sizeof *e->sd);
        memcpy(e->extra, better->extra, s->n_extra * sizeof *e->extra);
        memcpy(run->F + row * s->n_obj, better->f, s->n_obj * sizeof *run->F);
    }
    return STATUS_OK;
}

/* Evaluations: those of the search in the order of their ids, then the polished ones. Means need all. */
static Status load_rows(Loading *l, Err *err)
{
    Run *run = l->run;
    const Schema *s = &run->schema;
    if (s->is_noisy)
        l->parts = RUN_WHOLE;
    run->finer = evaluation_table(0, s->n_obj, s->n_extra + s->n_obj + s->n_extra);
    TRY(rows_each(l->d, ROWS_FINER, s, "1", take_finer, run, err));
    run->table = evaluation_table(s->n_var, s->n_obj, s->n_extra);
    run->table.n_sd = s->has_spread ? s->n_obj : 0;
    l->polished = run->table;
    TRY(rows_each(l->d, ROWS_EVALUATION, s, "1", take_row, l, err));
    if (l->n_of_search < run->n_finished)
        return database_damaged(l->d, err, "evaluation %zu is missing", l->n + 1);
    for (size_t i = 0; i < l->polished.n; i++)
        TRY(evaluation_table_append(&run->table, &l->polished.row[i], err));
    const size_t n = run->table.n;
    run->F = s->is_noisy ? calloc(n * s->n_obj + 1, sizeof *run->F) : run->table.f;
    if (n > 0 && !run->F)
        return fail_memory(err, n, "evaluations");
    if (n > 0 && run->F != run->table.f)
        memcpy(run->F, run->table.f, n * s->n_obj * sizeof *run->F);
    TRY(make_places(run, err));
    if (s->is_noisy && n > 0)
        TRY(join_repeats(run, err));
    TRY(join_finer(l, err));
    free(run->mark);
    run->mark = NULL;
    run->n_marks = 0;
    return run_settle_front(run, err);
}

/* -- all of it ----------------------------------------------------------------------------------------------------- */

Status run_load(Run *run, Database *d, const char *folder, RunParts parts, Err *err)
{
    Loading l = {.run = run, .d = d, .parts = parts};
    memset(run, 0, sizeof *run);
    TRY(database_do(d, err, "BEGIN", "")); /* one state of a run that is worked on */
    Status status = load_head(&l, err);
    if (parts != RUN_HEAD)
        THEN(status, load_rows(&l, err));
    evaluation_table_free(&l.polished);
    const Status end = database_do(d, status == STATUS_OK ? err : NULL, "COMMIT", "");
    THEN(status, end);
    text_copy(run->folder, folder);
    const int is_empty = parts == RUN_FRONT && run->n_front == 0; /* then what comes nearest is asked for */
    if (status != STATUS_OK || is_empty)
        run_free(run);
    return status == STATUS_OK && is_empty ? run_load(run, d, folder, RUN_WHOLE, err) : status;
}

int run_is_there(const char *folder)
{
    return folder_has(folder, "run.sqlite");
}

int runs_each(const char *folder, RunFolderFn take, void *user)
{
    char path[PATH_MAX];
    struct dirent **entries;
    const int n = scandir(folder, &entries, NULL, versionsort);
    for (int i = 0; i < n; i++) {
        const char *name = entries[i]->d_name;
        const int has_room = snprintf(path, sizeof path, "%s/%s", folder, name) < PATH_MAX;
        if (*name != '.' && has_room && run_is_there(path))
            take(path, name, user);
        free(entries[i]);
    }
    if (n >= 0)
        free(entries);
    return n;
}

Status run_wanted(const char *folder, Err *err)
{
    if (access(folder, F_OK) != 0 && errno == ENOENT)
        return fail_missing(err, folder);
    return run_is_there(folder) ? STATUS_OK
                                : fail(err, STATUS_MISSING, "%.200s: holds no run: run.sqlite is not there", folder);
}

Status run_read(Run *run, const char *folder, Err *err)
{
    char path[PATH_MAX];
    Database *d;
    memset(run, 0, sizeof *run);
    TRY(run_wanted(folder, err));
    folder_path(folder, "run.sqlite", path);
    Status status = database_open(&d, path, DATABASE_READ, err);
    THEN(status, run_load(run, d, folder, RUN_WHOLE, err));
    database_close(d);
    return folder_advise(folder, status, err);
}
