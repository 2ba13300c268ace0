#include "store/store.h"

#include <errno.h>
#include <limits.h>
#include <math.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>
#include <unistd.h>

#include "base/clock.h"
#include "moga/hypervolume.h"
#include "settings/settings.h"
#include "store/export.h"
#include "store/folder.h"
#include "store/output.h"
#include "store/run_read.h"
#include "store/tables.h"

struct RunStore {
    Folder folder;
    const Schema *schema;
    Database *db;
    Run run; /* that the folder held when it was opened */
    int has_run;
    EvaluationTable unfinished; /* of it */
    long *polished;             /* (n_polished) ids of it, ascending */
    size_t n_polished;

    EvaluationTable waiting;     /* rows for the next commit or the end of their generation */
    size_t n_stored;             /* evaluations of the search, those that wait included */
    int is_lost;                 /* a transaction was rolled back: nothing more is written */
    double last_commit;          /* [s] of the clock */
    double last_generation;      /* ... */
    size_t n_known;              /* designs of finished generations */
    unsigned char *was_on_front; /* (n_known) at the end of the last generation */
    uint64_t front;              /* digest of those on it */
    Hypervolume *hypervolume;    /* that the front dominates; NULL: no design has succeeded yet */
    size_t n_measured;           /* designs that it has seen */
    long session;
    Append text, events; /* log.txt, log.jsonl */
};

const char *store_folder(const RunStore *store)
{
    return store->folder.path;
}

const Run *store_run(const RunStore *store)
{
    return store->has_run ? &store->run : NULL;
}

const EvaluationTable *store_unfinished(const RunStore *store)
{
    return &store->unfinished;
}

const unsigned char *store_on_front(const RunStore *store)
{
    return store->was_on_front;
}

double store_hypervolume(const RunStore *store)
{
    return store->hypervolume ? hypervolume_share(store->hypervolume) : NAN;
}

/* Polished designs have taken numbers between those of the search. */
static long id_of(const RunStore *store, size_t row)
{
    long id = (long)row + 1;
    for (size_t p = 0; p < store->n_polished; p++)
        id += store->polished[p] <= id;
    return id;
}

static long number_of(const RunStore *store, long id)
{
    size_t before = 0;
    while (before < store->n_polished && store->polished[before] < id)
        before++;
    return id - (long)before;
}

/* -- a folder, and what it holds ----------------------------------------------------------------------------------- */

static Status open_database(RunStore *store, Err *err)
{
    char path[PATH_MAX];
    folder_path(&store->folder, "run.sqlite", path);
    return database_open(&store->db, path, DATABASE_WRITE, err);
}

/* Nothing tells a journal that was lost from one that was never there but the number beside it. */
static Status check_nothing_lost(const RunStore *store, Err *err)
{
    if (store->folder.n_stored <= store->n_stored)
        return STATUS_OK;
    return fail(
        err, STATUS_IO,
        "%s: %zu evaluations were stored, as its file `lock` says; run.sqlite %s%zu: %s is missing. Put it back; to "
        "go on without those evaluations remove `lock`; for another run: --new",
        store_folder(store), store->folder.n_stored, store->has_run ? "has " : "is not there, ", store->n_stored,
        store->has_run ? "its journal run.sqlite-wal, or part of it," : "the database");
}

/* An evaluation that belongs to no later generation than the one that was cut short; others are left of a transaction
 * that was lost. So is, where they are numbered as they arrive, what is behind a gap. */
static int is_of_the_next(const RunStore *store, const Evaluation *e)
{
    const Run *run = &store->run;
    const long next = run->n_generations > 0 ? run->generation[run->n_generations - 1].number + 1 : 0;
    return e->generation <= next && (run->settings->search.asynchronous == SWITCH_OFF ||
                                     number_of(store, e->id) == (long)(run->n_finished + store->unfinished.n) + 1);
}

