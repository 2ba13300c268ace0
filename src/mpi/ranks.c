#include <inttypes.h>
#include <mpi.h>
#include <pthread.h>
#include <stdatomic.h>
#include <unistd.h>

#include "base/clock.h"
#include "mpi/message.h"

/* Tasks go to a worker for so long in all, so that the way of a message is little beside them; of tasks that take
 * longer than SINGLE_S one at a time, so that a short batch ends earlier. */
static const double AHEAD_S = 0.005, SINGLE_S = 0.2;

static const double PAUSE_MAX_S = 5e-4;

/* To read records and build scenes, on machines that share a file system. */
static const double OPEN_S = 600.0;

typedef struct {
    Opened opened;
    Task opening;
    size_t n_workers; /* that are asked */
} Rank;

typedef struct {
    const Problem *problem;
    Rank *rank;     /* (n + 1); [0], this one, is not used */
    size_t n_seats; /* workers of all */
    Pool pool[2];   /* those who open the problem, one of each rank, and two for each of their workers: while
                   * one is done, another waits */
    int is_open;
    int64_t epoch;
    atomic_int ending;
    int is_running;
    pthread_t thread;
    pthread_mutex_t lock; /* who has it may call MPI */
} Ranks;

typedef struct {
    int rank, tag;
} Seat;

/* Where a worker of the pool sits. */
static Seat seat_of(const Ranks *r, size_t worker)
{
    int i = 1;
    for (worker %= r->n_seats; worker >= r->rank[i].n_workers; i++)
        worker -= r->rank[i].n_workers;
    return (Seat){i, r->is_open ? TAG_TASK + (int)worker : TAG_OPEN};
}

/* -- messages ------------------------------------------------------------------------------------------------------ */

/* Receive messages and give each to whom it concerns: an answer to the worker that waits for it, whatever else, as a
 * sign of life, to all of the rank. What should be an answer and is none goes to them all the same: it is no good
 * one. */
static void *receive(void *user)
{
    Ranks *r = user;
    for (double pause = PAUSE_MIN_S; !r->ending;) {
        Message m;
        pthread_mutex_lock(&r->lock);
        const int there = message_receive(MPI_ANY_SOURCE, MPI_ANY_TAG, &m);
        const Pool *p = &r->pool[r->is_open];
        const Answer *a = there ? m.bytes : NULL;
        const int is_answer = there && m.tag == TAG_DONE && (m.n < sizeof *a || a->epoch == r->epoch);
        const int is_right = is_answer && is_answer_of(a, m.n, p->n_workers) && seat_of(r, a->worker).rank == m.from;
        if (there && !is_right) {
            free(m.bytes);
            m = (Message){.from = m.from, .tag = is_answer ? TAG_DONE : TAG_ALIVE};
        }
        const size_t whose = is_right ? a->worker : 0; /* who is given the bytes frees them */
        for (size_t i = 0; there && i < p->n_workers; i++)
            if (is_right ? i == whose : seat_of(r, i).rank == m.from)
                if (write(p->worker[i].in, &m, sizeof m) < 0)
                    continue; /* it is full of signs of life */
        pthread_mutex_unlock(&r->lock);
        pause = there ? PAUSE_MIN_S : longer_pause(pause, PAUSE_MAX_S);
        if (!there)
            pause_s(pause);
    }
    return NULL;
}

/* -- as workers of a pool ------------------------------------------------------------------------------------------ */

static size_t write_order(void *self, const Worker *w, char *request)
{
    const Ranks *r = self;
    Order *order = (void *)request;
    order->epoch = r->epoch;
    order->worker = w - w->pool->worker;
    return order_write(order, w, r->is_open ? r->problem->n_var : r->problem->recipe_size / sizeof(double));
}

/* The message has come when its answer has. */
static void send_order(void *self, const Worker *w)
{
    Ranks *r = self;
    const Seat seat = seat_of(r, w - w->pool->worker);
    MPI_Request request;
    pthread_mutex_lock(&r->lock);
    MPI_Isend(w->request, (int)w->n_request, MPI_BYTE, seat.rank, seat.tag, MPI_COMM_WORLD, &request);
    MPI_Request_free(&request);
    pthread_mutex_unlock(&r->lock);
}

/* A rank that is not to be asked any more ends everything. */
static void tell(void *self, Worker *w, Outcome outcome, const char *)
{
    const Ranks *r = self;
    const int i = seat_of(r, w - w->pool->worker).rank;
    if (outcome == OUTCOME_TIMEOUT)
        fail(&w->why, STATUS_STOPPED, "rank %d on %s was taken for dead (silent for %g s)", i, r->rank[i].opened.host,
             w->pool->protocol.timeout_s);
    else
        fail(&w->why, STATUS_INTERNAL, "rank %d on %s sends results of tasks that it does not have", i,
             r->rank[i].opened.host);
    w->n = w->n_done;
}

