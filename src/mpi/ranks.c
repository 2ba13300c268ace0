#include <inttypes.h>
#include <mpi.h>
#include <pthread.h>
#include <stdatomic.h>

#include "base/clock.h"
#include "evaluate/tasks.h"
#include "mpi/message.h"

/* Tasks go to a worker for so long in all, so that the way of a message is little beside them; of tasks that take longer
 * than SINGLE_S one at a time, so that a short batch ends earlier. */
static const double AHEAD_S = 0.04, SINGLE_S = 0.2;

static const double PAUSE_MAX_S = 5e-4;

/* To read records and build scenes, on machines that share a file system. */
static const double OPEN_S = 600.0;

typedef struct Ranks Ranks;

typedef struct {
    Opened opened;
    Task opening;
    size_t n_heard;
    int is_wrong;
} Rank;

/* A worker of a rank. */
typedef struct {
    Errand errand;
    Ranks *ranks;
    int rank, number; /* number: of the rank's workers */
    size_t n_heard;   /* of the rank, at the last look */
    Order *order;
    Message answer;
    pthread_cond_t news;
} Proxy;

struct Ranks {
    const Problem *problem;
    int n;
    Rank *rank; /* (n + 1); [0], this one, is not used */
    size_t n_proxies;
    Proxy *proxy;
    int64_t epoch;
    _Atomic double task_s; /* [s] a task takes, over the last ones */
    atomic_int ending;
    int is_running;
    pthread_t thread;
    pthread_mutex_t lock; /* who has it may call MPI */
};

/* -- messages ------------------------------------------------------------------------------------------------------ */

/* What comes is for the proxy that waits for it; r->lock is held. */
static void hear(Ranks *r, const Message *m)
{
    const Answer *a = m->bytes;
    Rank *rank = &r->rank[m->from];
    Proxy *p = NULL;
    rank->n_heard++;
    if (m->tag == TAG_DONE && (m->n < sizeof *a || a->epoch == r->epoch)) {
        p = is_answer(a, m->n, r->n_proxies) ? &r->proxy[a->worker] : NULL;
        rank->is_wrong |= !p || p->rank != m->from || p->answer.bytes;
    }
    if (!p || rank->is_wrong) {
        free(m->bytes);
        return;
    }
    p->answer = *m;
    pthread_cond_signal(&p->news);
}

static void *receive(void *user)
{
    Ranks *r = user;
    double pause = PAUSE_MIN_S;
    while (!r->ending) {
        Message m;
        pthread_mutex_lock(&r->lock);
        const int there = message_receive(MPI_ANY_SOURCE, MPI_ANY_TAG, &m);
        if (there)
            hear(r, &m);
        pthread_mutex_unlock(&r->lock);
        pause = there ? PAUSE_MIN_S : longer_pause(pause, PAUSE_MAX_S);
        if (!there)
            pause_s(pause);
    }
    return NULL;
}

/* Sends an errand; the message has come when its answer has. */
static Status ask(Proxy *p, const Errand *errand, size_t n_var, Err *err)
{
    const size_t n = order_bytes(errand->n, n_var);
    Ranks *r = p->ranks;
    MPI_Request request;
    p->errand = *errand;
    p->order = calloc(1, n);
    if (!p->order)
        return fail_memory(err, errand->n, "tasks under way");
    order_write(p->order, errand, n_var);
    p->order->epoch = r->epoch;
    p->order->worker = p - r->proxy;
    pthread_mutex_lock(&r->lock);
    MPI_Isend(p->order, (int)n, MPI_BYTE, p->rank, TAG_TASK + p->number, MPI_COMM_WORLD, &request);
    MPI_Request_free(&request);
    pthread_mutex_unlock(&r->lock);
    return STATUS_OK;
}

/* -- as a worker of the pool --------------------------------------------------------------------------------------- */

static int take_answer(Proxy *p)
{
    Ranks *r = p->ranks;
    const Answer *a = p->answer.bytes;
    const int is_taken = order_take(a, p->answer.n, &p->errand);
    const double task_s = a->seconds / (double)p->errand.n;
    if (is_taken && a->n_done > 0)
        r->task_s = r->task_s > 0.0 ? 0.95 * r->task_s + 0.05 * task_s : task_s;
    free(p->order);
    free(p->answer.bytes);
    p->answer.bytes = NULL;
    return is_taken;
}

static int listen_to(Errand *e, double seconds)
{
    Proxy *p = (Proxy *)e;
    Ranks *r = p->ranks;
    const Rank *rank = &r->rank[p->rank];
    const double until = clock_seconds() + seconds;
    const struct timespec at = {(time_t)until, (long)(1e9 * (until - floor(until)))};
    pthread_mutex_lock(&r->lock);
    if (!p->answer.bytes)
        pthread_cond_clockwait(&p->news, &r->lock, CLOCK_MONOTONIC, &at);
    if (rank->n_heard != p->n_heard)
        e->silent_s = 0.0;
    p->n_heard = rank->n_heard;
    const int is_wrong = rank->is_wrong, is_there = p->answer.bytes != NULL;
    pthread_mutex_unlock(&r->lock);
    return is_wrong || (is_there && !take_answer(p));
}