static Status take_open_row(const Evaluation *e, void *user, Err *err)
{
    RunStore *store = user;
    store->n_stored += e->kind == KIND_UNFINISHED;
    if (e->kind == KIND_UNFINISHED && is_of_the_next(store, e)) {
        TRY(evaluation_table_append(&store->unfinished, e, err));
        store->unfinished.row[store->unfinished.n - 1].id = number_of(store, e->id);
    }
    if (e->kind != KIND_POLISHED)
        return STATUS_OK;
    long *wider = realloc(store->polished, (store->n_polished + 1) * sizeof *wider);
    if (!wider)
        return fail(err, STATUS_NO_MEMORY, "no memory for %zu designs", store->n_polished + 1);
    store->polished = wider;
    wider[store->n_polished++] = e->id;
    return STATUS_OK;
}

/* What a session needs: not the rows of finished generations, which pass by when the search is resumed. */
static Status read_open_rows(RunStore *store, Err *err)
{
    const Run *run = &store->run;
    const Schema *s = &run->schema;
    evaluation_table_free(&store->unfinished);
    store->unfinished = evaluation_table(s->n_var, s->n_obj, s->n_extra);
    store->n_polished = 0;
    store->n_known = store->n_stored = run->n_finished;
    TRY(rows_each(store->db, s, "kind IS NULL OR kind = 'polished'", take_open_row, store, err));
    free(store->was_on_front);
    store->was_on_front = calloc(store->n_known + 1, 1);
    if (!store->was_on_front)
        return fail(err, STATUS_NO_MEMORY, "no memory for %zu designs", store->n_known);
    store->front = 0;
    for (size_t i = 0; i < run->n_marks; i++) {
        const RunMark *m = &run->mark[i];
        const long number = number_of(store, m->id);
        if (m->left != NEVER || number > (long)store->n_known)
            continue;
        store->was_on_front[number - 1] = 1;
        store->front ^= digest_member(m->id);
    }
    return STATUS_OK;
}

static Status load_run(RunStore *store, int whole, Err *err)
{
    TRY(open_database(store, err));
    TRY(whole ? run_load(&store->run, store->db, store_folder(store), err)
              : run_load_head(&store->run, store->db, store_folder(store), err));
    store->has_run = 1;
    database_grow(store->db);
    return read_open_rows(store, err);
}

static Status open_store(RunStore **out, const char *folder, int fresh, int whole, Err *err)
{
    *out = NULL;
    RunStore *store = calloc(1, sizeof *store);
    if (!store)
        return fail(err, STATUS_NO_MEMORY, "no memory for a run");
    Status status = folder_take(&store->folder, folder, fresh, err);
    if (status == STATUS_OK && folder_has(&store->folder, "run.sqlite"))
        status = folder_advise(store_folder(store), load_run(store, whole, err), err);
    if (status == STATUS_OK)
        status = check_nothing_lost(store, err);
    if (status == STATUS_OK)
        *out = store;
    else
        store_free(store);
    return status;
}

Status store_open(RunStore **out, const char *folder, int fresh, Err *err)
{
    return open_store(out, folder, fresh, 0, err);
}

Status store_open_run(RunStore **out, const char *folder, Err *err)
{
    char path[PATH_MAX];
    *out = NULL;
    if (!run_path(folder, path, sizeof path))
        return fail(err, STATUS_MISSING, "%.200s: holds no run: run.sqlite is not there", folder);
    return open_store(out, folder, 0, 1, err);
}

/* The journal goes first: left alone it would be taken for that of the next database. */
Status store_forget_empty(RunStore *store, Err *err)
{
    char path[PATH_MAX];
    if (!store->has_run || store->n_stored > 0 || store->n_polished > 0 || store->run.n_generations > 0)
        return STATUS_OK;
    database_close(store->db);
    run_free(&store->run);
    store->db = NULL;
    store->has_run = 0;
    folder_path(&store->folder, "run.sqlite", path);
    database_remove_journal(path);
    return unlink(path) == 0 || errno == ENOENT
               ? STATUS_OK
               : fail(err, STATUS_IO, "%s: cannot be removed: %s", path, strerror(errno));
}

static Status write_origin(const RunStore *store, const Settings *used, const char *provenance, Err *err)
{
    char path[PATH_MAX];
    Output o;
    folder_path(&store->folder, "settings.ini", path);
    TRY(output_open_inside(&o, path, err));
    settings_write(used, o.stream, SETTINGS_PLAIN);
    TRY(output_close(&o, err));
    folder_path(&store->folder, "provenance.json", path);
    TRY(output_open_inside(&o, path, err));
    fprintf(o.stream, "%s\n", provenance);
    return output_close(&o, err);
}

