#include "store/store.h"

#include <errno.h>
#include <limits.h>
#include <pthread.h>
#include <time.h>
#include <unistd.h>

#include "base/clock.h"
#include "base/hypervolume.h"
#include "base/json.h"
#include "settings/settings.h"
#include "store/export.h"
#include "store/folder.h"
#include "store/output.h"
#include "store/run_read.h"
#include "store/tables.h"

struct RunStore {
    Folder folder;
    const Schema *schema; /* of the session, or before it of the run as it is stored */
    Database *db;
    RowColumns columns[N_ROW_TABLES]; /* of its tables; without places: not asked for yet */
    Run run;                          /* that the folder held when it was opened; {0}: none */
    EvaluationTable unfinished;       /* of it */
    long *polished;                   /* (n_polished) ids of it, ascending */
    size_t n_polished;

    size_t n_stored;             /* evaluations of the search */
    int is_lost;                 /* a transaction was rolled back: nothing more is written */
    size_t n_known;              /* designs of finished generations */
    unsigned char *was_on_front; /* (n_known) at the end of the last generation */
    uint64_t front;              /* digest of those on it */
    Hypervolume *hypervolume;    /* that the front dominates; NULL: the sample is not complete */
    size_t n_measured;           /* designs that it has seen */
    RunSession session;
    int is_ready; /* for a session: what happens is written down */

    pthread_mutex_t writing; /* held by who uses the database, while a session may commit beside */
    pthread_mutex_t lock;    /* of what follows, held for a moment alone */
    pthread_cond_t news;     /* for the thread that commits */
    pthread_t committing;
    int has_thread;          /* 0: it ends */
    EvaluationTable waiting; /* to be inserted */
    int is_open;             /* there is something to commit */
    double last_commit;      /* [s] of the clock */
    Status status;           /* of the thread */
    Err why;
};

const char *store_folder(const RunStore *store)
{
    return store->folder.path;
}

const Run *store_run(const RunStore *store)
{
    return store->run.settings ? &store->run : NULL;
}

const EvaluationTable *store_unfinished(const RunStore *store)
{
    return &store->unfinished;
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
    folder_path(store_folder(store), "run.sqlite", path);
    return database_open(&store->db, path, DATABASE_WRITE, err);
}

/* An unfinished evaluation belongs to no later generation than the one that was cut short; others are left of a
 * transaction that was lost. */
static Status take_open_row(const Evaluation *e, void *user, Err *err)
{
    RunStore *store = user;
    const Run *run = &store->run;
    const long cut_short = run->n_generations > 0 ? run->generation[run->n_generations - 1].number + 1 : 0;
    store->n_stored += e->kind == KIND_UNFINISHED;
    if (e->kind == KIND_UNFINISHED && e->generation <= cut_short) {
        TRY(evaluation_table_append(&store->unfinished, e, err));
        store->unfinished.row[store->unfinished.n - 1].id = number_of(store, e->id);
    }
    if (!kind_is_outside(e->kind))
        return STATUS_OK;
    long *wider = realloc(store->polished, (store->n_polished + 1) * sizeof *wider);
    if (!wider)
        return fail_memory(err, store->n_polished + 1, "designs");
    store->polished = wider;
    wider[store->n_polished++] = e->id;
    return STATUS_OK;
}

/* The run that is there, with what a session needs of it: not the rows of finished generations, which pass by when the
 * search is resumed. */
