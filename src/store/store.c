#include "store/store.h"

#include <errno.h>
#include <limits.h>
#include <math.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <time.h>
#include <unistd.h>

#include "base/clock.h"
#include "settings/settings.h"
#include "store/csv_files.h"
#include "store/digest.h"
#include "store/front_share.h"
#include "store/logs.h"
#include "store/results.h"
#include "store/rows.h"
#include "store/run_read.h"
#include "store/tables.h"

struct RunStore {
    Folder folder;
    const Schema *schema;
    Database *db;
    Run run; /* that the folder held when it was opened */
    int has_run, has_polished;

    EvaluationTable waiting; /* rows for the next commit or the end of their generation */
    int in_transaction;
    double last_commit;          /* [s] of the clock */
    double last_generation;      /* ... */
    size_t n_known;              /* designs of finished generations */
    Results passed;              /* ... that were read in this session, for its end */
    unsigned char *was_on_front; /* (n_known) at the end of the last generation */
    uint64_t front;              /* digest of those on it */
    FrontShare share;
    long session;
    CsvFiles files;
    Logs logs;
};

const char *store_folder(const RunStore *store)
{
    return store->folder.path;
}

const Run *store_run(const RunStore *store)
{
    return store->has_run ? &store->run : NULL;
}

double store_hypervolume(const RunStore *store)
{
    return front_share_value(&store->share);
}

/* -- a folder, and what it holds ----------------------------------------------------------------------------------- */

static Status open_database(RunStore *store, Err *err)
{
    char path[PATH_MAX];
    folder_path(&store->folder, "run.sqlite", path);
    return database_open(&store->db, path, DATABASE_WRITE, err);
}

/* evaluations.csv follows the database. Where it has more, the journal was lost, as by a copy of run.sqlite
 * alone, or it was edited: nothing tells the two apart. */
static Status check_nothing_lost(const RunStore *store, Err *err)
{
    const size_t n = store->run.n_ahead + store->run.table.n,
                 n_exported = folder_rows(&store->folder, "evaluations.csv");
    if (n_exported <= n)
        return STATUS_OK;
    return fail(err, STATUS_IO,
                "%s: evaluations.csv has %zu evaluations, run.sqlite %s%zu: %s is missing%s. Put it back; to resume "
                "without those evaluations rename evaluations.csv; for another run: --new",
                store_folder(store), n_exported, store->has_run ? "" : "is not there, ", n,
                store->has_run ? "its journal run.sqlite-wal, or part of it," : "the database",
                store->has_run ? ", or lines were added to evaluations.csv" : "");
}

static Status load_run(RunStore *store, RunPart part, Err *err)
{
    Status status = open_database(store, err);
    if (status == STATUS_OK)
        status = run_load_part(&store->run, store->db, store_folder(store), part, err);
    if (status == STATUS_OK)
        database_grow(store->db);
    return folder_advise(store_folder(store), status, err);
}

/* All of it, also what was left out; the files are regenerated, whatever was done to them. */
Status store_give_run(RunStore *store, Run *run, Err *err)
{
    if (store->run.n_ahead > 0) {
        run_free(&store->run);
        TRY(folder_advise(store_folder(store), run_load(&store->run, store->db, store_folder(store), err), err));
    }
    TRY(csv_files_replace(&store->folder, &store->run, err));
    *run = store->run;
    store->run = (Run){0};
    store->has_run = 0;
    return STATUS_OK;
}

static Status open_folder(RunStore *store, const char *folder, int fresh, RunPart part, Err *err)
{
    TRY(folder_take(&store->folder, folder, fresh, err));
    if (!folder_has(&store->folder, "run.sqlite"))
        return check_nothing_lost(store, err);
    TRY(load_run(store, part, err));
    store->has_run = 1;
    store->has_polished = run_has_polished(&store->run);
    return check_nothing_lost(store, err);
}

static Status open_part(RunStore **out, const char *folder, int fresh, RunPart part, Err *err)
{
    *out = NULL;
    RunStore *store = calloc(1, sizeof *store);
    if (!store)
        return fail(err, STATUS_NO_MEMORY, "no memory for a run");
    store->folder.lock = -1;
    const Status status = open_folder(store, folder, fresh, part, err);
    if (status == STATUS_OK)
        *out = store;
    else
        store_free(store);
    return status;
}