/* Ready for a session. */
static Status make_ready(RunStore *store, const Settings *used, const char *provenance, Err *err)
{
    folder_note(&store->folder, store->n_stored);
    TRY(write_origin(store, used, provenance, err));
    TRY(append_open(&store->text, &store->folder, "log.txt", err));
    return append_open(&store->events, &store->folder, "log.jsonl", err);
}

static void take_schema(RunStore *store, const Schema *schema)
{
    store->schema = schema;
    store->waiting = evaluation_table(schema->n_var, schema->n_obj, schema->n_extra);
}

Status store_begin(RunStore *store, const Schema *schema, const Settings *used, const char *provenance, Err *err)
{
    char path[PATH_MAX];
    take_schema(store, schema);
    folder_path(&store->folder, "run.sqlite", path);
    TRY(tables_create(path, schema, used, provenance, err));
    TRY(open_database(store, err));
    database_grow(store->db);
    return make_ready(store, used, provenance, err);
}

/* -- transactions -------------------------------------------------------------------------------------------------- */

static Status begin(RunStore *store, Err *err)
{
    if (store->is_lost)
        return fail(err, STATUS_IO, "%s: nothing more is written after a fault", database_path(store->db));
    return database_in_transaction(store->db) ? STATUS_OK : database_do(store->db, err, "BEGIN IMMEDIATE", "");
}

/* What is not committed cannot be: rows that came later would stand behind a gap. */
static Status lose(RunStore *store, Status status)
{
    if (database_in_transaction(store->db))
        database_do(store->db, NULL, "ROLLBACK", "");
    store->waiting.n = 0;
    store->is_lost = 1;
    return status;
}

static Status commit(RunStore *store, Status status, Err *err)
{
    if (status == STATUS_OK)
        status = database_do(store->db, err, "COMMIT", "");
    return status == STATUS_OK ? STATUS_OK : lose(store, status);
}

static Status insert_waiting(RunStore *store, Err *err)
{
    for (size_t i = 0; i < store->waiting.n; i++) {
        Evaluation e = store->waiting.row[i];
        e.id = id_of(store, (size_t)e.id - 1);
        TRY(rows_insert(store->db, store->schema, &e, err));
    }
    return STATUS_OK;
}

Status store_flush(RunStore *store, Err *err)
{
    if (store->is_lost || !store->db || (store->waiting.n == 0 && !database_in_transaction(store->db)))
        return STATUS_OK;
    TRY(begin(store, err));
    TRY(commit(store, insert_waiting(store, err), err));
    store->waiting.n = 0;
    store->last_commit = clock_seconds();
    folder_note(&store->folder, store->n_stored);
    return STATUS_OK;
}

/* -- a session ----------------------------------------------------------------------------------------------------- */

/* What is_of_the_next has left out. */
static Status drop_lost(RunStore *store, Err *err)
{
    const Run *run = &store->run;
    const long next = run->n_generations > 0 ? run->generation[run->n_generations - 1].number + 1 : 0;
    TRY(database_do(store->db, err, "DELETE FROM evaluation WHERE kind IS NULL AND generation > ?", "i", next));
    store->n_stored = run->n_finished + store->unfinished.n;
    return run->settings->search.asynchronous == SWITCH_OFF
               ? STATUS_OK
               : database_do(store->db, err, "DELETE FROM evaluation WHERE kind IS NULL AND id > ?", "i",
                             store->n_stored > 0 ? id_of(store, store->n_stored - 1) : 0L);
}

/* At once: with the new limits alone a run that is killed before its next session would be finished for good. */
Status store_resume(RunStore *store, const Schema *schema, const Settings *used, int goes_on, Err *err)
{
    take_schema(store, schema);
    TRY(begin(store, err));
    Status status = drop_lost(store, err);
    if (status == STATUS_OK)
        status = tables_set_settings(store->db, used, &store->run, err);
    if (status == STATUS_OK && goes_on)
        status = database_do(store->db, err, "UPDATE session SET is_final = 0 WHERE is_final", "");
    TRY(commit(store, status, err));
    return make_ready(store, used, store->run.provenance, err);
}

