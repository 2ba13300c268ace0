#include "moga/feed.h"

#include <pthread.h>
#include <stdlib.h>
#include <string.h>

#include "base/clock.h"
#include "moga/infill.h"

typedef enum { WAITING, UNDER_WAY, ARRIVED, REPLAYED } Place; /* REPLAYED: its result is among those from before */

typedef struct {
    Place place;
    size_t name, order; /* order of arrival */
    size_t draws;
    unsigned char kind, foretold, way, ok;
    double taken; /* [s] */
} Slot;

struct Feed {
    size_t n_var, n_obj, n_con, row; /* row: numbers of one design */
    size_t n, n_max, n_named, n_arrived;
    Slot *slot;   /* (n) in the order of asking */
    double *rows; /* (n, row) x, foreseen, f, g */
    double *out;  /* (row) of the last result */
    int closed;
    double busy;
    size_t n_done;
    struct {
        size_t n, at;
        const double *X, *F, *G;
        const unsigned char *ok, *kind;
    } before;
    pthread_mutex_t lock;
    pthread_cond_t work, news;
};

static double *x_of(const Feed *q, size_t i)
{
    return q->rows + i * q->row;
}

static double *foreseen_of(const Feed *q, size_t i)
{
    return x_of(q, i) + q->n_var;
}

static double *f_of(const Feed *q, size_t i)
{
    return foreseen_of(q, i) + q->n_obj;
}

Status feed_create(Feed **out, size_t n_var, size_t n_obj, size_t n_con, Err *err)
{
    Feed *q = calloc(1, sizeof *q);
    *out = NULL;
    if (!q)
        return fail(err, STATUS_NO_MEMORY, "no memory for designs under way");
    q->n_var = n_var;
    q->n_obj = n_obj;
    q->n_con = n_con;
    q->row = n_var + 2 * n_obj + n_con;
    q->out = calloc(q->row, sizeof *q->out);
    if (!q->out) {
        free(q);
        return fail(err, STATUS_NO_MEMORY, "no memory for designs under way");
    }
    pthread_mutex_init(&q->lock, NULL);
    pthread_cond_init(&q->work, NULL);
    pthread_cond_init(&q->news, NULL);
    *out = q;
    return STATUS_OK;
}

void feed_free(Feed *q)
{
    if (!q)
        return;
    pthread_mutex_destroy(&q->lock);
    pthread_cond_destroy(&q->work);
    pthread_cond_destroy(&q->news);
    free(q->slot);
    free(q->rows);
    free(q->out);
    free(q);
}

static int grow(Feed *q)
{
    if (q->n < q->n_max)
        return 1;
    const size_t n = q->n_max > 0 ? 2 * q->n_max : 32;
    Slot *slot = realloc(q->slot, n * sizeof *slot);
    q->slot = slot ? slot : q->slot;
    double *rows = realloc(q->rows, n * q->row * sizeof *rows);
    q->rows = rows ? rows : q->rows;
    if (slot && rows)
        q->n_max = n;
    return slot && rows;
}

/* Row of the results from before that is this design and has not been given yet, or before.n. */
static size_t find_before(const Feed *q, const double x[])
{
    size_t i = q->before.at;
    while (i < q->before.n && memcmp(q->before.X + i * q->n_var, x, q->n_var * sizeof *x) != 0)
        i++;
    return i;
}

Status feed_ask(Feed *q, const double x[], const Asked *asked, Err *err)
{
    pthread_mutex_lock(&q->lock);
    const int has_room = grow(q);
    if (has_room) {
        const size_t i = q->n++;
        const int known = find_before(q, x) < q->before.n;
        q->slot[i] = (Slot){.place = known ? REPLAYED : WAITING,
                            .name = q->n_named++,
                            .draws = asked->draws,
                            .kind = asked->kind,
                            .foretold = asked->foretold,
                            .way = asked->way};
        memcpy(x_of(q, i), x, q->n_var * sizeof *x);
        if (asked->foretold)
            memcpy(foreseen_of(q, i), asked->foreseen, q->n_obj * sizeof *x);
        else
            memset(foreseen_of(q, i), 0, q->n_obj * sizeof *x);
        pthread_cond_signal(&q->work);
    }
    pthread_mutex_unlock(&q->lock);
    return has_room ? STATUS_OK : fail(err, STATUS_NO_MEMORY, "no memory for %zu designs under way", q->n);
}

