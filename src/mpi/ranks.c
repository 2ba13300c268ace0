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
    size_t n_heard;
    int is_wrong;
    Task opening;
} Rank;

/* A worker of a rank. */
typedef struct {
    Errand errand;
    Ranks *ranks;
    int rank, number, is_asked; /* number: of the rank's workers */
    size_t n_heard;             /* of the rank, at the last look */
    Order *order;               /* the last one that was sent */
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
    double task_s; /* [s] a task takes, over the last ones */
    atomic_int ending;
    int is_running;
    pthread_t thread;
    pthread_mutex_t lock, talking; /* talking: who calls MPI */
};

/* -- messages ------------------------------------------------------------------------------------------------------ */

/* Of a task that was given up meanwhile nothing is taken. */
static void hear(Ranks *r, Message *m)
{
    const Answer *a = m->bytes;
    Rank *rank = &r->rank[m->from];
    pthread_mutex_lock(&r->lock);
    rank->n_heard++;
    if (m->tag == TAG_DONE && (m->n < sizeof *a || a->epoch == r->epoch)) {
        Proxy *p = is_answer(a, m->n, r->n_proxies) ? &r->proxy[a->worker] : NULL;
        rank->is_wrong |= !p || p->rank != m->from;
        if (!rank->is_wrong && p->is_asked) {
            p->is_asked = 0;
            p->answer = *m;
            m->bytes = NULL;
            pthread_cond_signal(&p->news);
        }
    }
    pthread_mutex_unlock(&r->lock);
    free(m->bytes);
}

static void *receive(void *user)
{
    Ranks *r = user;
    double pause = PAUSE_MIN_S;
    while (!r->ending) {
        Message m;
        pthread_mutex_lock(&r->talking);
        const int there = message_receive(MPI_ANY_SOURCE, MPI_ANY_TAG, &m);
        pthread_mutex_unlock(&r->talking);
        if (there)
            hear(r, &m);
        else
            pause_s(pause);
        pause = there ? PAUSE_MIN_S : longer_pause(pause, PAUSE_MAX_S);
    }
    return NULL;
}

/* The tasks of its errand, and what is `more`. The message has come when its answer has. */
static Status send(Proxy *p, int tag, size_t n_var, const void *more, size_t n_more, Err *err)
{
    Ranks *r = p->ranks;
    MPI_Request request;
    const size_t n = order_bytes(p->errand.n, n_var);
    p->order = calloc(1, n + n_more);
    if (!p->order)
        return fail_memory(err, p->errand.n, "tasks under way");
    order_write(p->order, &p->errand, n_var);
    memcpy((char *)p->order + n, more, n_more);
    p->order->epoch = r->epoch;
    p->order->worker = p - r->proxy;
    pthread_mutex_lock(&r->lock);
    p->is_asked = 1;
    pthread_mutex_unlock(&r->lock);
    pthread_mutex_lock(&r->talking);
    MPI_Isend(p->order, (int)(n + n_more), MPI_BYTE, p->rank, tag, MPI_COMM_WORLD, &request);
    MPI_Request_free(&request);
    pthread_mutex_unlock(&r->talking);
    return STATUS_OK;
}

/* -- as a worker of the pool --------------------------------------------------------------------------------------- */