Status store_session(RunStore *store, const char *program, int threads, size_t n_simulated, Err *err)
{
    char started[24], host[65] = "";
    double number;
    utc_now(started);
    gethostname(host, sizeof host - 1);
    TRY(database_do(store->db, err,
                    "INSERT INTO session(started, host, pid, program, threads, simulated_before, seconds, is_final) "
                    "VALUES (?, ?, ?, ?, ?, ?, 0, 0)",
                    "ttitii", started, host, (long)getpid(), program, (long)threads, (long)n_simulated));
    store->last_commit = clock_seconds();
    TRY(database_number(store->db, "SELECT last_insert_rowid()", 0, &number, err));
    store->session = (long)number;
    return STATUS_OK;
}

typedef struct {
    RunStore *store;
    EvaluationFn take;
    void *user;
    size_t n;
} Each;

static Status missing(const RunStore *store, size_t row, Err *err)
{
    return database_damaged(store->db, err, "evaluation %ld is missing", id_of(store, row));
}

static Status take_finished(const Evaluation *e, void *user, Err *err)
{
    Each *each = user;
    return e->id == id_of(each->store, each->n++) ? each->take(e, each->user, err)
                                                  : missing(each->store, each->n - 1, err);
}

Status store_each_finished(EvaluationFn take, void *search, void *user, Err *err)
{
    RunStore *store = user;
    Each each = {.store = store, .take = take, .user = search};
    Status status =
        rows_each(store->db, store->schema, "kind IS NOT NULL AND kind <> 'polished'", take_finished, &each, err);
    if (status == STATUS_OK && each.n != store->run.n_finished)
        status = missing(store, each.n, err);
    return folder_advise(store_folder(store), status, err);
}

Status store_evaluation(RunStore *store, const Evaluation *e, Err *err)
{
    const size_t n = store->waiting.n;
    const Status status = evaluation_table_append(&store->waiting, e, err);
    if (status != STATUS_OK) {
        store->waiting.n = n; /* without the half of it */
        return status;
    }
    store->n_stored++;
    if (e->seconds >= COMMIT_S || clock_seconds() >= store->last_commit + COMMIT_S)
        TRY(store_flush(store, err));
    return STATUS_OK;
}

/* -- the hypervolume of a run: the share of a box that its front dominates ----------------------------------------- */

/* A box about the first designs that succeeded: from a fifth of their range below the best to the worst. */
static Status create_cover(RunStore *store, const SearchView *v, Err *err)
{
    double lower[OBJECTIVES_MAX], reference[OBJECTIVES_MAX];
    size_t first = 0;
    while (first < v->n && !v->ok[first])
        first++;
    if (first == v->n)
        return STATUS_OK;
    for (size_t k = 0; k < v->n_obj; k++) {
        lower[k] = reference[k] = v->Y[first * v->n_obj + k];
        for (size_t i = first; i < v->n && v->generation[i] == v->generation[first]; i++)
            if (v->ok[i]) {
                lower[k] = fmin(lower[k], v->Y[i * v->n_obj + k]);
                reference[k] = fmax(reference[k], v->Y[i * v->n_obj + k]);
            }
        const double range = reference[k] > lower[k] ? reference[k] - lower[k] : 1.0;
        lower[k] -= 0.2 * range;
        reference[k] = fmax(reference[k], lower[k] + range);
    }
    return hypervolume_create(&store->hypervolume, v->n_obj, lower, reference, 1, err);
}

/* Only designs on the front count: one that an earlier one dominates adds nothing. Where repeats move designs and take
 * them off the front, all of it is measured again. */
static Status measure_front(RunStore *store, const SearchView *v, Err *err)
{
    if (v->n_replicates > 0) {
        hypervolume_free(store->hypervolume);
        store->hypervolume = NULL;
        store->n_measured = 0;
    }
    if (!store->hypervolume)
        TRY(create_cover(store, v, err));
    if (!store->hypervolume)
        return STATUS_OK;
    for (size_t i = v->n;
         i-- > store->n_measured;) /* later designs dominate more: fewer samples are left for the others */
        if (v->on_front[i])
            hypervolume_add(store->hypervolume, v->F + i * v->n_obj);
    store->n_measured = v->n;
    return STATUS_OK;
}

/* -- generations --------------------------------------------------------------------------------------------------- */