/* Take the messages of a worker. By how long its tasks took it gets more or fewer at once. */
static void look(void *, Worker *w)
{
    Message m;
    for (size_t at = 0; at < w->n_line; at += sizeof m) { /* written whole */
        memcpy(&m, w->line + at, sizeof m);
        const Answer *a = m.bytes;
        w->silent_s = 0.0;
        if (m.tag == TAG_DONE && (!a || !order_take(a, m.n, w)))
            pool_settle(w, OUTCOME_GARBLED, 0, "%s", "");
        else if (a && a->n_done > 0 && a->seconds < SINGLE_S * (double)a->n_done)
            pool_batch(w, (size_t)fmin(ceil(AHEAD_S * (double)a->n_done / a->seconds), TASKS_MAX));
        else if (a)
            pool_batch(w, 1);
        free(m.bytes);
    }
    w->n_line = 0;
}

static Pool *pool(void *self)
{
    return &((Ranks *)self)->pool[1];
}

/* -- life ---------------------------------------------------------------------------------------------------------- */

/* The pool of those who open the problem, or of the workers of all. */
static Status open_pool(Ranks *r, int is_open, size_t n, Err *err)
{
    const Problem *p = r->problem;
    const Protocol protocol = {.name = "mpi",
                               .request_bytes = order_bytes(1, is_open ? p->n_var : p->recipe_size / sizeof *p->lower),
                               .timeout_s = is_open ? SILENT_S : OPEN_S,
                               .grace_s = 0.6, /* mpirun allows a second before it kills */
                               .write = write_order,
                               .send = send_order,
                               .look = look,
                               .tell = tell,
                               .self = r};
    return pool_open(&r->pool[is_open], &protocol, n, err);
}

/* The thread that receives ends before what it writes to. */
static void stop(void *self)
{
    Ranks *r = self;
    r->ending = 1;
    if (r->is_running)
        pthread_join(r->thread, NULL);
    pool_close(r->pool);
    pool_close(&r->pool[1]);
    pthread_mutex_destroy(&r->lock);
    free(r->rank);
    free(r);
}

/* Let every rank open the problem, and learn how many workers each has. */
static Status start(void **self, const Problem *p, size_t *n_workers, Err *err)
{
    size_t n;
    Ranks *r;

    /* 1. All ranks, and a thread that hears them. */
    TRY_ROOM(r, 1, "a set of ranks", err);
    *self = r;
    pthread_mutex_init(&r->lock, NULL);
    cluster_executor(&n);
    r->n_seats = n;
    r->problem = p;
    r->epoch = (int64_t)(1e9 * clock_seconds());
    TRY_ROOM(r->rank, n + 1, "ranks", err);
    for (size_t i = 1; i <= n; i++)
        r->rank[i].n_workers = 1;
    TRY(open_pool(r, 0, n, err));
    r->is_running = pthread_create(&r->thread, NULL, receive, r) == 0;
    if (!r->is_running)
        return fail(err, STATUS_NO_MEMORY, "no thread for %zu ranks", n);

    /* 2. Each opens the problem: a task whose x is the recipe, and whose part is Opened. */
    for (size_t i = 1; i <= n; i++) {
        Rank *rank = &r->rank[i];
        rank->opening =
            (Task){.x = p->recipe, .result = &rank->opened, .size = sizeof rank->opened, .observer = &p->observer};
        TRY(pool_ask(&r->pool[0].worker[i - 1], 1, &rank->opening, err));
    }
    *n_workers = 0;
    for (size_t i = 1; i <= n; i++) {
        const Opened *o = &r->rank[i].opened;
        TRY(pool_wait(&r->pool[0].worker[i - 1], err));
        if (o->inputs != p->inputs)
            return bad_data(err,
                            "rank %zu on %s reads other files than rank 0 (content %016" PRIx64 ", here %016" PRIx64
                            "): records and building must be the same on every machine",
                            i, o->host, o->inputs, p->inputs);
        *n_workers += o->n_workers;
    }

    /* 3. From now on their workers are asked. */
    TRY(open_pool(r, 1, 2 * *n_workers, err));
    pthread_mutex_lock(&r->lock);
    r->n_seats = *n_workers;
    for (size_t i = 1; i <= n; i++)
        r->rank[i].n_workers = r->rank[i].opened.n_workers;
    r->is_open = 1;
    pthread_mutex_unlock(&r->lock);
    return STATUS_OK;
}

static const Simulator ON_RANKS = {.pool = pool};

const Executor EXECUTOR_RANKS = {.start = start, .stop = stop, .simulator = &ON_RANKS};