static Status load_run(RunStore *store, Err *err)
{
    Run *run = &store->run;
    const Schema *s = store->schema = &run->schema;
    TRY(open_database(store, err));
    TRY(run_load(run, store->db, store_folder(store), RUN_HEAD, err));
    database_grow(store->db);
    store->unfinished = evaluation_table(s->n_var, s->n_obj, s->n_extra);
    store->n_known = store->n_stored = run->n_finished;
    TRY(rows_each(store->db, ROWS_EVALUATION, s, "kind IS NULL OR kind IN ('polished', 'kept')", take_open_row, store,
                  err));
    TRY_ROOM(store->was_on_front, store->n_known + 1, "designs", err);
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

Status store_open(RunStore **out, const char *folder, int fresh, Err *err)
{
    *out = NULL;
    RunStore *store;
    TRY_ROOM(store, 1, "a run", err);
    pthread_condattr_t clock;
    pthread_condattr_init(&clock);
    pthread_condattr_setclock(&clock, CLOCK_MONOTONIC);
    pthread_cond_init(&store->news, &clock);
    pthread_mutex_init(&store->writing, NULL);
    pthread_mutex_init(&store->lock, NULL);
    pthread_condattr_destroy(&clock);
    Status status = folder_take(&store->folder, folder, fresh, err);
    if (status == STATUS_OK && folder_has(store_folder(store), "run.sqlite"))
        status = folder_advise(store_folder(store), load_run(store, err), err);
    /* Nothing tells a journal that was lost from one that was never there but the number beside it. */
    if (status == STATUS_OK && store->folder.n_stored > store->n_stored)
        status =
            fail(err, STATUS_IO,
                 "%s: %zu evaluations were stored, as its file `lock` says; run.sqlite %s%zu: %s is missing. Put "
                 "it back; to "
                 "go on without those evaluations remove `lock`; for another run: --new",
                 store_folder(store), store->folder.n_stored, store->run.settings ? "has " : "is not there, ",
                 store->n_stored, store->run.settings ? "its journal run.sqlite-wal, or part of it," : "the database");
    if (status == STATUS_OK)
        *out = store;
    else
        store_free(store);
    return status;
}

/* The journal goes first: left alone it would be taken for that of the next database. */
Status store_forget_empty(RunStore *store, Err *err)
{
    char path[PATH_MAX];
    if (!store->run.settings || store->n_stored > 0 || store->n_polished > 0 || store->run.n_generations > 0)
        return STATUS_OK;
    database_close(store->db);
    run_free(&store->run);
    store->db = NULL;
    folder_path(store_folder(store), "run.sqlite", path);
    database_remove_journal(path);
    return unlink(path) == 0 || errno == ENOENT ? STATUS_OK : fail_errno(err, path, "cannot be removed");
}

static Status write_provenance(const RunStore *store, const char *provenance, Err *err)
{
    char path[PATH_MAX];
    Output o;
    folder_path(store_folder(store), "provenance.json", path);
    TRY(output_open_inside(&o, path, err));
    fprintf(o.stream, "%s\n", provenance);
    return output_close(&o, err);
}

/* Ready for a session: settings and provenance stand beside the database, and the log can be written to. */
static Status make_ready(RunStore *store, const Settings *used, const char *provenance, Err *err)
{
    const Schema *schema = store->schema;
    char path[PATH_MAX];
    Output o;
    store->waiting = evaluation_table(schema->n_var, schema->n_obj, schema->n_extra);
    folder_note(&store->folder, store->n_stored);
    folder_path(store_folder(store), "settings.ini", path);
    TRY(output_open_inside(&o, path, err));
    settings_write(used, o.stream, SETTINGS_PLAIN, NULL);
    TRY(output_close(&o, err));
    TRY(write_provenance(store, provenance, err));
    TRY(folder_log(store_folder(store), "", err));
    store->is_ready = 1;
    return STATUS_OK;
}

Status store_begin(RunStore *store, const Schema *schema, const Settings *used, const char *provenance, Err *err)
{
    char path[PATH_MAX];
    store->schema = schema;
    folder_path(store_folder(store), "run.sqlite", path);
    TRY(tables_create(path, schema, used, provenance, err));
    TRY(open_database(store, err));
    database_grow(store->db);
    return make_ready(store, used, provenance, err);
}

/* -- transactions -------------------------------------------------------------------------------------------------- */

/* Whether there is something to commit, told to the thread that does. */
static void set_open(RunStore *store, int is_open)
{
    pthread_mutex_lock(&store->lock);
    store->is_open = is_open;
    if (!is_open)
        store->last_commit = clock_seconds();
    pthread_cond_signal(&store->news);
    pthread_mutex_unlock(&store->lock);
}

/* A transaction, unless one is open already. */
static Status begin(RunStore *store, Err *err)
{
    if (store->is_lost)
        return fail(err, STATUS_IO, "%s: nothing more is written after a fault", database_path(store->db));
    if (database_in_transaction(store->db))
        return STATUS_OK;
    const Status status = database_begin(store->db, err);
    store->is_lost = status != STATUS_OK;
    set_open(store, status == STATUS_OK);
    return status;
}

/* What is not committed cannot be: rows that came later would stand behind a gap. */
static Status lose(RunStore *store, Status status)
{
    if (database_in_transaction(store->db))
        database_do(store->db, NULL, "ROLLBACK", "");
    store->is_lost = 1;
    set_open(store, 0);
    return status;
}

static Status commit(RunStore *store, Status status, Err *err)
{
    THEN(status, database_do(store->db, err, "COMMIT", ""));
    if (status != STATUS_OK)
        return lose(store, status);
    set_open(store, 0);
    return STATUS_OK;
}

static Status insert_row(RunStore *store, RunTable table, const Evaluation *e, Err *err)
{
    RowColumns *columns = &store->columns[table];
    if (!columns->place)
        TRY(tables_columns(store->db, table, store->schema, columns, err));
    return rows_insert(store->db, columns, store->schema, e, err);
}

static Status insert(RunStore *store, const Evaluation *e, Err *err)
{
    Evaluation row = *e;
    row.id = id_of(store, e->id - 1);
    return insert_row(store, ROWS_EVALUATION, &row, err);
}

/* Before anything else is written. */
static Status insert_waiting(RunStore *store, Err *err)
{
    pthread_mutex_lock(&store->lock);
    EvaluationTable rows = store->waiting;
    Status status = store->status;
    *err = store->why;
    store->waiting = evaluation_table(rows.n_var, rows.n_obj, rows.n_extra);
    pthread_mutex_unlock(&store->lock);
    if (rows.n > 0)
        THEN(status, begin(store, err));
    for (size_t i = 0; i < rows.n && status == STATUS_OK; i++) {
        status = insert(store, &rows.row[i], err);
        store->n_stored += status == STATUS_OK;
    }
    evaluation_table_free(&rows);
    return status == STATUS_OK || database_in_transaction(store->db) ? status : lose(store, status);
}

/* Also where what waits cannot be written any more. */
static Status flush(RunStore *store, Err *err)
{
    const Status status = insert_waiting(store, err);
    if (store->is_lost || !store->db || !database_in_transaction(store->db))
        return status;
    TRY(commit(store, STATUS_OK, status == STATUS_OK ? err : NULL));
    folder_note(&store->folder, store->n_stored);
    return status;
}

/* Then the file should still be in its place: rows that went into one that is gone would be counted as stored. */
static Status flush_and_look(RunStore *store, Err *err)
{
    Status status = flush(store, err);
    if (status == STATUS_OK && store->is_ready && (status = database_check_place(store->db, err)) != STATUS_OK)
        lose(store, status);
    pthread_mutex_lock(&store->lock);
    store->status = status;
    store->why = *err;
    pthread_mutex_unlock(&store->lock);
    return status;
}

/* COMMIT_S after the last one: a commit waits for the disk, and nobody who simulates should. */
static void *commit_in_time(void *user)
{
    RunStore *store = user;
    pthread_mutex_lock(&store->lock);
    while (store->has_thread) {
        const double due = store->last_commit + COMMIT_S;
        const struct timespec at = {(time_t)due, (long)(1e9 * (due - floor(due)))};
        Err why;
        if (store->status != STATUS_OK || (!store->is_open && store->waiting.n == 0)) {
            pthread_cond_wait(&store->news, &store->lock);
        } else if (clock_seconds() < due) {
            pthread_cond_timedwait(&store->news, &store->lock, &at);
        } else {
            pthread_mutex_unlock(&store->lock);
            pthread_mutex_lock(&store->writing);
            flush_and_look(store, &why);
            pthread_mutex_unlock(&store->writing);
            pthread_mutex_lock(&store->lock);
        }
    }
    pthread_mutex_unlock(&store->lock);
    return NULL;
}

Status store_flush(RunStore *store, Err *err)
{
    pthread_mutex_lock(&store->lock);
    const int had_thread = store->has_thread;
    store->has_thread = 0;
    pthread_cond_signal(&store->news);
    pthread_mutex_unlock(&store->lock);
    if (had_thread)
        pthread_join(store->committing, NULL);
    return flush_and_look(store, err);
}

/* -- a session ----------------------------------------------------------------------------------------------------- */

/* At once: with the new limits alone a run that is killed before its next session would be finished for good. What
 * take_open_row has left out goes. */
Status store_resume(RunStore *store, const Schema *schema, const Settings *used, int goes_on, Err *err)
{
    const EvaluationTable *unfinished = &store->unfinished;
    store->schema = schema;
    TRY(begin(store, err));
    Status status =
        database_do(store->db, err, "DELETE FROM evaluation WHERE kind IS NULL AND id > ?", "i", store->run.n_finished);
    for (size_t i = 0; i < unfinished->n; i++)
        THEN(status, insert(store, &unfinished->row[i], err));
    THEN(status, tables_set_settings(store->db, used, &store->run, err));
    if (goes_on)
        THEN(status,
             database_do(store->db, err, "UPDATE session SET is_final = 0 WHERE is_final; DELETE FROM finer", ""));
    TRY(commit(store, status, err));
    store->n_stored = store->run.n_finished + unfinished->n;
    return make_ready(store, used, store->run.provenance, err);
}

static Status put_session(RunStore *store, Err *err)
{
    TRY(begin(store, err));
    return record_put(store->db, TABLE_SESSION, &store->session, err);
}

Status store_session(RunStore *store, const char *program, int threads, size_t n_simulated, Err *err)
{
    RunSession *s = &store->session;
    const size_t n = store->run.n_sessions;
    *s = (RunSession){.number = n > 0 ? store->run.session[n - 1].number + 1 : 1,
                      .pid = getpid(),
                      .threads = threads,
                      .simulated_before = n_simulated,
                      .search_s = NAN,
                      .waited_s = NAN,
                      .surrogate_s = NAN};
    utc_now(s->started);
    gethostname(s->host, sizeof s->host - 1);
    text_copy(s->program, program);
    TRY(put_session(store, err));
    TRY(flush(store, err));
    store->has_thread = 1;
    if (pthread_create(&store->committing, NULL, commit_in_time, store) == 0)
        return STATUS_OK;
    store->has_thread = 0;
    return fail(err, STATUS_NO_MEMORY, "no thread for the commits of a run");
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
    Status status = rows_each(store->db, ROWS_EVALUATION, store->schema,
                              "kind IS NOT NULL AND kind NOT IN ('polished', 'kept')", take_finished, &each, err);
    if (status == STATUS_OK && each.n != store->run.n_finished)
        status = missing(store, each.n, err);
    return folder_advise(store_folder(store), status, err);
}

Status store_evaluation(RunStore *store, const Evaluation *e, Err *err)
{
    pthread_mutex_lock(&store->lock);
    const size_t n = store->waiting.n;
    Status status = store->status;
    *err = store->why;
    THEN(status, evaluation_table_append(&store->waiting, e, err));
    if (status != STATUS_OK)
        store->waiting.n = n; /* without half a row */
    pthread_cond_signal(&store->news);
    pthread_mutex_unlock(&store->lock);
    return status;
}

/* -- the hypervolume of a run: the share of a box that its front dominates ----------------------------------------- */

/* The box is about the first designs that succeeded and their generation, once one of the next says that all of it are
 * there: from a fifth of their range below the best to the worst. Only designs on the front count: one that an earlier
 * one dominates adds nothing. Where repeats move designs and take them off the front, all of it is measured again. */
static Status measure_front(RunStore *store, const Archive *a, int is_last, Err *err)
{
    double lower[OBJECTIVES_MAX], reference[OBJECTIVES_MAX];
    if (a->n_replicates > 0) {
        hypervolume_free(store->hypervolume);
        store->hypervolume = NULL;
        store->n_measured = 0;
    }
    if (!store->hypervolume) {
        size_t first = 0, end;
        while (first < a->n && !a->ok[first])
            first++;
        for (end = first; end < a->n && a->generation[end] == a->generation[first];)
            end++;
        if (first == a->n || (end == a->n && !is_last))
            return STATUS_OK;
        for (size_t k = 0; k < a->n_obj; k++) {
            lower[k] = reference[k] = a->Y[first * a->n_obj + k];
            for (size_t i = first; i < end; i++)
                if (a->ok[i]) {
                    lower[k] = fmin(lower[k], a->Y[i * a->n_obj + k]);
                    reference[k] = fmax(reference[k], a->Y[i * a->n_obj + k]);
                }
        }
        hypervolume_box(a->n_obj, lower, reference);
        TRY(hypervolume_create(&store->hypervolume, a->n_obj, lower, reference, 1, err));
    }
    /* Later designs dominate more: fewer samples are left for the others. */
    for (size_t i = a->n; i-- > store->n_measured;)
        if (a->on_front[i])
            hypervolume_add(store->hypervolume, a->F + i * a->n_obj);
    store->n_measured = a->n;
    return STATUS_OK;
}

/* -- generations --------------------------------------------------------------------------------------------------- */

/* Designs that have come onto the front or left it since the last generation. */
static Status store_front_changes(RunStore *store, const SearchView *v, Err *err)
{
    enum { BLOCK = 64 };
    static const char ENTERED[] = "INSERT INTO front(evaluation, entered) VALUES (?, ?) ON CONFLICT(evaluation) DO "
                                  "UPDATE SET left = NULL",
                      LEFT[] = "UPDATE front SET left = ?2 WHERE evaluation = ?1";
    const Archive *a = v->all;
    unsigned char *flags = realloc(store->was_on_front, a->n + 1);
    if (!flags)
        return fail_memory(err, a->n, "designs");
    store->was_on_front = flags;
    memset(flags + store->n_known, 0, a->n - store->n_known);
    store->n_known = a->n;
    for (size_t i = 0; i < a->n; i++) {
        if (i % BLOCK == 0 && i + BLOCK <= a->n && memcmp(a->on_front + i, flags + i, BLOCK) == 0) {
            i += BLOCK - 1; /* nothing has changed here */
            continue;
        }
        if (a->on_front[i] == flags[i])
            continue;
        flags[i] = a->on_front[i];
        store->front ^= digest_member(id_of(store, i));
        TRY(database_do(store->db, err, flags[i] ? ENTERED : LEFT, "ii", id_of(store, i), v->generation));
    }
    return STATUS_OK;
}

/* All that a generation changes: kinds of its rows, front, record, session, state of the search. */
static Status put_generation(RunStore *store, const SearchView *v, double seconds, Err *err)
{
    const Archive *a = v->all;
    const long last = a->n > 0 ? id_of(store, a->n - 1) : 0;
    char count[96];
    double behind;
    if (!v->state)
        return fail_memory(err, 1, "the state of the search");

    /* Rows that have entered get kind and generation. Behind the last step what another program or machine had asked
     * for before it was cut short is left over; before, it is told or replaced, and counted anew. */
    for (size_t i = store->n_known; i < a->n; i++)
        TRY(rows_finish(store->db, id_of(store, i), a->kind[i], a->generation[i], err));
    if (v->reason != STOP_NONE)
        TRY(database_do(store->db, err, "DELETE FROM evaluation WHERE kind IS NULL AND id > ?", "i", last));
    snprintf(count, sizeof count, "SELECT count(*) FROM evaluation WHERE kind IS NULL AND id > %ld", last);
    TRY(database_number(store->db, count, &behind, err));
    store->n_stored = a->n + (size_t)behind;

    /* The front; what the search named before is another front's. */
    TRY(store_front_changes(store, v, err));
    TRY(database_do(store->db, err, "DELETE FROM finer", ""));
    RunGeneration g = {.number = v->generation,
                       .simulated = a->n,
                       .failed = a->n_failed,
                       .front = a->n_front,
                       .surrogate_error = v->surrogate_error,
                       .hypervolume = store_hypervolume(store),
                       .seconds = seconds,
                       .members = store->front};
    utc_now(g.finished);
    TRY(record_put(store->db, TABLE_GENERATION, &g, err));
    TRY(put_session(store, err));

    /* The state of the search, twice: one that the disk has damaged gives way to its copy. */
    for (long copy = 1; copy <= 2; copy++)
        TRY(database_do(store->db, err, "INSERT OR REPLACE INTO state VALUES (?, ?, ?, ?)", "iibi", copy, g.number,
                        v->state, v->n_state, state_digest(g.number, v->state, v->n_state)));
    return STATUS_OK;
}

/* All of it or nothing: half a generation beside the state of the one before could not be resumed. Simulations that
 * wait for the next commit are not lost with it, unless SQLite has rolled back more than this generation. */
Status store_generation(RunStore *store, const SearchView *v, const SessionTimes *s, Err *err)
{
    TRY(measure_front(store, v->all, v->reason != STOP_NONE, err));
    pthread_mutex_lock(&store->writing);
    store->session.seconds = s->session;
    store->session.search_s = s->search;
    store->session.waited_s = s->waiting;
    store->session.surrogate_s = s->choosing;
    Status status = insert_waiting(store, err);
    THEN(status, begin(store, err));
    THEN(status, database_do(store->db, err, "SAVEPOINT generation", ""));
    if (status == STATUS_OK) {
        status = put_generation(store, v, s->run, err);
        THEN(status, database_do(store->db, err, "RELEASE generation", ""));
        if (status != STATUS_OK &&
            (!database_in_transaction(store->db) ||
             database_do(store->db, NULL, "ROLLBACK TO generation; RELEASE generation", "") != STATUS_OK))
            lose(store, status);
    }
    if (v->reason != STOP_NONE)
        THEN(status, flush_and_look(store, err));
    pthread_mutex_unlock(&store->writing);
    return status;
}

/* -- logs and the end ---------------------------------------------------------------------------------------------- */

Status store_event(RunStore *store, json_t *event, Err *err)
{
    char time[24], *line;
    utc_now(time);
    char *words = json_dumps(json_put(event, "time=%s", time), JSON_SORT_KEYS);
    json_decref(event);
    const int n = asprintf(&line, "%s\n", words);
    free(words);
    if (n < 0)
        return fail_memory(err, 1, "a line of log.jsonl");
    const Status status = store->is_ready ? folder_log(store_folder(store), line, err) : STATUS_OK;
    free(line);
    return status;
}

Status store_read(RunStore *store, RunParts parts, Run *run, Err *err)
{
    TRY(store_flush(store, err));
    return folder_advise(store_folder(store), run_load(run, store->db, store_folder(store), parts, err), err);
}

Status store_write_front(RunStore *store, Run *run, Err *err)
{
    TRY(store_read(store, RUN_FRONT, run, err));
    const Status status = export_inside(run, EXPORT_FRONT, run->n_front, run->front, err);
    if (status != STATUS_OK)
        run_free(run);
    return status;
}

Status store_close(RunStore *store, const char *stopped, int is_final, double session, Run *run, Err *err)
{
    RunSession *s = &store->session;
    Run last = {0};
    Status status = store_flush(store, err);
    utc_now(s->ended);
    text_copy(s->stopped, stopped);
    s->is_final = is_final;
    s->seconds = session;
    THEN(status, put_session(store, err));
    THEN(status, store_write_front(store, &last, err));
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
    store_flush(store, &(Err){0});
    pthread_mutex_destroy(&store->writing);
    pthread_mutex_destroy(&store->lock);
    pthread_cond_destroy(&store->news);
    evaluation_table_free(&store->waiting);
    database_close(store->db);
    run_free(&store->run);
    free(store->was_on_front);
    free(store->polished);
    evaluation_table_free(&store->unfinished);
    hypervolume_free(store->hypervolume);
    for (RunTable t = 0; t < N_ROW_TABLES; t++)
        free(store->columns[t].place);
    folder_release(&store->folder);
    free(store);
}

/* -- designs from outside ------------------------------------------------------------------------------------------ */

Status store_polished(RunStore *store, const Evaluation *better, size_t n_tried, size_t n_simulated, long *id, Err *err)
{
    double last = 0, generation = 0;
    Status status = begin(store, err);
    TRY(status);
    if (better) { /* behind all that are there, as of the last generation */
        Evaluation e = *better;
        THEN(status, database_number(store->db, "SELECT max(id) FROM evaluation", &last, err));
        THEN(status, database_number(store->db, "SELECT max(number) FROM generation", &generation, err));
        *id = e.id = (long)last + 1;
        e.generation = (long)generation;
        e.kind = better->kind == KIND_KEPT ? KIND_KEPT : KIND_POLISHED;
        THEN(status, insert_row(store, ROWS_EVALUATION, &e, err));
    }
    THEN(status, database_do(store->db, err, "UPDATE run SET tried_to_polish = ?, polished_at = ?", "ii", n_tried,
                             n_simulated));
    return status == STATUS_OK ? store_flush(store, err) : lose(store, status);
}

Status store_finer(RunStore *store, size_t n, const Evaluation better[], Err *err)
{
    Status status = begin(store, err);
    for (size_t i = 0; i < n; i++)
        THEN(status, insert_row(store, ROWS_FINER, &better[i], err));
    return status == STATUS_OK ? store_flush(store, err) : lose(store, status);
}

Status store_provenance(RunStore *store, const Run *run, Err *err)
{
    TRY(begin(store, err));
    TRY(commit(store, tables_set_settings(store->db, run->settings, run, err), err));
    return write_provenance(store, run->provenance, err);
}