Status store_open(RunStore **out, const char *folder, int fresh, Err *err)
{
    return open_part(out, folder, fresh, RUN_ENDED, err);
}

Status store_open_run(RunStore **out, const char *folder, Err *err)
{
    char path[PATH_MAX];
    *out = NULL;
    if (!run_path(folder, path, sizeof path))
        return fail(err, STATUS_MISSING, "%.200s: holds no run: run.sqlite is not there", folder);
    return open_part(out, folder, 0, RUN_WHOLE, err);
}

/* The journal goes first: left alone it would be taken for that of the next database. */
Status store_forget_empty(RunStore *store, Err *err)
{
    static const char *const NAMES[] = {"run.sqlite-wal", "run.sqlite-shm", "run.sqlite-journal", "run.sqlite"};
    char path[PATH_MAX];
    if (!store->has_run || store->run.table.n > 0 || store->run.n_generations > 0)
        return STATUS_OK;
    database_close(store->db);
    run_free(&store->run);
    store->db = NULL;
    store->has_run = 0;
    for (size_t i = 0; i < sizeof NAMES / sizeof NAMES[0]; i++) {
        folder_path(&store->folder, NAMES[i], path);
        if (unlink(path) != 0 && errno != ENOENT)
            return fail(err, STATUS_IO, "%s: cannot be removed: %s", path, strerror(errno));
    }
    return STATUS_OK;
}

static void put_settings(FILE *f, const void *settings)
{
    settings_write(settings, f, 0);
}

static void put_line(FILE *f, const void *text)
{
    fprintf(f, "%s\n", (const char *)text);
}

static Status write_origin(const RunStore *store, const Settings *used, const char *provenance, Err *err)
{
    TRY(folder_write(&store->folder, "settings.ini", put_settings, used, err));
    return folder_write(&store->folder, "provenance.json", put_line, provenance, err);
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
    TRY(write_origin(store, used, provenance, err));
    TRY(csv_files_begin(&store->files, &store->folder, schema, err));
    return logs_open(&store->logs, &store->folder, err);
}

/* Where the search stands: the designs of its finished generations, and which of them were on its front. */
static Status take_up(RunStore *store, Err *err)
{
    const Run *run = &store->run;
    store->n_known = run_n_finished(run);
    store->was_on_front = calloc(store->n_known + 1, 1);
    if (!store->was_on_front)
        return fail(err, STATUS_NO_MEMORY, "no memory for %zu designs", store->n_known);
    for (size_t i = 0; i < store->n_known; i++) {
        store->was_on_front[i] = run->place[i].entered != NEVER && run->place[i].left == NEVER;
        if (store->was_on_front[i])
            store->front ^= digest_member(i < run->n_ahead ? (long)i + 1 : run->table.row[i - run->n_ahead].id);
    }
    return STATUS_OK;
}

static Status begin(RunStore *store, Err *err)
{
    if (store->in_transaction)
        return STATUS_OK;
    TRY(database_do(store->db, err, "BEGIN IMMEDIATE", ""));
    store->in_transaction = 1;
    return STATUS_OK;
}

/* At once: with the new limits alone a run that is killed before its next session would be finished for good. */
static Status set_settings(RunStore *store, const Settings *used, int goes_on, Err *err)
{
    TRY(begin(store, err));
    Status status = tables_set_settings(store->db, used, &store->run, err);
    if (status == STATUS_OK && goes_on)
        status = database_do(store->db, err, "UPDATE session SET is_final = 0 WHERE is_final", "");
    if (status == STATUS_OK)
        status = database_do(store->db, err, "COMMIT", "");
    if (status != STATUS_OK)
        database_do(store->db, NULL, "ROLLBACK", "");
    store->in_transaction = 0;
    return status;
}

Status store_resume(RunStore *store, const Schema *schema, const Settings *used, int goes_on, Err *err)
{
    take_schema(store, schema);
    TRY(take_up(store, err));
    if (store->run.n_ahead == 0)
        TRY(tables_upgrade(store->db, &store->run.table, err));
    TRY(set_settings(store, used, goes_on, err));
    TRY(write_origin(store, used, store->run.provenance, err));
    TRY(csv_files_resume(&store->files, &store->folder, schema, &store->run, err));
    return logs_open(&store->logs, &store->folder, err);
}

static Status take_long(sqlite3_stmt *row, void *user, Err *err)
{
    (void)err;
    *(long *)user = (long)sqlite3_column_int64(row, 0);
    return STATUS_OK;
}