/* The loop alone adds and removes designs, so that it may count and read them without the lock. */
size_t feed_pending(const Feed *q)
{
    return q->n;
}

/* The design that is asked for and is x, or n. */
static size_t find(const Feed *q, const double x[])
{
    size_t i = 0;
    while (i < q->n && memcmp(x_of(q, i), x, q->n_var * sizeof *x) != 0)
        i++;
    return i;
}

int feed_has(Feed *q, const double x[])
{
    return find(q, x) < q->n;
}

static Asked asked_of(const Slot *s, const double foreseen[])
{
    return (Asked){.draws = s->draws, .kind = s->kind, .foretold = s->foretold, .way = s->way, .foreseen = foreseen};
}

const double *feed_design(Feed *q, size_t i, Asked *asked)
{
    *asked = asked_of(&q->slot[i], foreseen_of(q, i));
    return x_of(q, i);
}

static void remove_at(Feed *q, size_t i)
{
    q->n--;
    memmove(q->slot + i, q->slot + i + 1, (q->n - i) * sizeof *q->slot);
    memmove(x_of(q, i), x_of(q, i + 1), (q->n - i) * q->row * sizeof *q->rows);
}

/* -- results ------------------------------------------------------------------------------------------------------- */

static int take_before(Feed *q, Arrived *out)
{
    const size_t b = q->before.at++;
    const double *x = q->before.X + b * q->n_var;
    const size_t i = find(q, x);
    *out = (Arrived){.asked = {.kind = q->before.kind[b]}, .x = x, .ok = q->before.ok[b]};
    if (i < q->n) {
        memcpy(q->out, x_of(q, i), q->row * sizeof *q->out);
        out->asked = asked_of(&q->slot[i], q->out + q->n_var);
        remove_at(q, i);
    }
    out->f = q->before.F + b * q->n_obj;
    out->g = q->before.G + b * q->n_con;
    return 1;
}

/* The design that arrived first, or n. */
static size_t first_arrived(const Feed *q)
{
    size_t first = q->n;
    for (size_t i = 0; i < q->n; i++)
        if (q->slot[i].place == ARRIVED && (first == q->n || q->slot[i].order < q->slot[first].order))
            first = i;
    return first;
}

static int take_arrived(Feed *q, size_t i, Arrived *out)
{
    const Slot s = q->slot[i];
    memcpy(q->out, x_of(q, i), q->row * sizeof *q->out);
    const double *foreseen = q->out + q->n_var, *f = foreseen + q->n_obj;
    *out = (Arrived){.asked = asked_of(&s, foreseen), .x = q->out, .f = f, .g = f + q->n_obj, .ok = s.ok};
    remove_at(q, i);
    return 1;
}

int feed_next(Feed *q, Arrived *out)
{
    int found = 0;
    pthread_mutex_lock(&q->lock);
    if (q->before.at < q->before.n) {
        found = take_before(q, out);
    } else {
        size_t i;
        while ((i = first_arrived(q)) == q->n && !q->closed)
            pthread_cond_wait(&q->news, &q->lock);
        if (i < q->n)
            found = take_arrived(q, i, out);
    }
    pthread_mutex_unlock(&q->lock);
    return found;
}

void feed_withdraw(Feed *q)
{
    pthread_mutex_lock(&q->lock);
    for (size_t i = q->n; i-- > 0;)
        if (q->slot[i].place == WAITING)
            remove_at(q, i);
    pthread_mutex_unlock(&q->lock);
}

