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
#include "store/export.h"
#include "store/front_lines.h"
#include "store/front_share.h"
#include "store/lock.h"
#include "store/output.h"
#include "store/rows.h"
#include "store/run_read.h"
#include "store/tables.h"
#include "settings/settings.h"

struct RunStore {
    char folder[PATH_MAX - 64];
    const Schema *schema;
    int lock;
    Database *db;
    Run saved; /* of a run that goes on */
    int has_saved, has_polished;

    int in_transaction;
    double last_commit;          /* [s] */
    size_t n_exported;           /* designs in evaluations.csv */
    unsigned char *was_on_front; /* (n_flags) at the end of the last generation */
    size_t n_flags;
    FrontLines lines;
    FrontShare share;
    long session;
    FILE *evaluations, *log, *events;
};

static void path_in(const RunStore *store, const char *name, char path[PATH_MAX])
{
    snprintf(path, PATH_MAX, "%s/%s", store->folder, name);
}

const char *store_folder(const RunStore *store)
{
    return store->folder;
}

const Run *store_run(const RunStore *store)
{
    return store->has_saved ? &store->saved : NULL;
}

Run store_give_run(RunStore *store)
{
    const Run run = store->saved;
    store->saved = (Run){0};
    store->has_saved = 0;
    return run;
}

double store_hypervolume(const RunStore *store)
{
    return front_share_value(&store->share);
}

/* -- the folder ---------------------------------------------------------------------------------------------------- */

static Status make_folders(const char *folder, Err *err)
{
    char part[PATH_MAX];
    for (const char *end = folder + 1;; end++) {
        if (*end && *end != '/')
            continue;
        snprintf(part, sizeof part, "%.*s", (int)(end - folder), folder);
        if (mkdir(part, 0777) != 0 && errno != EEXIST)
            return fail(err, STATUS_IO, "%s: cannot be made a folder: %s", part, strerror(errno));
        if (!*end)
            return STATUS_OK;
    }
}

static int has_file(const RunStore *store, const char *name)
{
    char path[PATH_MAX];
    path_in(store, name, path);
    return access(path, F_OK) == 0;
}

static Status take_lock(RunStore *store, Err *err)
{
    char path[PATH_MAX];
    TRY(make_folders(store->folder, err));
    path_in(store, "lock", path);
    return lock_take(path, &store->lock, err);
}

static Status take_free_folder(RunStore *store, const char *folder, Err *err)
{
    char lock[PATH_MAX];
    LockHolder holder;
    for (int i = 2;; i++) {
        path_in(store, "lock", lock);
        if (!has_file(store, "run.sqlite") && !lock_is_held(lock, &holder))
            return take_lock(store, err);
        if (snprintf(store->folder, sizeof store->folder, "%s-%d", folder, i) >= (int)sizeof store->folder)
            return fail(err, STATUS_IO, "%.200s...: the path is too long", folder);
    }
}

static Status open_database(RunStore *store, Err *err)
{
    char path[PATH_MAX];
    path_in(store, "run.sqlite", path);
    return database_open(&store->db, path, DATABASE_WRITE, err);
}

static Status take_run(RunStore *store, Err *err)
{
    TRY(take_lock(store, err));
    if (!has_file(store, "run.sqlite"))
        return STATUS_OK;
    TRY(open_database(store, err));
    TRY(run_load(&store->saved, store->db, store->folder, err));
    database_grow(store->db);
    store->has_saved = 1;
    store->has_polished = run_has_polished(&store->saved);
    return STATUS_OK;
}

/* The journal goes first: left alone it would be taken for that of the next database. */
Status store_forget_empty(RunStore *store, Err *err)
{
    static const char *const NAMES[] = {"run.sqlite-wal", "run.sqlite-shm", "run.sqlite"};
    char path[PATH_MAX];
    if (!store->has_saved || store->saved.table.n > 0 || store->saved.n_generations > 0)
        return STATUS_OK;
    database_close(store->db);
    run_free(&store->saved);
    store->db = NULL;
    store->has_saved = 0;
    for (size_t i = 0; i < sizeof NAMES / sizeof NAMES[0]; i++) {
        path_in(store, NAMES[i], path);
        if (unlink(path) != 0 && errno != ENOENT)
            return fail(err, STATUS_IO, "%s: cannot be removed: %s", path, strerror(errno));
    }
    return STATUS_OK;
}