/* Of the rows of the generation those that wait get their kind before they are stored; `waited` (v->n - n_known). */
static void finish_waiting(RunStore *store, const SearchView *v, unsigned char waited[])
{
    for (size_t i = 0; i < store->waiting.n; i++) {
        Evaluation *e = &store->waiting.row[i];
        const size_t row = (size_t)e->id - 1;
        if (row < store->n_known || row >= v->n)
            continue;
        e->kind = (EvaluationKind)v->kind[row];
        e->generation = (long)v->generation[row];
        waited[row - store->n_known] = 1;
    }
}

static Status store_rows(RunStore *store, const SearchView *v, Err *err)
{
    unsigned char *waited = calloc(v->n - store->n_known + 1, 1);
    if (!waited)
        return fail(err, STATUS_NO_MEMORY, "no memory for %zu designs", v->n - store->n_known);
    finish_waiting(store, v, waited);
    Status status = insert_waiting(store, err);
    for (size_t i = store->n_known; i < v->n && status == STATUS_OK; i++)
        if (!waited[i - store->n_known])
            status = rows_finish(store->db, id_of(store, i), (EvaluationKind)v->kind[i], (long)v->generation[i], err);
    free(waited);
    if (status != STATUS_OK || v->is_asynchronous)
        return status;
    /* what another program or machine had asked for in this generation before it was cut short */
    store->n_stored = v->n;
    return database_do(store->db, err, "DELETE FROM evaluation WHERE kind IS NULL AND id > ?", "i",
                       v->n > 0 ? id_of(store, v->n - 1) : 0L);
}

static Status store_front_change(RunStore *store, const SearchView *v, size_t i, Err *err)
{
    const long id = id_of(store, i), generation = (long)v->generation_now;
    store->front ^= digest_member(id);
    if (v->on_front[i])
        return database_do(store->db, err,
                           "INSERT INTO front(evaluation, entered) VALUES (?, ?) ON CONFLICT(evaluation) DO UPDATE "
                           "SET left = NULL",
                           "ii", id, generation);
    return database_do(store->db, err, "UPDATE front SET left = ? WHERE evaluation = ?", "ii", generation, id);
}

static Status store_front_changes(RunStore *store, const SearchView *v, Err *err)
{
    enum { BLOCK = 64 };
    unsigned char *flags = realloc(store->was_on_front, v->n + 1);
    if (!flags)
        return fail(err, STATUS_NO_MEMORY, "no memory for %zu designs", v->n);
    store->was_on_front = flags;
    memset(flags + store->n_known, 0, v->n - store->n_known);
    store->n_known = v->n;
    for (size_t i = 0; i < v->n; i++) {
        if (i % BLOCK == 0 && i + BLOCK <= v->n && memcmp(v->on_front + i, flags + i, BLOCK) == 0) {
            i += BLOCK - 1; /* nothing has changed here */
            continue;
        }
        if (v->on_front[i] != flags[i])
            TRY(store_front_change(store, v, i, err));
        flags[i] = v->on_front[i];
    }
    return STATUS_OK;
}

static Status store_moment(RunStore *store, const SearchView *v, double seconds, Err *err)
{
    RunGeneration g = {.number = (long)v->generation_now,
                       .simulated = (long)v->n,
                       .failed = (long)v->n_failed,
                       .front = (long)v->n_front,
                       .surrogate_error = v->surrogate_error,
                       .hypervolume = store_hypervolume(store),
                       .seconds = seconds};
    utc_now(g.finished);
    return database_do(store->db, err,
                       "INSERT INTO generation(number, simulated, failed, front, surrogate_error, "
                       "hypervolume, seconds, finished, digest) VALUES (?, ?, ?, ?, ?, ?, ?, ?, ?)",
                       "iiiidddti", g.number, g.simulated, g.failed, g.front, g.surrogate_error, g.hypervolume,
                       g.seconds, g.finished, run_generation_digest(&g));
}

