#include "run/store.h"

#include <errno.h>
#include <limits.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <time.h>
#include <unistd.h>

#include "run/output.h"

struct RunStore {
    char folder[PATH_MAX - 64];
    const Schema *schema;
    FILE *evaluations, *log;
};

static const char *const KIND_WORDS[] = {[KIND_SAMPLED] = "sampled", [KIND_INFILL] = "infill"};

static void path_in(const RunStore *store, const char *name, char path[PATH_MAX])
{
    snprintf(path, PATH_MAX, "%s/%s", store->folder, name);
}

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

static int holds_run(const RunStore *store)
{
    static const char *const SIGNS[] = {"front.csv", "settings.ini", "evaluations.csv", "log.txt"};
    char path[PATH_MAX];
    int found = 0;
    for (size_t i = 0; i < sizeof SIGNS / sizeof SIGNS[0]; i++) {
        path_in(store, SIGNS[i], path);
        found = found || access(path, F_OK) == 0;
    }
    return found;
}

/* The log is created exclusively, so that of two runs started together one is refused. taken: somebody else has it. */
static Status claim(RunStore *store, int *taken, Err *err)
{
    char path[PATH_MAX];
    *taken = holds_run(store);
    if (*taken)
        return STATUS_OK;
    TRY(make_folders(store->folder, err));
    path_in(store, "log.txt", path);
    store->log = fopen(path, "wx");
    *taken = !store->log && errno == EEXIST;
    if (!store->log && !*taken)
        return fail(err, STATUS_IO, "%s: cannot be written: %s", path, strerror(errno));
    return STATUS_OK;
}

static Status find_folder(RunStore *store, const char *folder, int exact, Err *err)
{
    int taken = 1;
    for (int i = 1; taken; i++) {
        const int n = i == 1 ? snprintf(store->folder, sizeof store->folder, "%s", folder)
                             : snprintf(store->folder, sizeof store->folder, "%s-%d", folder, i);
        if (n >= (int)sizeof store->folder)
            return fail(err, STATUS_IO, "%.200s...: the path is too long", folder);
        TRY(claim(store, &taken, err));
        if (taken && exact)
            return fail(err, STATUS_IO, "%s: holds a run already, and nothing is overwritten; choose another --out",
                        folder);
    }
    return STATUS_OK;
}

static void write_names(FILE *f, const char *before, const Schema *schema, size_t n_extra)
{
    fputs(before, f);
    for (size_t j = 0; j < schema->n_var; j++)
        fprintf(f, ",%s", schema_variable(schema, j)->name);
    for (size_t k = 0; k < schema->n_obj; k++)
        fprintf(f, ",%s", schema_objective(schema, k)->name);
    for (size_t k = 0; k < n_extra; k++)
        fprintf(f, ",%s", schema_extra(schema, k)->name);
    fputc('\n', f);
}

static Status open_evaluations(RunStore *store, Err *err)
{
    char path[PATH_MAX];
    path_in(store, "evaluations.csv", path);
    store->evaluations = fopen(path, "wx");
    if (!store->evaluations)
        return fail(err, STATUS_IO, "%s: cannot be written: %s", path, strerror(errno));
    write_names(store->evaluations, "id,generation,kind,outcome,reason", store->schema, store->schema->n_extra);
    return output_sync(store->evaluations, path, err);
}

Status store_create(RunStore **out, const char *folder, int exact, const Schema *schema, Err *err)
{
    *out = NULL;
    RunStore *store = calloc(1, sizeof *store);
    if (!store)
        return fail(err, STATUS_NO_MEMORY, "no memory for a run");
    store->schema = schema;
    Status status = find_folder(store, folder, exact, err);
    if (status == STATUS_OK)
        status = open_evaluations(store, err);
    if (status != STATUS_OK) {
        store_free(store);
        return status;
    }
    *out = store;
    return STATUS_OK;
}

const char *store_folder(const RunStore *store)
{
    return store->folder;
}