Status store_open(RunStore **out, const char *folder, int fresh, Err *err)
{
    *out = NULL;
    RunStore *store = calloc(1, sizeof *store);
    if (!store)
        return fail(err, STATUS_NO_MEMORY, "no memory for a run");
    store->lock = -1;
    Status status;
    if (snprintf(store->folder, sizeof store->folder, "%s", folder) >= (int)sizeof store->folder)
        status = fail(err, STATUS_IO, "%.200s...: the path is too long", folder);
    else
        status = fresh ? take_free_folder(store, folder, err) : take_run(store, err);
    if (status == STATUS_OK)
        *out = store;
    else
        store_free(store);
    return status;
}

/* -- the files beside the database --------------------------------------------------------------------------------- */

typedef void (*WriteFn)(FILE *f, const void *content);

static Status write_file(const RunStore *store, const char *name, WriteFn write, const void *content, Err *err)
{
    char path[PATH_MAX];
    Output o;
    path_in(store, name, path);
    TRY(output_open(&o, path, err));
    write(o.stream, content);
    return output_close(&o, err);
}

static void put_settings(FILE *f, const void *settings)
{
    settings_write(settings, f, 0);
}

static void put_line(FILE *f, const void *text)
{
    fprintf(f, "%s\n", (const char *)text);
}

static void put_front(FILE *f, const void *saved)
{
    export_front(f, saved);
}

static void put_evaluations(FILE *f, const void *saved)
{
    export_evaluations_header(f, &((const Run *)saved)->schema);
    export_evaluations(f, &((const Run *)saved)->table, 0);
}

/* An earlier write that failed is told too, when its cause is gone. */
static Status flush(const RunStore *store, FILE *f, const char *name, Err *err)
{
    errno = EIO;
    if (fflush(f) != 0 || ferror(f))
        return fail(err, STATUS_IO, "%s/%s: cannot be written: %s", store->folder, name, strerror(errno));
    return STATUS_OK;
}

static Status open_to_append(const RunStore *store, const char *name, FILE **f, Err *err)
{
    char path[PATH_MAX];
    path_in(store, name, path);
    *f = fopen(path, "ae");
    return *f ? STATUS_OK : fail(err, STATUS_IO, "%s: cannot be written: %s", path, strerror(errno));
}

static Status open_logs(RunStore *store, Err *err)
{
    TRY(open_to_append(store, "log.txt", &store->log, err));
    return open_to_append(store, "log.jsonl", &store->events, err);
}

/* -- a new run, or one that goes on -------------------------------------------------------------------------------- */

Status store_begin(RunStore *store, const Schema *schema, const Settings *used, const char *provenance, Err *err)
{
    char path[PATH_MAX];
    store->schema = schema;
    path_in(store, "run.sqlite", path);
    TRY(tables_create(path, schema, used, provenance, err));
    TRY(open_database(store, err));
    database_grow(store->db);
    const Run empty = {.schema = *schema};
    TRY(write_file(store, "settings.ini", put_settings, used, err));
    TRY(write_file(store, "provenance.json", put_line, provenance, err));
    TRY(write_file(store, "evaluations.csv", put_evaluations, &empty, err));
    TRY(open_to_append(store, "evaluations.csv", &store->evaluations, err));
    return open_logs(store, err);
}

/* Where the search stands: what was on its front, and how many designs its finished generations have. */
static Status take_up(RunStore *store, Err *err)
{
    const Run *h = &store->saved;
    size_t n = 0;
    while (n < h->table.n && h->table.row[n].kind != KIND_UNFINISHED && h->table.row[n].id < POLISHED_FIRST)
        n++;
    store->was_on_front = calloc(n + 1, 1);
    if (!store->was_on_front)
        return fail(err, STATUS_NO_MEMORY, "no memory for %zu designs", n);
    for (size_t i = 0; i < n; i++)
        store->was_on_front[i] = h->place[i].entered != NEVER && h->place[i].left == NEVER;
    store->n_exported = store->n_flags = n;
    return STATUS_OK;
}

