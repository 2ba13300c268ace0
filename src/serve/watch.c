#include "serve/watch.h"

#include <fcntl.h>
#include <ftw.h>
#include <pthread.h>
#include <stdio.h>
#include <sys/stat.h>
#include <time.h>

#include "base/clock.h"
#include "store/folder.h"
#include "store/run_read.h"

enum { RUNS_MAX = 500 };
static const double POLL_S = 0.2, READ_SHARE = 10, AGAIN_S = 2;

/* What changes with a run; all of its bytes are compared. */
typedef struct {
    struct timespec time[2];
    off_t size[2];
    long held;
} Stamp;

typedef struct {
    char folder[PATH_MAX], name[NAME_MAX + 1];
    atomic_int is_gone;    /* it was renamed or removed: its number leads nowhere */
    pthread_mutex_t mutex; /* of the rest, held while the run is read */
    View view;             /* the newest; its snapshot NULL: none */
    Stamp stamp;           /* of that snapshot */
    double next;           /* of the clock, before which it is not read again */
    double kept_to;        /* of the clock, after which it is released */
} Watched;

struct Watch {
    char folder[PATH_MAX];
    const RecordPaths *moved;
    int is_run;
    atomic_int stops;
    pthread_mutex_t mutex; /* of the next two */
    size_t n;
    Watched *run[RUNS_MAX];
};

/* -- reading ------------------------------------------------------------------------------------------------------- */

static void release(Snapshot *snapshot)
{
    if (snapshot && atomic_fetch_sub(&snapshot->n_users, 1) == 1) {
        on_demand_close(snapshot->on_demand);
        run_free(&snapshot->run);
        free(snapshot);
    }
}