Status store_settings(RunStore *store, const Settings *s, Err *err)
{
    char path[PATH_MAX];
    Output o;
    path_in(store, "settings.ini", path);
    TRY(output_open(&o, path, err));
    settings_write(s, o.stream, 0);
    return output_close(&o, err);
}

static void write_numbers(FILE *f, size_t n, const double values[])
{
    for (size_t j = 0; j < n; j++) {
        fputc(',', f);
        print_number(f, values[j]);
    }
}

static void write_objectives(const Schema *schema, FILE *f, const double minimised[])
{
    for (size_t k = 0; k < schema->n_obj; k++) {
        fputc(',', f);
        print_number(f, schema_objective(schema, k)->sense * minimised[k]);
    }
}

Status store_evaluations(RunStore *store, const SearchView *view, size_t first, const Verdict verdicts[], Err *err)
{
    char path[PATH_MAX];
    FILE *f = store->evaluations;
    for (size_t i = first; i < view->n; i++) {
        const Verdict *v = &verdicts[i - first];
        fprintf(f, "%zu,%zu,%s,%s,%s", i + 1, view->generation[i], KIND_WORDS[view->kind[i]], v->outcome, v->reason);
        write_numbers(f, view->n_var, &view->X[i * view->n_var]);
        if (view->ok[i])
            write_objectives(store->schema, f, &view->F[i * view->n_obj]);
        for (size_t k = 0; !view->ok[i] && k < view->n_obj; k++)
            fputc(',', f);
        write_numbers(f, store->schema->n_extra, v->extra);
        fputc('\n', f);
    }
    path_in(store, "evaluations.csv", path);
    return output_sync(f, path, err);
}

Status store_front(RunStore *store, const SearchView *view, Err *err)
{
    char path[PATH_MAX];
    Output o;
    path_in(store, "front.csv", path);
    TRY(output_open(&o, path, err));
    write_names(o.stream, "id", store->schema, 0);
    for (size_t i = 0; i < view->n; i++) {
        if (!view->on_front[i])
            continue;
        fprintf(o.stream, "%zu", i + 1);
        write_numbers(o.stream, view->n_var, &view->X[i * view->n_var]);
        write_objectives(store->schema, o.stream, &view->F[i * view->n_obj]);
        fputc('\n', o.stream);
    }
    return output_close(&o, err);
}

Status store_log(RunStore *store, Err *err, const char *format, ...)
{
    char clock[32];
    struct tm parts;
    const time_t now = time(NULL);
    localtime_r(&now, &parts);
    strftime(clock, sizeof clock, "%F %T", &parts);
    fprintf(store->log, "%s  ", clock);
    va_list args;
    va_start(args, format);
    vfprintf(store->log, format, args);
    va_end(args);
    fputc('\n', store->log);
    errno = 0;
    if (fflush(store->log) != 0 || ferror(store->log))
        return fail(err, STATUS_IO, "%s/log.txt: cannot be written: %s", store->folder, strerror(errno ? errno : EIO));
    return STATUS_OK;
}

static Status close_file(FILE **f, const RunStore *store, const char *name, Err *err)
{
    char path[PATH_MAX];
    path_in(store, name, path);
    Status status = output_sync(*f, path, err);
    if (fclose(*f) != 0 && status == STATUS_OK)
        status = fail(err, STATUS_IO, "%s: cannot be written: %s", path, strerror(errno));
    *f = NULL;
    return status;
}

Status store_close(RunStore *store, Err *err)
{
    const Status evaluations = close_file(&store->evaluations, store, "evaluations.csv", err);
    const Status log = close_file(&store->log, store, "log.txt", err);
    store_free(store);
    return evaluations != STATUS_OK ? evaluations : log;
}

void store_free(RunStore *store)
{
    if (!store)
        return;
    if (store->evaluations)
        fclose(store->evaluations);
    if (store->log)
        fclose(store->log);
    free(store);
}