Status store_session(RunStore *store, const char *program, int threads, size_t n_simulated, Err *err)
{
    char started[24], host[65] = "";
    utc_now(started);
    gethostname(host, sizeof host - 1);
    TRY(database_do(store->db, err,
                    "INSERT INTO session(started, host, pid, program, threads, simulated_before, seconds, is_final) "
                    "VALUES (?, ?, ?, ?, ?, ?, 0, 0)",
                    "ttitii", started, host, (long)getpid(), program, (long)threads, (long)n_simulated));
    store->last_commit = clock_seconds();
    return database_each(store->db, "SELECT last_insert_rowid()", take_long, &store->session, err);
}

typedef struct {
    RunStore *store;
    EvaluationFn take;
    void *user;
    size_t n;
    CsvPassing files;
} Each;

static Status take_finished(const Evaluation *e, void *user, Err *err)
{
    Each *each = user;
    if (e->id != (long)++each->n || e->kind == KIND_UNFINISHED)
        return fail(err, STATUS_IO, "%s: is damaged: evaluation %zu is missing", database_path(each->store->db),
                    each->n);
    csv_files_pass_design(&each->store->files, &each->files, e->id);
    results_take(&each->store->passed, e);
    return each->take(e, each->user, err);
}

Status store_each_finished(RunStore *store, EvaluationFn take, void *user, Err *err)
{
    const size_t n = store->run.n_ahead;
    EvaluationTable room = store->waiting;
    Each each = {.store = store, .take = take, .user = user};
    csv_files_pass(&store->files, &each.files);
    results_begin(&store->passed, n, room.n_obj);
    room = evaluation_table(room.n_var, room.n_obj, room.n_extra);
    Status status = rows_each(store->db, &room, 1, (long)n, &each.files.lines, take_finished, &each, err);
    if (status == STATUS_OK && each.n < n)
        status = fail(err, STATUS_IO, "%s: is damaged: evaluation %zu is missing", database_path(store->db), n);
    evaluation_table_free(&room);
    status = csv_files_passed(&store->files, &each.files, store->db, status, err);
    if (status != STATUS_OK)
        results_free(&store->passed);
    return folder_advise(store_folder(store), status, err);
}

/* -- simulations --------------------------------------------------------------------------------------------------- */

static Status insert(RunStore *store, const Evaluation *e, Err *err)
{
    const Schema *s = store->schema;
    return rows_insert(store->db, (RowShape){s->n_var, s->n_obj, s->n_extra}, e, err);
}

static Status insert_waiting(RunStore *store, Err *err)
{
    for (size_t i = 0; i < store->waiting.n; i++)
        TRY(insert(store, &store->waiting.row[i], err));
    return STATUS_OK;
}

Status store_flush(RunStore *store, Err *err)
{
    if (store->waiting.n > 0)
        TRY(begin(store, err));
    if (!store->in_transaction)
        return STATUS_OK;
    TRY(insert_waiting(store, err));
    TRY(database_do(store->db, err, "COMMIT", ""));
    store->waiting.n = 0;
    store->in_transaction = 0;
    store->last_commit = clock_seconds();
    return store->files.evaluations.stream ? csv_files_append(&store->files, store->db, store->n_known, err)
                                           : STATUS_OK;
}

Status store_evaluation(RunStore *store, const Evaluation *e, Err *err)
{
    TRY(evaluation_table_append(&store->waiting, e, err));
    if (e->seconds >= COMMIT_S || clock_seconds() >= store->last_commit + COMMIT_S)
        TRY(store_flush(store, err));
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
            status = rows_finish(store->db, (long)i + 1, (EvaluationKind)v->kind[i], (long)v->generation[i], err);
    free(waited);
    if (status != STATUS_OK || v->is_asynchronous)
        return status;
    /* what another program or machine had asked for in this generation before it was cut short */
    return database_do(store->db, err, "DELETE FROM evaluation WHERE kind IS NULL AND id > ?", "i", (long)v->n);
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
        if (v->on_front[i] && !flags[i])
            TRY(database_do(store->db, err,
                            "INSERT INTO front(evaluation, entered) VALUES (?, ?) ON CONFLICT(evaluation) DO UPDATE "
                            "SET left = NULL",
                            "ii", (long)i + 1, (long)v->generation_now));
        if (!v->on_front[i] && flags[i])
            TRY(database_do(store->db, err, "UPDATE front SET left = ? WHERE evaluation = ?", "ii",
                            (long)v->generation_now, (long)i + 1));
        if (v->on_front[i] != flags[i])
            store->front ^= digest_member((long)i + 1);
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
                       .predicted = (long)v->n_predicted,
                       .surrogate_error = v->surrogate_error,
                       .hypervolume = store_hypervolume(store),
                       .seconds = seconds};
    utc_now(g.finished);
    return database_do(store->db, err,
                       "INSERT INTO generation(number, simulated, failed, front, predicted, surrogate_error, "
                       "hypervolume, seconds, finished, digest) VALUES (?, ?, ?, ?, ?, ?, ?, ?, ?, ?)",
                       "iiiiidddti", g.number, g.simulated, g.failed, g.front, g.predicted, g.surrogate_error,
                       g.hypervolume, g.seconds, g.finished, run_generation_digest(&g));
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