void feed_replay(Feed *q, size_t n, const double X[], const double F[], const double G[], const unsigned char ok[],
                 const unsigned char kind[])
{
    pthread_mutex_lock(&q->lock);
    q->before.n = n;
    q->before.at = 0;
    q->before.X = X;
    q->before.F = F;
    q->before.G = G;
    q->before.ok = ok;
    q->before.kind = kind;
    for (size_t i = 0; i < q->n; i++)
        if (find_before(q, x_of(q, i)) < n)
            q->slot[i].place = REPLAYED;
    pthread_mutex_unlock(&q->lock);
}

void feed_pack(Feed *q, Pack *p)
{
    size_t n = q->n;
    pack_size(p, &n, SIZE_MAX / 2);
    for (size_t i = 0; i < n && !p->faulty; i++) {
        Asked asked = {0};
        double *x = q->out;
        if (!p->reading)
            memcpy(x, feed_design(q, i, &asked), (q->n_var + q->n_obj) * sizeof *x);
        size_t flags[3] = {asked.kind, asked.foretold, asked.way};
        pack(p, x, (q->n_var + q->n_obj) * sizeof *x);
        pack_size(p, &asked.draws, SIZE_MAX / 2);
        pack_size(p, &flags[0], UINT8_MAX);
        pack_size(p, &flags[1], 1);
        pack_size(p, &flags[2], INFILL_KINDS - 1);
        if (!p->reading || p->faulty)
            continue;
        asked = (Asked){asked.draws, (unsigned char)flags[0], (unsigned char)flags[1], (unsigned char)flags[2],
                        x + q->n_var};
        p->faulty = feed_ask(q, x, &asked, NULL) != STATUS_OK;
    }
}

/* -- the threads that simulate ------------------------------------------------------------------------------------- */

size_t feed_take(Feed *q, double x[], size_t *draws)
{
    size_t name = SIZE_MAX;
    pthread_mutex_lock(&q->lock);
    while (name == SIZE_MAX && !q->closed) {
        size_t i = 0;
        while (i < q->n && q->slot[i].place != WAITING)
            i++;
        if (i == q->n) {
            pthread_cond_wait(&q->work, &q->lock);
            continue;
        }
        Slot *s = &q->slot[i];
        s->place = UNDER_WAY;
        s->taken = clock_seconds();
        *draws = s->draws;
        memcpy(x, x_of(q, i), q->n_var * sizeof *x);
        name = s->name;
    }
    pthread_mutex_unlock(&q->lock);
    return name;
}

void feed_give(Feed *q, size_t name, const double f[], const double g[], int ok)
{
    pthread_mutex_lock(&q->lock);
    size_t i = 0;
    while (i < q->n && q->slot[i].name != name)
        i++;
    if (i < q->n) {
        Slot *s = &q->slot[i];
        memcpy(f_of(q, i), f, q->n_obj * sizeof *f);
        if (q->n_con > 0)
            memcpy(f_of(q, i) + q->n_obj, g, q->n_con * sizeof *g);
        s->ok = ok != 0;
        s->place = ARRIVED;
        s->order = q->n_arrived++;
        q->busy += clock_seconds() - s->taken;
        q->n_done++;
        pthread_cond_signal(&q->news);
    }
    pthread_mutex_unlock(&q->lock);
}

void feed_close(Feed *q)
{
    pthread_mutex_lock(&q->lock);
    q->closed = 1;
    pthread_cond_broadcast(&q->work);
    pthread_cond_broadcast(&q->news);
    pthread_mutex_unlock(&q->lock);
}

double feed_busy(Feed *q, size_t *n)
{
    pthread_mutex_lock(&q->lock);
    const double busy = q->busy;
    *n = q->n_done;
    pthread_mutex_unlock(&q->lock);
    return busy;
}