Status store_go_on(RunStore *store, const Schema *schema, const Settings *used, Err *err)
{
    store->schema = schema;
    TRY(take_up(store, err));
    TRY(tables_set_settings(store->db, used, err));
    TRY(write_file(store, "settings.ini", put_settings, used, err));
    TRY(write_file(store, "provenance.json", put_line, store->saved.provenance, err));
    TRY(write_file(store, "evaluations.csv", put_evaluations, &store->saved, err));
    if (store->saved.n_generations > 0)
        TRY(write_file(store, "front.csv", put_front, &store->saved, err));
    TRY(open_to_append(store, "evaluations.csv", &store->evaluations, err));
    return open_logs(store, err);
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

/* -- simulations --------------------------------------------------------------------------------------------------- */

static Status begin(RunStore *store, Err *err)
{
    if (store->in_transaction)
        return STATUS_OK;
    TRY(database_do(store->db, err, "BEGIN IMMEDIATE", ""));
    store->in_transaction = 1;
    return STATUS_OK;
}

Status store_flush(RunStore *store, Err *err)
{
    if (!store->in_transaction)
        return STATUS_OK;
    TRY(database_do(store->db, err, "COMMIT", ""));
    store->in_transaction = 0;
    store->last_commit = clock_seconds();
    return STATUS_OK;
}

static Status insert(RunStore *store, const Evaluation *e, Err *err)
{
    const Schema *s = store->schema;
    return rows_insert(store->db, (RowShape){s->n_var, s->n_obj, s->n_extra}, e, err);
}

Status store_evaluation(RunStore *store, const Evaluation *e, Err *err)
{
    TRY(begin(store, err));
    TRY(insert(store, e, err));
    if (e->seconds >= COMMIT_S || clock_seconds() >= store->last_commit + COMMIT_S)
        TRY(store_flush(store, err));
    return STATUS_OK;
}

/* -- generations --------------------------------------------------------------------------------------------------- */

static Status store_kinds(RunStore *store, const SearchView *v, Err *err)
{
    for (size_t i = store->n_exported; i < v->n; i++)
        TRY(database_do(store->db, err, "UPDATE evaluation SET kind = ?, generation = ? WHERE id = ?", "tii",
                        kind_word(v->kind[i]), (long)v->generation[i], (long)i + 1));
    if (v->is_asynchronous)
        return STATUS_OK;
    /* what another program or machine had asked for in this generation before it was cut short */
    return database_do(store->db, err, "DELETE FROM evaluation WHERE kind IS NULL AND id > ?", "i", (long)v->n);
}

static Status store_front_changes(RunStore *store, const SearchView *v, Err *err)
{
    unsigned char *flags = realloc(store->was_on_front, v->n + 1);
    if (!flags)
        return fail(err, STATUS_NO_MEMORY, "no memory for %zu designs", v->n);
    store->was_on_front = flags;
    memset(flags + store->n_flags, 0, v->n - store->n_flags);
    store->n_flags = v->n;
    for (size_t i = 0; i < v->n; i++) {
        if (v->on_front[i] && !flags[i])
            TRY(database_do(store->db, err,
                            "INSERT INTO front(evaluation, entered) VALUES (?, ?) ON CONFLICT(evaluation) DO UPDATE "
                            "SET left = NULL",
                            "ii", (long)i + 1, (long)v->generation_now));
        if (!v->on_front[i] && flags[i])
            TRY(database_do(store->db, err, "UPDATE front SET left = ? WHERE evaluation = ?", "ii",
                            (long)v->generation_now, (long)i + 1));
        flags[i] = v->on_front[i];
    }
    return STATUS_OK;
}

static Status store_moment(RunStore *store, const SearchView *v, double seconds, double session, Err *err)
{
    char finished[24];
    utc_now(finished);
    if (!v->state)
        return fail(err, STATUS_NO_MEMORY, "no memory for the state of the search");
    TRY(database_do(store->db, err,
                    "INSERT INTO generation(number, simulated, failed, front, predicted, surrogate_error, hypervolume, "
                    "seconds, finished) VALUES (?, ?, ?, ?, ?, ?, ?, ?, ?)",
                    "iiiiidddt", (long)v->generation_now, (long)v->n, (long)v->n_failed, (long)v->n_front,
                    (long)v->n_predicted, v->surrogate_error, store_hypervolume(store), seconds, finished));
    TRY(database_do(store->db, err,
                    "UPDATE session SET seconds = ?, search = ?, waited = ?, surrogate = ? WHERE number = ?", "ddddi",
                    session, v->seconds, v->waited_s, v->surrogate_s, store->session));
    return database_do(store->db, err, "INSERT OR REPLACE INTO state(id, generation, bytes) VALUES (1, ?, ?)", "ib",
                       (long)v->generation_now, v->state, v->n_state);
}

/* What the database now has of this generation, at the end of evaluations.csv. */
static Status append_evaluations(RunStore *store, const SearchView *v, Err *err)
{
    EvaluationTable t = evaluation_table(store->schema->n_var, store->schema->n_obj, store->schema->n_extra);
    Status status = rows_read(store->db, &t, (long)store->n_exported + 1, (long)v->n, err);
    if (status == STATUS_OK && t.n != v->n - store->n_exported)
        status = fail(err, STATUS_INTERNAL, "%s: the search knows of %zu simulations, %zu are stored",
                      database_path(store->db), v->n, store->n_exported + t.n);
    if (status == STATUS_OK)
        export_evaluations(store->evaluations, &t, 0);
    evaluation_table_free(&t);
    TRY(status);
    store->n_exported = v->n;
    return flush(store, store->evaluations, "evaluations.csv", err);
}

static Status write_front(RunStore *store, const SearchView *v, Err *err)
{
    TRY(front_lines_follow(&store->lines, store->schema, v, err));
    return write_file(store, "front.csv", front_lines_put, &store->lines, err);
}

/* Evaluations first: a design that is in front.csv is in evaluations.csv too. */
static Status write_whole_tables(const RunStore *store, const Run *run, int evaluations_too, Err *err)
{
    if (evaluations_too)
        TRY(write_file(store, "evaluations.csv", put_evaluations, run, err));
    return write_file(store, "front.csv", put_front, run, err);
}

/* The same of what the database has now. */
static Status renew_tables(RunStore *store, int evaluations_too, Err *err)
{
    Run run;
    TRY(run_load(&run, store->db, store->folder, err));
    const Status status = write_whole_tables(store, &run, evaluations_too, err);
    run_free(&run);
    return status;
}

static Status put_generation(RunStore *store, const SearchView *v, double seconds, double session, Err *err)
{
    TRY(begin(store, err));
    TRY(store_kinds(store, v, err));
    TRY(store_front_changes(store, v, err));
    TRY(store_moment(store, v, seconds, session, err));
    return store_flush(store, err);
}

/* All of it or nothing: half a generation beside the state of the one before would be no run that can go on. */
static Status commit_generation(RunStore *store, const SearchView *v, double seconds, double session, Err *err)
{
    TRY(store_flush(store, err)); /* simulations that wait are not lost with it */
    const Status status = put_generation(store, v, seconds, session, err);
    if (store->in_transaction)
        database_do(store->db, NULL, "ROLLBACK", "");
    store->in_transaction = 0;
    return status;
}

Status store_generation(RunStore *store, const SearchView *v, double seconds, double session, Err *err)
{
    TRY(front_share_follow(&store->share, v, err));
    TRY(commit_generation(store, v, seconds, session, err));
    TRY(append_evaluations(store, v, err));
    return store->has_polished || store->schema->has_spread ? renew_tables(store, 0, err) : write_front(store, v, err);
}

/* -- logs and the end ---------------------------------------------------------------------------------------------- */

Status store_log(RunStore *store, Err *err, const char *format, ...)
{
    char clock[32];
    struct tm parts;
    const time_t now = time(NULL);
    if (!store->log)
        return STATUS_OK;
    localtime_r(&now, &parts);
    strftime(clock, sizeof clock, "%F %T", &parts);
    fprintf(store->log, "%s  ", clock);
    va_list args;
    va_start(args, format);
    vfprintf(store->log, format, args);
    va_end(args);
    fputc('\n', store->log);
    return flush(store, store->log, "log.txt", err);
}

Status store_event(RunStore *store, json_t *event, Err *err)
{
    char time[24];
    utc_now(time);
    json_object_set_new(event, "time", json_string(time));
    if (json_dumpf(event, store->events, JSON_SORT_KEYS) == 0) /* no memory for an event: it is left out */
        fputc('\n', store->events);
    json_decref(event);
    return flush(store, store->events, "log.jsonl", err);
}

static Status close_file(FILE **f, const RunStore *store, const char *name, Err *err)
{
    char path[PATH_MAX];
    path_in(store, name, path);
    TRY(output_sync(*f, path, err));
    fclose(*f); /* all of it is on the disk */
    *f = NULL;
    return STATUS_OK;
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

static Status close_files(RunStore *store, Err *err)
{
    TRY(close_file(&store->evaluations, store, "evaluations.csv", err));
    TRY(close_file(&store->events, store, "log.jsonl", err));
    return close_file(&store->log, store, "log.txt", err);
}

static Status read_at_the_end(RunStore *store, Run *run, Err *err)
{
    TRY(run_load(run, store->db, store->folder, err));
    return store->has_polished ? write_whole_tables(store, run, 1, err) : STATUS_OK;
}

Status store_close(RunStore *store, const char *stopped, int is_final, double session, Run *run, Err *err)
{
    Run unwanted = {0}, *last = run ? run : &unwanted;
    Status status = end_session(store, stopped, is_final, session, err);
    if (status == STATUS_OK && (run || store->has_polished))
        status = read_at_the_end(store, last, err);
    if (status == STATUS_OK)
        status = close_files(store, err);
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
    FILE *files[] = {store->evaluations, store->events, store->log};
    for (int i = 0; i < 3; i++)
        if (files[i])
            fclose(files[i]);
    database_close(store->db);
    run_free(&store->saved);
    free(store->was_on_front);
    front_lines_free(&store->lines);
    front_share_free(&store->share);
    lock_release(store->lock);
    free(store);
}

/* -- designs from outside ------------------------------------------------------------------------------------------ */

/* Behind the polished ones that are there, as of the last generation. */
static Status insert_polished(RunStore *store, const Evaluation *design, long *id, Err *err)
{
    double last, generation;
    Evaluation e = *design;
    TRY(database_number(store->db, "SELECT max(id) FROM evaluation", 0, &last, err));
    TRY(database_number(store->db, "SELECT max(number) FROM generation", 0, &generation, err));
    *id = e.id = last >= POLISHED_FIRST ? (long)last + 1 : POLISHED_FIRST;
    e.generation = (long)generation;
    e.kind = KIND_POLISHED;
    return insert(store, &e, err);
}

Status store_read(RunStore *store, Run *run, Err *err)
{
    TRY(store_flush(store, err));
    return run_load(run, store->db, store->folder, err);
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

static Status add_all(RunStore *store, size_t n, const Evaluation designs[], long *first_id, Err *err)
{
    long id = 0;
    store->schema = &store->saved.schema;
    TRY(begin(store, err));
    for (size_t i = 0; i < n; i++) {
        TRY(insert_polished(store, &designs[i], &id, err));
        if (first_id && i == 0)
            *first_id = id;
    }
    TRY(store_flush(store, err));
    return renew_tables(store, 1, err);
}

Status store_add_evaluations(const char *folder, size_t n, const Evaluation designs[], long *first_id, Err *err)
{
    RunStore *store;
    char path[PATH_MAX];
    if (!run_path(folder, path, sizeof path))
        return fail(err, STATUS_MISSING, "%s: holds no run: run.sqlite is not there", folder);
    TRY(store_open(&store, folder, 0, err));
    const Status status = add_all(store, n, designs, first_id, err);
    store_free(store);
    return status;
}
