#include "serve/watch.h"

#include <dirent.h>
#include <errno.h>
#include <math.h>
#include <pthread.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

#include "base/clock.h"
#include "store/folder.h"
#include "store/run_read.h"

enum { RUNS_MAX = 500 };
static const double POLL_S = 0.2, IDLE_S = 60, READ_SHARE = 10, AGAIN_S = 2;

/* What changes with a run; all of its bytes are compared. */
typedef struct {
    struct timespec time[2];
    off_t size[2];
    long held;
} Stamp;

typedef struct {
    char folder[PATH_MAX], name[NAME_MAX + 1];
    View view;      /* the newest; its look NULL: none */
    Stamp stamp;    /* of that look */
    double next;    /* of the clock, before which it is not read again */
    double kept_to; /* of the clock, after which it is released unless a reading is waited for */
    int n_waiting;
} Watched;

struct Watch {
    char folder[PATH_MAX];
    const RecordPaths *moved;
    int is_run, stops;
    pthread_mutex_t mutex; /* of all below */
    pthread_cond_t changed, wanted;
    pthread_t thread;
    size_t n;
    Watched *run[RUNS_MAX];
};

/* -- reading ------------------------------------------------------------------------------------------------------- */

static void stamp_of(const Watched *r, Stamp *s)
{
    static const char *const FILES[] = {"run.sqlite", "run.sqlite-wal"};
    char path[PATH_MAX + 16];
    struct stat file;
    LockHolder holder;
    memset(s, 0, sizeof *s);
    for (int i = 0; i < 2; i++) {
        snprintf(path, sizeof path, "%s/%s", r->folder, FILES[i]);
        if (stat(path, &file) == 0) {
            s->time[i] = file.st_mtim;
            s->size[i] = file.st_size;
        }
    }
    snprintf(path, sizeof path, "%s/lock", r->folder);
    s->held = lock_is_held(path, &holder);
}

static void release(Look *look)
{
    if (look && --look->n_users == 0) {
        on_demand_close(look->on_demand);
        run_free(&look->run);
        free(look);
    }
}

