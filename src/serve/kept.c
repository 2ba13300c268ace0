#include "serve/kept.h"

#include <pthread.h>
#include <stdlib.h>
#include <string.h>

#include "settings/settings.h"

struct KeptRun {
    size_t n_users; /* Kept is one; of its mutex, the rest but what_if does not change */
    Settings settings;
    char *provenance; /* of the run when it was first asked for */
    DetailCache *details;
    pthread_mutex_t mutex;
    WhatIf *what_if;
};

struct Kept {
    pthread_mutex_t mutex;  /* of the rest */
    KeptRun *run[KEPT_MAX]; /* NULL: nothing yet */
};

static void count_difference(const char *key, unsigned flags, const char *was, const char *is, void *user)
{
    int *n = user;
    (void)key;
    (void)was;
    (void)is;
    *n += !(flags & (SETTING_LIMIT | SETTING_FREE));
}

static int is_run(const KeptRun *r, const Run *run)
{
    int n = 0;
    settings_compare(&r->settings, run->settings, count_difference, &n);
    return n == 0 && strcmp(r->provenance, run->provenance) == 0;
}

static void close_run(KeptRun *r)
{
    what_if_close(r->what_if);
    detail_cache_close(r->details);
    pthread_mutex_destroy(&r->mutex);
    free(r->provenance);
    free(r);
}

static Status open_run(KeptRun **out, const Run *run, Err *err)
{
    KeptRun *r = *out = calloc(1, sizeof *r);
    if (!r)
        return fail(err, STATUS_NO_MEMORY, "no memory for a run");
    pthread_mutex_init(&r->mutex, NULL);
    r->n_users = 1;
    r->settings = *run->settings;
    r->provenance = strdup(run->provenance);
    const Status status =
        r->provenance ? detail_cache_open(&r->details, err) : fail(err, STATUS_NO_MEMORY, "no memory for a run");
    if (status != STATUS_OK) {
        close_run(r);
        *out = NULL;
    }
    return status;
}

Status kept_open(Kept **out, Err *err)
{
    *out = calloc(1, sizeof **out);
    if (!*out)
        return fail(err, STATUS_NO_MEMORY, "no memory for a server");
    pthread_mutex_init(&(*out)->mutex, NULL);
    return STATUS_OK;
}

void kept_close(Kept *k)
{
    if (!k)
        return;
    for (size_t i = 0; i < KEPT_MAX; i++)
        if (k->run[i])
            close_run(k->run[i]);
    pthread_mutex_destroy(&k->mutex);
    free(k);
}

void kept_give(Kept *k, KeptRun *r)
{
    pthread_mutex_lock(&k->mutex);
    const int is_last = r && --r->n_users == 0;
    pthread_mutex_unlock(&k->mutex);
    if (is_last)
        close_run(r);
}

Status kept_take(Kept *k, size_t number, const Run *run, KeptRun **out, Err *err)
{
    KeptRun *other = NULL, **place = &k->run[number];
    Status status = STATUS_OK;
    pthread_mutex_lock(&k->mutex);
    if (*place && !is_run(*place, run)) {
        other = *place;
        *place = NULL;
    }
    if (!*place)
        status = open_run(place, run, err);
    *out = *place;
    if (*out)
        (*out)->n_users++;
    pthread_mutex_unlock(&k->mutex);
    kept_give(k, other);
    return status;
}

DetailCache *kept_details(KeptRun *r)
{
    return r->details;
}

Status kept_what_if(KeptRun *r, const Run *run, const RecordPaths *moved, WhatIf **out, Err *err)
{
    pthread_mutex_lock(&r->mutex);
    const Status status = r->what_if ? STATUS_OK : what_if_open(&r->what_if, run, moved, err);
    *out = r->what_if;
    pthread_mutex_unlock(&r->mutex);
    return status;
}