static Status store_effort(RunStore *store, const SearchView *v, double session, Err *err)
{
    return database_do(store->db, err,
                       "UPDATE session SET seconds = ?, search = ?, waited = ?, surrogate = ? WHERE number = ?",
                       "ddddi", session, v->seconds, v->waited_s, v->surrogate_s, store->session);
}

static Status put_generation(RunStore *store, const SearchView *v, double seconds, double session, Err *err)
{
    if (!v->state)
        return fail(err, STATUS_NO_MEMORY, "no memory for the state of the search");
    TRY(store_rows(store, v, err));
    TRY(store_front_changes(store, v, err));
    TRY(store_moment(store, v, seconds, err));
    TRY(store_effort(store, v, session, err));
    return store_state(store, v, err);
}

/* All of it or nothing: half a generation beside the state of the one before could not be resumed. Simulations that wait
 * for the next commit are not lost with it. */
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
    database_do(store->db, NULL, "ROLLBACK TO generation; RELEASE generation", "");
    for (size_t i = 0; i < store->waiting.n; i++)
        store->waiting.row[i].kind = KIND_UNFINISHED;
    return status;
}

/* Generations that take a moment are committed together, COMMIT_S after the last commit: a commit waits for the disk. */
static int is_due(RunStore *store, const SearchView *v)
{
    const double now = clock_seconds(), before = store->last_generation;
    store->last_generation = now;
    return v->is_last || now >= store->last_commit + COMMIT_S || now >= before + GENERATION_S;
}

Status store_generation(RunStore *store, const SearchView *v, double seconds, double session, Err *err)
{
    TRY(front_share_follow(&store->share, v, err));
    TRY(put_whole_generation(store, v, seconds, session, err));
    store->files.is_behind = 1;
    if (!is_due(store, v))
        return STATUS_OK;
    TRY(store_flush(store, err));
    TRY(database_check_place(store->db, err));
    return csv_files_front(&store->files, v, err);
}

/* -- back to the generation before --------------------------------------------------------------------------------- */

/* What is known of later generations is taken out again, their evaluations stay. A design that left the front, came back
 * in one of them and is taken off again by the next one has lost its first leaving: its digest is not known. */
static Status step_back(RunStore *store, Err *err)
{
    const Run *run = &store->run;
    const long last = run->state_generation;
    for (size_t i = 0; i < run->table.n; i++) {
        const Evaluation *e = &run->table.row[i];
        if (e->kind != KIND_POLISHED && e->kind != KIND_UNFINISHED && e->generation > last)
            TRY(rows_unfinish(store->db, e->id, e->kind, e->generation, err));
    }
    TRY(database_do(store->db, err, "DELETE FROM front WHERE entered > ?", "i", last));
    TRY(database_do(store->db, err, "UPDATE front SET left = NULL WHERE left > ?", "i", last));
    TRY(database_do(store->db, err, "DELETE FROM generation WHERE number > ?", "i", last));
    TRY(database_do(store->db, err, "DELETE FROM state WHERE generation > ?", "i", last));
    return database_do(store->db, err, "UPDATE state SET front = NULL", "");
}

Status store_step_back(RunStore *store, Err *err)
{
    Run *run = &store->run;
    TRY(begin(store, err));
    Status status = step_back(store, err);
    if (status == STATUS_OK)
        status = store_flush(store, err);
    else
        database_do(store->db, NULL, "ROLLBACK", "");
    store->in_transaction = 0;
    TRY(status);
    run_free(run);
    return run_load(run, store->db, store_folder(store), err);
}