/* Of this thread's work: on a busy machine a reading lasts longer than it costs. */
static double worked_s(void)
{
    struct timespec t;
    clock_gettime(CLOCK_THREAD_CPUTIME_ID, &t);
    return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

/* before: the look before, NULL: none. What was simulated stays while no other run is made in the place of this one. */
static Status look_at(const Watch *w, const char *folder, const Look *before, Look **out, Err *err)
{
    Look *look = *out = calloc(1, sizeof *look);
    if (!look)
        return fail(err, STATUS_NO_MEMORY, "no memory for a run");
    Status status = run_read(&look->run, folder, err);
    if (status == STATUS_OK) {
        look->n_users = 1;
        standing_of(&look->standing, folder, &look->run);
        if (before && on_demand_is_of(before->on_demand, &look->run))
            look->on_demand = on_demand_share(before->on_demand);
        else
            status = on_demand_open(&look->on_demand, &look->run, w->moved, err);
    }
    if (status != STATUS_OK) {
        run_free(&look->run);
        free(look);
        *out = NULL;
    }
    return status;
}

/* The mutex is held before and after, not while the run is read; this thread alone replaces a look. */
static void read_again(Watch *w, Watched *r, const Stamp *stamp)
{
    View *v = &r->view;
    Err err = {0};
    Look *fresh;
    const double start = worked_s();
    pthread_mutex_unlock(&w->mutex);
    const Status status = look_at(w, r->folder, v->look, &fresh, &err);
    pthread_mutex_lock(&w->mutex);
    r->next = clock_seconds() + (status == STATUS_OK ? READ_SHARE * (worked_s() - start) : AGAIN_S);
    err.code = status;
    v->version += status == STATUS_OK || v->why.code == STATUS_OK;
    v->why = err;
    if (fresh) {
        release(v->look);
        v->look = fresh;
        r->stamp = *stamp;
    }
    pthread_cond_broadcast(&w->changed);
}

static void wait_for(pthread_cond_t *cond, pthread_mutex_t *mutex, double seconds)
{
    struct timespec until;
    clock_gettime(CLOCK_MONOTONIC, &until);
    const long long ns = until.tv_nsec + (long long)(1e9 * seconds);
    until.tv_sec += (time_t)(ns / 1000000000);
    until.tv_nsec = (long)(ns % 1000000000);
    pthread_cond_timedwait(cond, mutex, &until);
}

/* The mutex is held. 0: nobody waits for this run. */
static int look_after(Watch *w, Watched *r)
{
    Stamp stamp;
    const double now = clock_seconds();
    if (now > r->kept_to && r->n_waiting == 0) {
        release(r->view.look);
        r->view.look = NULL;
        return 0;
    }
    if (now >= r->next || (!r->view.look && r->view.why.code == STATUS_OK)) {
        stamp_of(r, &stamp);
        if (!r->view.look || r->view.why.code != STATUS_OK || memcmp(&stamp, &r->stamp, sizeof stamp) != 0)
            read_again(w, r, &stamp);
    }
    return 1;
}

static void *watch(void *user)
{
    Watch *w = user;
    pthread_mutex_lock(&w->mutex);
    while (!w->stops) {
        int n_kept = 0;
        for (size_t i = 0; i < w->n && !w->stops; i++)
            n_kept += look_after(w, w->run[i]);
        wait_for(&w->wanted, &w->mutex, n_kept > 0 ? POLL_S : IDLE_S);
    }
    pthread_mutex_unlock(&w->mutex);
    return NULL;
}

/* -- which runs ---------------------------------------------------------------------------------------------------- */

static void add(Watch *w, const char *folder, const char *name)
{
    for (size_t i = 0; i < w->n; i++)
        if (strcmp(w->run[i]->name, name) == 0)
            return;
    Watched *r = w->n < RUNS_MAX ? calloc(1, sizeof *r) : NULL;
    if (!r)
        return;
    snprintf(r->folder, sizeof r->folder, "%s", folder);
    snprintf(r->name, sizeof r->name, "%s", name);
    w->run[w->n++] = r;
}

static void find_in(Watch *w)
{
    struct dirent **entries;
    char path[PATH_MAX + NAME_MAX + 2];
    const int n = scandir(w->folder, &entries, NULL, versionsort);
    for (int i = 0; i < n; i++) {
        snprintf(path, sizeof path, "%s/%s", w->folder, entries[i]->d_name);
        if (entries[i]->d_name[0] != '.' && strlen(path) < PATH_MAX && run_is_there(path))
            add(w, path, entries[i]->d_name);
        free(entries[i]);
    }
    if (n >= 0)
        free(entries);
}

void watch_find(Watch *w)
{
    pthread_mutex_lock(&w->mutex);
    if (!w->is_run)
        find_in(w);
    pthread_mutex_unlock(&w->mutex);
}

size_t watch_n(Watch *w)
{
    pthread_mutex_lock(&w->mutex);
    const size_t n = w->n;
    pthread_mutex_unlock(&w->mutex);
    return n;
}

const char *watch_name(Watch *w, size_t i)
{
    return w->run[i]->name;
}

static Status find_runs(Watch *w, const char *folder, Err *err)
{
    const char *slash = strrchr(w->folder, '/');
    w->is_run = run_is_there(w->folder);
    if (w->is_run)
        add(w, w->folder, slash && slash[1] ? slash + 1 : w->folder);
    else
        find_in(w);
    return w->n > 0 ? STATUS_OK : fail(err, STATUS_MISSING, "%s: is no run, and holds none", folder);
}

static Status start(Watch *w, const char *folder, Err *err)
{
    struct stat s;
    pthread_condattr_t monotonic;
    pthread_condattr_init(&monotonic);
    pthread_condattr_setclock(&monotonic, CLOCK_MONOTONIC);
    pthread_mutex_init(&w->mutex, NULL);
    pthread_cond_init(&w->changed, &monotonic);
    pthread_cond_init(&w->wanted, &monotonic);
    pthread_condattr_destroy(&monotonic);
    if (!realpath(folder, w->folder) || stat(w->folder, &s) != 0)
        return fail(err, STATUS_MISSING, "%s: %s", folder, strerror(errno));
    TRY(find_runs(w, folder, err));
    return pthread_create(&w->thread, NULL, watch, w) == 0 ? STATUS_OK
                                                           : fail(err, STATUS_NO_MEMORY, "no thread to watch a run");
}

Status watch_open(Watch **out, const char *folder, const RecordPaths *moved, Err *err)
{
    Watch *w = calloc(1, sizeof *w);
    *out = NULL;
    if (!w)
        return fail(err, STATUS_NO_MEMORY, "no memory to watch a run");
    w->moved = moved;
    const Status status = start(w, folder, err);
    if (status == STATUS_OK) {
        *out = w;
        return STATUS_OK;
    }
    for (size_t i = 0; i < w->n; i++)
        free(w->run[i]);
    free(w);
    return status;
}

void watch_stop(Watch *w)
{
    pthread_mutex_lock(&w->mutex);
    w->stops = 1;
    pthread_cond_broadcast(&w->changed);
    pthread_cond_broadcast(&w->wanted);
    pthread_mutex_unlock(&w->mutex);
}

int watch_is_stopped(Watch *w)
{
    pthread_mutex_lock(&w->mutex);
    const int stops = w->stops;
    pthread_mutex_unlock(&w->mutex);
    return stops;
}

void watch_close(Watch *w)
{
    watch_stop(w);
    pthread_join(w->thread, NULL);
    for (size_t i = 0; i < w->n; i++) {
        release(w->run[i]->view.look);
        free(w->run[i]);
    }
    pthread_cond_destroy(&w->changed);
    pthread_cond_destroy(&w->wanted);
    pthread_mutex_destroy(&w->mutex);
    free(w);
}

/* -- looking ------------------------------------------------------------------------------------------------------- */

/* The mutex is held. */
static void keep(Watch *w, Watched *r, double seconds)
{
    r->kept_to = fmax(r->kept_to, clock_seconds() + seconds);
    pthread_cond_broadcast(&w->wanted);
}

/* The mutex is held. */
static void take(Watched *r, View *view)
{
    *view = r->view;
    view->look->n_users++;
}

Status watch_take(Watch *w, size_t i, double seconds, View *view, Err *err)
{
    Status status = STATUS_OK;
    *view = (View){0};
    pthread_mutex_lock(&w->mutex);
    Watched *r = w->run[i];
    if (!r->view.look && clock_seconds() >= r->next)
        r->view.why.code = STATUS_OK;
    keep(w, r, seconds);
    r->n_waiting++;
    while (!r->view.look && r->view.why.code == STATUS_OK && !w->stops)
        wait_for(&w->changed, &w->mutex, 1);
    r->n_waiting--;
    keep(w, r, seconds);
    if (r->view.look) {
        take(r, view);
    } else {
        *err = r->view.why;
        status = w->stops ? STATUS_STOPPED : r->view.why.code;
    }
    pthread_mutex_unlock(&w->mutex);
    return status;
}

void watch_give(Watch *w, View *view)
{
    pthread_mutex_lock(&w->mutex);
    release(view->look);
    view->look = NULL;
    pthread_mutex_unlock(&w->mutex);
}

View watch_next(Watch *w, size_t i, long seen, double seconds)
{
    View view = {.version = seen};
    const double end = clock_seconds() + seconds;
    pthread_mutex_lock(&w->mutex);
    Watched *r = w->run[i];
    keep(w, r, seconds);
    for (double left = seconds; !w->stops && left > 0 && !(r->view.look && r->view.version > seen);
         left = end - clock_seconds())
        wait_for(&w->changed, &w->mutex, left);
    if (!w->stops && r->view.look && r->view.version > seen)
        take(r, &view);
    pthread_mutex_unlock(&w->mutex);
    return view;
}
