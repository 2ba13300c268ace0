#include "serve/detail_cache.h"

#include <pthread.h>
#include <stdlib.h>
#include <string.h>

#include "base/json.h"
#include "report/report_json.h"
#include "settings/options.h"

struct DetailCache {
    pthread_mutex_t mutex;
    long id[DETAILS_KEPT];
    int has_devices[DETAILS_KEPT];
    char *text[DETAILS_KEPT]; /* NULL: none */
    size_t next;
};

Status detail_cache_open(DetailCache **out, Err *err)
{
    *out = calloc(1, sizeof **out);
    if (!*out)
        return fail(err, STATUS_NO_MEMORY, "no memory for designs");
    pthread_mutex_init(&(*out)->mutex, NULL);
    return STATUS_OK;
}

void detail_cache_close(DetailCache *c)
{
    if (!c)
        return;
    for (size_t i = 0; i < DETAILS_KEPT; i++)
        free(c->text[i]);
    pthread_mutex_destroy(&c->mutex);
    free(c);
}

static Status text_of(const Run *run, size_t row, const Detail *d, char **text, Err *err)
{
    json_t *all =
        json_pack("{s:I, s:o, s:o}", "id", (json_int_t)run->table.row[row].id, "objectives",
                  json_numbers(run->schema.n_obj, run_f(run, row)), "detail", detail_json(d, &run->schema.order));
    *text = all ? json_dumps(all, JSON_COMPACT | JSON_REAL_PRECISION(6)) : NULL;
    json_decref(all);
    return *text ? STATUS_OK : fail(err, STATUS_NO_MEMORY, "no memory for a design");
}

static Status simulate(const Run *run, const RecordPaths *moved, size_t row, int with_devices, char **text, Err *err)
{
    Settings s = *run->settings;
    Detail d;
    s.search.threads = 1;
    TRY(record_paths_find(&s, run->provenance, moved, err));
    const DetailOptions options = {.floor = -1, .moved = *moved, .without_devices = !with_devices};
    TRY(detail_make(&s, (int)run->schema.n_var, run_x(run, row), &options, &d, err));
    const Status status = text_of(run, row, &d, text, err);
    detail_free(&d);
    return status;
}

/* The mutex is held. */
static Status find(DetailCache *c, const Run *run, const RecordPaths *moved, long id, const char **text, Err *err)
{
    const size_t row = run_find(run, id), place = c->next;
    const int with_devices = run->n_front > 0 && row == run_knee(run);
    char *made = NULL;
    for (size_t i = 0; i < DETAILS_KEPT; i++)
        if (c->text[i] && c->id[i] == id && c->has_devices[i] >= with_devices) {
            *text = c->text[i];
            return STATUS_OK;
        }
    if (run->settings->problem.kind != PROBLEM_TOWER || row == run->table.n)
        return fail(err, STATUS_MISSING, "%s: has no design %ld to be simulated", run->folder, id);
    TRY(simulate(run, moved, row, with_devices, &made, err));
    free(c->text[place]);
    c->id[place] = id;
    c->has_devices[place] = with_devices;
    *text = c->text[place] = made;
    c->next = (place + 1) % DETAILS_KEPT;
    return STATUS_OK;
}

Status detail_cache_ask(DetailCache *c, const Run *run, const RecordPaths *moved, long id, char **text, Err *err)
{
    const char *found = NULL;
    pthread_mutex_lock(&c->mutex);
    Status status = find(c, run, moved, id, &found, err);
    *text = found ? strdup(found) : NULL;
    pthread_mutex_unlock(&c->mutex);
    if (status == STATUS_OK && !*text)
        status = fail(err, STATUS_NO_MEMORY, "no memory for a design");
    return status;
}