/* Of this thread's work: on a busy machine a reading lasts longer than it costs. */
static double worked_s(void)
{
    struct timespec t;
    clock_gettime(CLOCK_THREAD_CPUTIME_ID, &t);
    return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

/* Where it has changed, and not sooner than a tenth of a processor allows. The mutex is held. */
static void read_again(const Watch *w, Watched *r)
{
    static const char *const FILES[] = {"run.sqlite", "run.sqlite-wal"};
    View *v = &r->view;
    char path[PATH_MAX];
    struct stat file;
    LockHolder holder;
    Stamp stamp;
    Err err = {0};
    if (clock_seconds() < r->next && (v->snapshot || v->why.code != STATUS_OK))
        return;

    /* 1. Has any of it changed? */
    memset(&stamp, 0, sizeof stamp);
    for (int i = 0; i < 2; i++) {
        folder_path(r->folder, FILES[i], path);
        if (stat(path, &file) == 0) {
            stamp.time[i] = file.st_mtim;
            stamp.size[i] = file.st_size;
        }
    }
    stamp.held = folder_is_held(r->folder, &holder);
    if (v->snapshot && v->why.code == STATUS_OK && memcmp(&stamp, &r->stamp, sizeof stamp) == 0)
        return;

    /* 2. The run as it is now. What was simulated on demand stays while no other run is made in its place. */
    const double start = worked_s();
    Snapshot *fresh = calloc(1, sizeof *fresh);
    Status status = fresh ? run_read(&fresh->run, r->folder, &err) : fail_memory(&err, 1, "a run");
    if (status == STATUS_OK) {
        fresh->n_users = 1;
        standing_of(&fresh->standing, r->folder, &fresh->run);
        if (v->snapshot && on_demand_is_of(v->snapshot->on_demand, &fresh->run))
            fresh->on_demand = on_demand_share(v->snapshot->on_demand);
        else
            status = on_demand_open(&fresh->on_demand, &fresh->run, w->moved, &err);
    }

    /* 3. It takes the place of the snapshot before, or the reason does why it cannot be read. */
    r->next = clock_seconds() + (status == STATUS_OK ? READ_SHARE * (worked_s() - start) : AGAIN_S);
    err.code = status;
    v->version += status == STATUS_OK || v->why.code == STATUS_OK;
    v->why = err;
    if (status == STATUS_OK) {
        release(v->snapshot);
        v->snapshot = fresh;
        r->stamp = stamp;
    } else if (fresh) {
        run_free(&fresh->run);
        free(fresh);
    }
}

/* -- which runs ---------------------------------------------------------------------------------------------------- */

/* A run that is new among those that are watched. */
static void add(const char *folder, const char *name, void *user)
{
    Watch *w = user;
    for (size_t i = 0; i < w->n; i++)
        if (!w->run[i]->is_gone && strcmp(w->run[i]->name, name) == 0)
            return;
    Watched *r = w->n < RUNS_MAX ? calloc(1, sizeof *r) : NULL;
    if (!r)
        return;
    text_copy(r->folder, folder);
    text_copy(r->name, name);
    pthread_mutex_init(&r->mutex, NULL);
    w->run[w->n++] = r;
}

void watch_find(Watch *w)
{
    pthread_mutex_lock(&w->mutex);
    if (!w->is_run)
        runs_each(w->folder, add, w);
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
    return w->run[i]->is_gone ? NULL : w->run[i]->name;
}

/* Files of a folder, then the folder. */
static int remove_one(const char *path, const struct stat *, int, struct FTW *)
{
    return remove(path);
}

Status watch_move(Watch *w, size_t i, const char *name, Err *err)
{
    Watched *r = w->run[i];
    Folder held;
    char place[PATH_MAX];
    if (w->is_run)
        return bad_data(err, "%s: is served alone: rename or remove it from the folder that holds it", r->name);
    if (name && (!name[0] || name[0] == '.' || strchr(name, '/')))
        return bad_data(err, "'%.80s' is no name of a folder", name);
    TRY(run_wanted(r->folder, err)); /* before the lock, which would make a folder that has gone */
    TRY(folder_take(&held, r->folder, 0, err));
    folder_path(w->folder, name ? name : "", place);
    Status status = run_wanted(r->folder, err);
    if (status == STATUS_OK && (name ? renameat2(AT_FDCWD, r->folder, AT_FDCWD, place, RENAME_NOREPLACE)
                                     : nftw(r->folder, remove_one, 8, FTW_DEPTH | FTW_PHYS)) != 0)
        status = fail_errno(err, name ? place : r->folder, "cannot be made or removed");
    r->is_gone |= status == STATUS_OK;
    folder_release(&held);
    return status;
}

Status watch_open(Watch **out, const char *folder, const RecordPaths *moved, Err *err)
{
    Watch *w = *out = NULL;
    TRY_ROOM(w, 1, "runs that are watched", err);
    w->moved = moved;
    pthread_mutex_init(&w->mutex, NULL);
    Status status = realpath(folder, w->folder) ? STATUS_OK : fail_missing(err, folder);
    w->is_run = status == STATUS_OK && run_is_there(w->folder);
    if (w->is_run) {
        const char *slash = strrchr(w->folder, '/');
        add(w->folder, slash && slash[1] ? slash + 1 : w->folder, w);
    } else if (status == STATUS_OK) {
        runs_each(w->folder, add, w);
    }
    if (w->n == 0)
        THEN(status, fail(err, STATUS_MISSING, "%s: is no run, and holds none", folder));
    if (status == STATUS_OK)
        *out = w;
    else
        watch_close(w);
    return status;
}

void watch_stop(Watch *w)
{
    atomic_store(&w->stops, 1);
}

int watch_is_stopped(Watch *w)
{
    return atomic_load(&w->stops);
}

void watch_close(Watch *w)
{
    for (size_t i = 0; i < w->n; i++) {
        release(w->run[i]->view.snapshot);
        pthread_mutex_destroy(&w->run[i]->mutex);
        free(w->run[i]);
    }
    pthread_mutex_destroy(&w->mutex);
    free(w);
}

/* -- looking ------------------------------------------------------------------------------------------------------- */

Status watch_take(Watch *w, size_t i, double seconds, View *view, Err *err)
{
    Watched *r = w->run[i];
    *view = (View){0};

    /* Runs that nobody has asked for in time are released; one that is being read is left alone. */
    for (size_t k = 0, n = watch_n(w); k < n; k++) {
        Watched *other = w->run[k];
        if (pthread_mutex_trylock(&other->mutex) != 0)
            continue;
        if (clock_seconds() > other->kept_to) {
            release(other->view.snapshot);
            other->view.snapshot = NULL;
        }
        pthread_mutex_unlock(&other->mutex);
    }
    if (r->is_gone)
        return fail(err, STATUS_MISSING, "%s: was renamed or removed", r->name);
    pthread_mutex_lock(&r->mutex);
    read_again(w, r);
    r->kept_to = fmax(r->kept_to, clock_seconds() + seconds);
    if (r->view.snapshot) {
        *view = r->view;
        atomic_fetch_add(&view->snapshot->n_users, 1);
    } else {
        *err = r->view.why;
    }
    pthread_mutex_unlock(&r->mutex);
    return view->snapshot ? STATUS_OK : err->code;
}

void watch_give(View *view)
{
    release(view->snapshot);
    view->snapshot = NULL;
}

View watch_next(Watch *w, size_t i, long seen, double seconds)
{
    View view;
    for (double end = clock_seconds() + seconds; !watch_is_stopped(w) && clock_seconds() < end;) {
        if (watch_take(w, i, seconds, &view, &(Err){0}) == STATUS_OK && view.version > seen)
            return view;
        watch_give(&view);
        nanosleep(&(struct timespec){.tv_nsec = 1e9 * POLL_S}, NULL);
    }
    return (View){.version = seen};
}