static int take_answer(Proxy *p)
{
    Ranks *r = p->ranks;
    const Answer *a = p->answer.bytes;
    const int is_taken = order_take(a, p->answer.n, &p->errand);
    free(p->order);
    if (is_taken && a->n_done > 0) {
        const double task_s = a->seconds / (double)a->n_done;
        pthread_mutex_lock(&r->lock);
        r->task_s = r->task_s > 0.0 ? 0.95 * r->task_s + 0.05 * task_s : task_s;
        pthread_mutex_unlock(&r->lock);
    }
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
    if (p->is_asked)
        pthread_cond_clockwait(&p->news, &r->lock, CLOCK_MONOTONIC, &at);
    if (rank->n_heard != p->n_heard)
        e->silent_s = 0.0;
    p->n_heard = rank->n_heard;
    const int is_wrong = rank->is_wrong, is_there = !p->is_asked;
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

/* Nothing is said: a rank hears of the end. */
static void stop_one(Errand *e, int at_once)
{
    Proxy *p = (Proxy *)e;
    pthread_mutex_lock(&p->ranks->lock);
    p->is_asked &= !at_once;
    pthread_mutex_unlock(&p->ranks->lock);
}

/* mpirun allows a second before it kills. */
static const Transport RANKS = {.grace_s = 0.6, .listen = listen_to, .lose = lose, .stop = stop_one};

static Status simulate_batch(void *self, size_t worker, size_t n, const Task tasks[], size_t *n_done, Err *err)
{
    Ranks *r = self;
    Proxy *p = &r->proxy[worker];
    p->errand = (Errand){.task = tasks, .n = n, .limit_s = SILENT_S};
    *n_done = 0;
    TRY(send(p, TAG_TASK + p->number, r->problem->n_var, NULL, 0, err));
    const Status status = pool_wait(&RANKS, &p->errand, err);
    *n_done = p->errand.n_done;
    return status;
}

static Status simulate(void *self, size_t worker, const Task *task, Err *err)
{
    size_t n_done;
    return simulate_batch(self, worker, 1, task, &n_done, err);
}

static size_t batch(void *self, size_t worker)
{
    (void)worker;
    Ranks *r = self;
    pthread_mutex_lock(&r->lock);
    const double task_s = r->task_s;
    pthread_mutex_unlock(&r->lock);
    return task_s > 0.0 && task_s < SINGLE_S ? (size_t)fmin(ceil(AHEAD_S / task_s), TASKS_MAX) : 1;
}

/* -- life ---------------------------------------------------------------------------------------------------------- */

/* As many as the ranks have workers. */
static Status make_proxies(Ranks *r, Err *err)
{
    size_t n = 0;
    Proxy *p;
    for (int i = 1; i <= r->n; i++)
        n += r->rank[i].opened.n_workers;
    TRY_ROOM(p, n, "workers", err);
    pthread_mutex_lock(&r->lock);
    r->proxy = p;
    r->n_proxies = n;
    for (int i = 1; i <= r->n; i++)
        for (size_t k = 0; k < r->rank[i].opened.n_workers; k++, p++) {
            *p = (Proxy){.ranks = r, .rank = i, .number = (int)k};
            pthread_cond_init(&p->news, NULL);
        }
    pthread_mutex_unlock(&r->lock);
    return STATUS_OK;
}

static void free_proxies(Proxy *proxy, size_t n)
{
    for (size_t i = 0; i < n; i++) {
        free(proxy[i].answer.bytes);
        pthread_cond_destroy(&proxy[i].news);
    }
    free(proxy);
}

static int go_on(void *observer)
{
    const Observer *o = observer;
    return !o->go_on || o->go_on(o->user);
}

/* One proxy of each rank asks it to open the problem. */
static Status open_problem(Ranks *r, Err *err)
{
    const Problem *p = r->problem;
    for (int i = 1; i <= r->n; i++) {
        Rank *rank = &r->rank[i];
        Proxy *proxy = &r->proxy[i - 1];
        rank->opening = (Task){.result = &rank->opened,
                               .size = sizeof rank->opened,
                               .may_go_on = go_on,
                               .user = (void *)(uintptr_t)&p->observer};
        proxy->errand = (Errand){.task = &rank->opening, .n = 1, .limit_s = OPEN_S};
        TRY(send(proxy, TAG_OPEN, 0, p->recipe, p->recipe_size, err));
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
    free_proxies(r->proxy, r->n_proxies);
    pthread_mutex_destroy(&r->lock);
    pthread_mutex_destroy(&r->talking);
    free(r->rank);
    free(r);
}

static Status start(void **self, Queue *q, Err *err)
{
    size_t n;
    Ranks *r;
    TRY_ROOM(r, 1, "a set of ranks", err);
    *self = r;
    pthread_mutex_init(&r->lock, NULL);
    pthread_mutex_init(&r->talking, NULL);
    cluster_executor(&n);
    r->problem = queue_problem(q);
    r->epoch = (int64_t)(1e9 * clock_seconds());
    TRY_ROOM(r->rank, n + 1, "ranks", err);
    for (r->n = (int)n; n > 0; n--)
        r->rank[n].opened.n_workers = 1;
    TRY(make_proxies(r, err));
    r->is_running = pthread_create(&r->thread, NULL, receive, r) == 0;
    if (!r->is_running)
        return fail(err, STATUS_NO_MEMORY, "no thread for %d ranks", r->n);
    TRY(open_problem(r, err));
    Proxy *opening = r->proxy;
    const Status status = make_proxies(r, err);
    if (status == STATUS_OK)
        free_proxies(opening, r->n);
    return status;
}

static size_t n_workers(const void *self)
{
    return ((const Ranks *)self)->n_proxies;
}

static const Simulator ON_RANKS = {.simulate = simulate, .batch = batch, .simulate_batch = simulate_batch};

const Executor EXECUTOR_RANKS = {.start = start, .stop = stop, .n_workers = n_workers, .simulator = &ON_RANKS};