/* The states of two generations are kept: one that the disk has damaged gives way to the one before. */
static Status store_state(RunStore *store, const SearchView *v, Err *err)
{
    const long generation = (long)v->generation_now;
    TRY(database_do(store->db, err, "DELETE FROM state WHERE generation < ?", "i", generation - 1));
    return database_do(
        store->db, err, "INSERT OR REPLACE INTO state(generation, bytes, digest, front) VALUES (?, ?, ?, ?)", "ibii",
        generation, v->state, v->n_state, run_state_digest(generation, v->state, v->n_state), (long)store->front);
}

static Status put_generation(RunStore *store, const SearchView *v, double seconds, double session, Err *err)
{
    if (!v->state)
        return fail(err, STATUS_NO_MEMORY, "no memory for the state of the search");
    TRY(store_rows(store, v, err));
    TRY(store_front_changes(store, v, err));
    TRY(store_moment(store, v, seconds, err));
    TRY(database_do(store->db, err,
                    "UPDATE session SET seconds = ?, search = ?, waited = ?, surrogate = ? WHERE number = ?", "ddddi",
                    session, v->seconds, v->waited_s, v->surrogate_s, store->session));
    return store_state(store, v, err);
}

/* All of it or nothing: half a generation beside the state of the one before could not be resumed. Simulations that
 * wait for the next commit are not lost with it, unless SQLite has rolled back more than this generation. */
static Status put_whole_generation(RunStore *store, const SearchView *v, double seconds, double session, Err *err)
{
    TRY(begin(store, err));
    TRY(database_do(store->db, err, "SAVEPOINT generation", ""));
    Status status = put_generation(store, v, seconds, session, err);
    if (status == STATUS_OK)
        status = database_do(store->db, err, "RELEASE generation", "");
    if (status == STATUS_OK) {
        store->waiting.n = 0;
        return STATUS_OK;
    }
    if (!database_in_transaction(store->db) ||
        database_do(store->db, NULL, "ROLLBACK TO generation; RELEASE generation", "") != STATUS_OK)
        return lose(store, status);
    for (size_t i = 0; i < store->waiting.n; i++)
        store->waiting.row[i].kind = KIND_UNFINISHED;
    return status;
}

/* Generations that take a moment are committed together, COMMIT_S after the last commit: a commit waits for the disk.
 * */
static int is_due(RunStore *store, const SearchView *v)
{
    const double now = clock_seconds(), before = store->last_generation;
    store->last_generation = now;
    return v->is_last || now >= store->last_commit + COMMIT_S || now >= before + GENERATION_S;
}

Status store_generation(RunStore *store, const SearchView *v, double seconds, double session, Err *err)
{
    TRY(measure_front(store, v, err));
    TRY(put_whole_generation(store, v, seconds, session, err));
    if (!is_due(store, v))
        return STATUS_OK;
    TRY(store_flush(store, err));
    return database_check_place(store->db, err);
}

/* What is known of later generations is taken out again, their evaluations stay. A design that left the front, came
 * back in one of them and is taken off again by the next one has lost its first leaving: its digest is not known. */
static Status step_back(RunStore *store, Err *err)
{
    const Run *run = &store->run;
    const long last = run->state_generation;
    for (size_t g = 0; g < run->n_generations; g++)
        if (run->generation[g].number > last)
            TRY(rows_unfinish(store->db, run->generation[g].number, err));
    TRY(database_do(store->db, err, "DELETE FROM front WHERE entered > ?", "i", last));
    TRY(database_do(store->db, err, "UPDATE front SET left = NULL WHERE left > ?", "i", last));
    TRY(database_do(store->db, err, "DELETE FROM generation WHERE number > ?", "i", last));
    TRY(database_do(store->db, err, "DELETE FROM state WHERE generation > ?", "i", last));
    TRY(database_do(store->db, err, "UPDATE evaluation SET generation = ? WHERE kind IS NULL", "i", last + 1));
    return database_do(store->db, err, "UPDATE state SET front = NULL", "");
}

Status store_step_back(RunStore *store, Err *err)
{
    TRY(begin(store, err));
    TRY(commit(store, step_back(store, err), err));
    run_free(&store->run);
    TRY(run_load_head(&store->run, store->db, store_folder(store), err));
    return read_open_rows(store, err);
}

/* -- logs and the end ---------------------------------------------------------------------------------------------- */