static Status lose(Errand *e, int is_wrong, Err *err)
{
    const Proxy *p = (const Proxy *)e;
    const char *host = p->ranks->rank[p->rank].opened.host;
    return is_wrong
               ? fail(err, STATUS_INTERNAL, "rank %d on %s sends results of tasks that it does not have", p->rank, host)
               : fail(err, STATUS_STOPPED, "rank %d on %s was taken for dead (silent for %g s)", p->rank, host,
                      e->limit_s);
}

/* mpirun allows a second before it kills. */
static const Transport RANKS = {.grace_s = 0.6, .listen = listen_to, .lose = lose};

static Status simulate(void *self, size_t worker, size_t n, const Task tasks[], size_t *n_done, Err *err)
{
    Ranks *r = self;
    Proxy *p = &r->proxy[worker];
    *n_done = 0;
    TRY(ask(p, &(Errand){.task = tasks, .n = n, .limit_s = SILENT_S}, r->problem->n_var, err));
    const Status status = pool_wait(&RANKS, &p->errand, err);
    *n_done = p->errand.n_done;
    return status;
}

static size_t batch(void *self, size_t worker)
{
    (void)worker;
    const double task_s = ((Ranks *)self)->task_s;
    return task_s > 0.0 && task_s < SINGLE_S ? (size_t)fmin(ceil(AHEAD_S / task_s), TASKS_MAX) : 1;
}

/* -- life ---------------------------------------------------------------------------------------------------------- */

static void free_proxies(Ranks *r)
{
    for (size_t i = 0; i < r->n_proxies; i++) {
        free(r->proxy[i].answer.bytes);
        pthread_cond_destroy(&r->proxy[i].news);
    }
    free(r->proxy);
}

/* As many as the ranks have workers, from number `first` on, in the place of those that there are. */
static Status make_proxies(Ranks *r, int first, Err *err)
{
    size_t n = 0;
    Proxy *p;
    for (int i = 1; i <= r->n; i++)
        n += r->rank[i].opened.n_workers;
    TRY_ROOM(p, n, "workers", err);
    pthread_mutex_lock(&r->lock);
    free_proxies(r);
    r->proxy = p;
    r->n_proxies = n;
    for (int i = 1; i <= r->n; i++)
        for (size_t k = 0; k < r->rank[i].opened.n_workers; k++, p++) {
            *p = (Proxy){.ranks = r, .rank = i, .number = first + (int)k};
            pthread_cond_init(&p->news, NULL);
        }
    pthread_mutex_unlock(&r->lock);
    return STATUS_OK;
}

static int go_on(void *observer)
{
    const Observer *o = observer;
    return !o->go_on || o->go_on(o->user);
}

/* Every rank has a worker that opens problems: a task whose x is the recipe, and its part Opened. */
static Status open_problem(Ranks *r, Err *err)
{
    const Problem *p = r->problem;
    for (int i = 1; i <= r->n; i++) {
        Rank *rank = &r->rank[i];
        rank->opening = (Task){.x = p->recipe,
                               .result = &rank->opened,
                               .size = sizeof rank->opened,
                               .may_go_on = go_on,
                               .user = (void *)(uintptr_t)&p->observer};
        TRY(ask(&r->proxy[i - 1], &(Errand){.task = &rank->opening, .n = 1, .limit_s = OPEN_S},
                p->recipe_size / sizeof(double), err));
    }
    for (int i = 1; i <= r->n; i++) {
        const Opened *o = &r->rank[i].opened;
        TRY(pool_wait(&RANKS, &r->proxy[i - 1].errand, err));
        if (o->inputs != p->inputs)
            return bad_data(err,
                            "rank %d on %s reads other files than rank 0 (content %016" PRIx64 ", here %016" PRIx64
                            "): records and building must be the same on every machine",
                            i, o->host, o->inputs, p->inputs);
    }
    return STATUS_OK;
}

static void stop(void *self)
{
    Ranks *r = self;
    r->ending = 1;
    if (r->is_running)
        pthread_join(r->thread, NULL);
    free_proxies(r);
    pthread_mutex_destroy(&r->lock);
    free(r->rank);
    free(r);
}

static Status start(void **self, Queue *q, size_t *n_workers, Err *err)
{
    size_t n;
    Ranks *r;
    TRY_ROOM(r, 1, "a set of ranks", err);
    *self = r;
    pthread_mutex_init(&r->lock, NULL);
    cluster_executor(&n);
    r->problem = queue_problem(q);
    r->epoch = (int64_t)(1e9 * clock_seconds());
    TRY_ROOM(r->rank, n + 1, "ranks", err);
    for (r->n = (int)n; n > 0; n--)
        r->rank[n].opened.n_workers = 1;
    TRY(make_proxies(r, OPENER, err));
    r->is_running = pthread_create(&r->thread, NULL, receive, r) == 0;
    if (!r->is_running)
        return fail(err, STATUS_NO_MEMORY, "no thread for %d ranks", r->n);
    TRY(open_problem(r, err));
    TRY(make_proxies(r, 0, err));
    *n_workers = r->n_proxies;
    return STATUS_OK;
}

static const Simulator ON_RANKS = {.batch = batch, .simulate_batch = simulate};

const Executor EXECUTOR_RANKS = {.start = start, .stop = stop, .simulator = &ON_RANKS};