/* -- logs and the end ---------------------------------------------------------------------------------------------- */

Status store_log(RunStore *store, Err *err, const char *format, ...)
{
    va_list args;
    va_start(args, format);
    const Status status = logs_say(&store->logs, format, args, err);
    va_end(args);
    return status;
}

Status store_event(RunStore *store, json_t *event, Err *err)
{
    return logs_event(&store->logs, event, err);
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

/* What the files are written from, or what is said of a run, in the place of the run as it was before. Of one without a
 * front the designs that come nearest are written too. */
static Status read_at_the_end(RunStore *store, Run *run, Err *err)
{
    const int is_written = store->has_polished || store->files.is_behind;
    run_free(&store->run);
    TRY(is_written ? run_load(run, store->db, store_folder(store), err)
                   : run_review(run, store->db, store_folder(store), &store->passed, err));
    results_free(&store->passed);
    if (run->n_front == 0 && run->table.n_var == 0) {
        run_free(run);
        TRY(run_load(run, store->db, store_folder(store), err));
    }
    return is_written ? csv_files_replace(&store->folder, run, err) : STATUS_OK;
}

Status store_close(RunStore *store, const char *stopped, int is_final, double session, Run *run, Err *err)
{
    Run unwanted = {0}, *last = run ? run : &unwanted;
    Status status = end_session(store, stopped, is_final, session, err);
    if (status == STATUS_OK && (run || store->has_polished || store->files.is_behind))
        status = read_at_the_end(store, last, err);
    if (status == STATUS_OK)
        status = csv_files_close(&store->files, err);
    if (status == STATUS_OK)
        status = logs_close(&store->logs, err);
    store_free(store);
    run_free(&unwanted);
    if (status != STATUS_OK && run)
        run_free(run);
    return status;
}

void store_free(RunStore *store)
{
    if (!store)
        return;
    csv_files_free(&store->files);
    logs_free(&store->logs);
    database_close(store->db);
    run_free(&store->run);
    free(store->was_on_front);
    evaluation_table_free(&store->waiting);
    front_share_free(&store->share);
    results_free(&store->passed);
    folder_release(&store->folder);
    free(store);
}

/* -- designs from outside ------------------------------------------------------------------------------------------ */

/* Behind the polished ones that are there, as of the last generation. */
static Status insert_polished(RunStore *store, const Evaluation *design, long *id, Err *err)
{
    double last, generation, planned;
    Evaluation e = *design;
    TRY(database_number(store->db, "SELECT max(id) FROM evaluation", 0, &last, err));
    TRY(database_number(store->db, "SELECT max(number) FROM generation", 0, &generation, err));
    TRY(database_number(store->db, "SELECT planned_evals FROM run", 0, &planned, err));
    const long first = planned < POLISHED_FIRST ? POLISHED_FIRST : POLISHED_FIRST_OF_MANY;
    *id = e.id = last >= (double)first ? (long)last + 1 : first;
    e.generation = (long)generation;
    e.kind = KIND_POLISHED;
    return insert(store, &e, err);
}

Status store_read(RunStore *store, Run *run, Err *err)
{
    TRY(store_flush(store, err));
    return run_load(run, store->db, store_folder(store), err);
}

Status store_polished(RunStore *store, const Evaluation *better, size_t n_tried, size_t n_simulated, Err *err)
{
    long id;
    TRY(begin(store, err));
    if (better) {
        TRY(insert_polished(store, better, &id, err));
        store->has_polished = 1;
    }
    TRY(database_do(store->db, err, "UPDATE run SET tried_to_polish = ?, polished_at = ?", "ii", (long)n_tried,
                    (long)n_simulated));
    return store_flush(store, err);
}

Status store_add_evaluations(RunStore *store, size_t n, const Evaluation designs[], long *first_id, Err *err)
{
    Run now;
    long id = 0;
    store->schema = &store->run.schema;
    TRY(tables_upgrade(store->db, &store->run.table, err));
    TRY(begin(store, err));
    for (size_t i = 0; i < n; i++) {
        TRY(insert_polished(store, &designs[i], &id, err));
        if (first_id && i == 0)
            *first_id = id;
    }
    TRY(store_read(store, &now, err));
    const Status status = csv_files_replace(&store->folder, &now, err);
    run_free(&now);
    return status;
}