Status store_log(RunStore *store, Err *err, const char *format, ...)
{
    char clock[32];
    struct tm parts;
    va_list args;
    const time_t now = time(NULL);
    if (!store->text.stream)
        return STATUS_OK;
    localtime_r(&now, &parts);
    strftime(clock, sizeof clock, "%F %T", &parts);
    fprintf(store->text.stream, "%s  ", clock);
    va_start(args, format);
    vfprintf(store->text.stream, format, args);
    va_end(args);
    fputc('\n', store->text.stream);
    return append_flush(&store->text, err);
}

Status store_event(RunStore *store, json_t *event, Err *err)
{
    char time[24];
    FILE *f = store->events.stream;
    utc_now(time);
    json_object_set_new(event, "time", json_string(time));
    if (f && json_dumpf(event, f, JSON_SORT_KEYS) == 0)
        fputc('\n', f);
    json_decref(event);
    return f ? append_flush(&store->events, err) : STATUS_OK;
}

Status store_read(RunStore *store, Run *run, Err *err)
{
    TRY(store_flush(store, err));
    return folder_advise(store_folder(store), run_load(run, store->db, store_folder(store), err), err);
}

static Status end_session(RunStore *store, const char *stopped, int is_final, double session, Err *err)
{
    char ended[24];
    utc_now(ended);
    TRY(store_flush(store, err));
    return database_do(store->db, err,
                       "UPDATE session SET ended = ?, stopped = ?, is_final = ?, seconds = ? WHERE number = ?", "ttidi",
                       ended, stopped, (long)is_final, session, store->session);
}

Status store_close(RunStore *store, const char *stopped, int is_final, double session, Run *run, Err *err)
{
    Run last = {0};
    Status status = end_session(store, stopped, is_final, session, err);
    if (status == STATUS_OK)
        status = store_read(store, &last, err);
    if (status == STATUS_OK)
        status = export_front(&last, err);
    if (status == STATUS_OK)
        status = append_close(&store->events, err);
    if (status == STATUS_OK)
        status = append_close(&store->text, err);
    store_free(store);
    if (run && status == STATUS_OK)
        *run = last;
    else
        run_free(&last);
    return status;
}

void store_free(RunStore *store)
{
    if (!store)
        return;
    append_free(&store->text);
    append_free(&store->events);
    database_close(store->db);
    run_free(&store->run);
    free(store->was_on_front);
    free(store->polished);
    evaluation_table_free(&store->unfinished);
    evaluation_table_free(&store->waiting);
    hypervolume_free(store->hypervolume);
    folder_release(&store->folder);
    free(store);
}

/* -- designs from outside ------------------------------------------------------------------------------------------ */

/* Behind all that are there, as of the last generation. */
static Status insert_polished(RunStore *store, const Evaluation *design, long *id, Err *err)
{
    double last, generation;
    Evaluation e = *design;
    TRY(database_number(store->db, "SELECT max(id) FROM evaluation", 0, &last, err));
    TRY(database_number(store->db, "SELECT max(number) FROM generation", 0, &generation, err));
    *id = e.id = (long)last + 1;
    e.generation = (long)generation;
    e.kind = KIND_POLISHED;
    return rows_insert(store->db, store->schema, &e, err);
}

Status store_polished(RunStore *store, const Evaluation *better, size_t n_tried, size_t n_simulated, Err *err)
{
    long id;
    TRY(begin(store, err));
    Status status = better ? insert_polished(store, better, &id, err) : STATUS_OK;
    if (status == STATUS_OK)
        status = database_do(store->db, err, "UPDATE run SET tried_to_polish = ?, polished_at = ?", "ii", (long)n_tried,
                             (long)n_simulated);
    return status == STATUS_OK ? store_flush(store, err) : lose(store, status);
}

Status store_add_evaluations(RunStore *store, size_t n, const Evaluation designs[], long *first_id, Err *err)
{
    Run now;
    long id = 0;
    Status status = begin(store, err);
    store->schema = &store->run.schema;
    for (size_t i = 0; i < n && status == STATUS_OK; i++) {
        status = insert_polished(store, &designs[i], &id, err);
        if (first_id && i == 0)
            *first_id = id;
    }
    TRY(status == STATUS_OK ? store_flush(store, err) : lose(store, status));
    TRY(store_read(store, &now, err));
    status = export_front(&now, err);
    run_free(&now);
    return status;
}
