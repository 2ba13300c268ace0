#include <mpi.h>
#include <pthread.h>
#include <stdatomic.h>

#include "base/clock.h"
#include "mpi/message.h"

/* A look at the messages at least so often: a worker for its next task, and the rank for what else is said. */
static const double PAUSE_MAX_S = 1e-3, PAUSE_BUSY_S = 1e-2;

/* When rank 0 has left, what is under way gets so long to end. */
static const double FAREWELL_S = 0.3;

typedef struct Service Service;

typedef struct {
    Service *service;
    int number;
    pthread_t thread;
    Answer *answer; /* the last one, which is on its way */
    MPI_Request request;
} Seat;

struct Service {
    ReopenFn reopen;
    Problem problem;               /* {0}: none is open */
    Message held, heard;           /* of which it was made; the last one */
    atomic_int closing, n_running; /* closing: tasks under way are to end */
    Seat *seat;
    size_t n_workers;        /* that run */
    pthread_mutex_t talking; /* who calls MPI */
    int has_said_left, rank;
    double said_s;
};

static void say(Service *s, int tag)
{
    pthread_mutex_lock(&s->talking);
    if (!s->has_said_left)
        MPI_Send(NULL, 0, MPI_BYTE, 0, tag, MPI_COMM_WORLD);
    s->has_said_left |= tag == TAG_LEFT;
    s->said_s = clock_seconds();
    pthread_mutex_unlock(&s->talking);
}

static int hear(Service *s, int tag, Message *m)
{
    pthread_mutex_lock(&s->talking);
    const int there = message_receive(0, tag, m);
    pthread_mutex_unlock(&s->talking);
    return there;
}

/* -- tasks --------------------------------------------------------------------------------------------------------- */

static int may_go_on(void *user)
{
    return !((Service *)user)->closing;
}

/* The answer is not waited for, but the one before. */
static void do_order(Seat *w, Order *order, const Simulator *simulator, void *self)
{
    Service *s = w->service;
    const Observer observer = {.go_on = may_go_on, .user = s};
    const Doer doer = {simulator, self, s->problem.n_var, &observer};
    size_t n;
    Answer *a = order_do(order, w->number, &doer, &n);
    if (!a)
        MPI_Abort(MPI_COMM_WORLD, status_exit_code(STATUS_NO_MEMORY));
    pthread_mutex_lock(&s->talking);
    MPI_Wait(&w->request, MPI_STATUS_IGNORE);
    free(w->answer);
    w->answer = a;
    if (!s->has_said_left)
        MPI_Isend(a, (int)n, MPI_BYTE, 0, TAG_DONE, MPI_COMM_WORLD, &w->request);
    pthread_mutex_unlock(&s->talking);
}

/* One worker of this rank: does the orders that come for it until the problem is closed. */
static void *work(void *user)
{
    Seat *w = user;
    Service *s = w->service;
    Message m;
    for (double pause = PAUSE_MIN_S; !s->closing; pause = longer_pause(pause, PAUSE_MAX_S)) {
        if (!hear(s, TAG_TASK + w->number, &m)) {
            pause_s(pause);
            continue;
        }
        s->n_running++;
        do_order(w, m.bytes, s->problem.simulator, s->problem.self);
        s->n_running--;
        free(m.bytes);
        pause = PAUSE_MIN_S;
    }
    return NULL;
}

/* -- the problem --------------------------------------------------------------------------------------------------- */

/* Workers end before what they work on, and answers that are on their way before their bytes. */
static void close_problem(Service *s)
{
    s->closing = 1;
    for (size_t i = 0; i < s->n_workers; i++) {
        pthread_join(s->seat[i].thread, NULL);
        MPI_Wait(&s->seat[i].request, MPI_STATUS_IGNORE);
        free(s->seat[i].answer);
    }
    s->n_workers = 0;
    s->closing = 0;
    free(s->seat);
    s->seat = NULL;
    problem_close(&s->problem);
    free(s->held.bytes);
    s->held = (Message){0};
}

/* Open the problem of a recipe, which is kept, and start its workers. A problem that is open already stays so. */
static Status open_problem(void *self, size_t, const Task *task, Err *err)
{
    Service *s = self;
    Opened *opened = task->result;
    const size_t before = order_bytes(1, 0), n = s->heard.n - before;
    Status status = STATUS_OK;
    Err why = {0};
    if (s->heard.n != s->held.n || memcmp(task->x, (const char *)s->held.bytes + before, n) != 0) {
        close_problem(s);
        s->held = s->heard;
        s->heard.bytes = NULL;
        status = s->reopen(&s->problem, task->x, n, &why);
        s->seat = status == STATUS_OK ? calloc(s->problem.n_workers, sizeof *s->seat) : NULL;
        if (status == STATUS_OK && !s->seat)
            status = fail_memory(&why, s->problem.n_workers, "threads");
    }
    for (; status == STATUS_OK && s->n_workers < s->problem.n_workers; s->n_workers++) {
        Seat *w = &s->seat[s->n_workers];
        *w = (Seat){.service = s, .number = (int)s->n_workers, .request = MPI_REQUEST_NULL};
        if (pthread_create(&w->thread, NULL, work, w) != 0) {
            status = fail(&why, STATUS_NO_MEMORY, "no thread for the simulations (%zu of %zu)", s->n_workers + 1,
                          s->problem.n_workers);
            break;
        }
    }
    *opened = (Opened){.inputs = s->problem.inputs, .n_workers = s->n_workers};
    host_name(opened->host);
    if (status == STATUS_OK)
        return STATUS_OK;
    s->held.n = 0;
    return fail(err, status, "rank %d on %s: %s", s->rank, opened->host, why.text);
}

static const Simulator OPENS = {.simulate = open_problem};

/* -- life ---------------------------------------------------------------------------------------------------------- */

/* Open problems and say that this rank lives until rank 0 says that it is over; then leave. A task that takes longer
 * than a moment ends with the process. */
Status serve(ReopenFn reopen, Err *err)
{
    Service *s;
    TRY_ROOM(s, 1, "a rank", err);
    Message *m = &s->heard;
    Seat opener = {.service = s, .request = MPI_REQUEST_NULL};
    double pause = PAUSE_MIN_S;
    s->reopen = reopen;
    MPI_Comm_rank(MPI_COMM_WORLD, &s->rank);
    pthread_mutex_init(&s->talking, NULL);
    for (m->n = 1; m->n > 0;) {
        if (hear(s, TAG_OPEN, m)) {
            if (m->n > 0)
                do_order(&opener, m->bytes, &OPENS, s);
            free(m->bytes);
            pause = PAUSE_MIN_S;
        }
        if (s->n_running > 0 && clock_seconds() > s->said_s + ALIVE_S)
            say(s, TAG_ALIVE);
        pause = longer_pause(pause, s->n_running > 0 ? PAUSE_BUSY_S : PAUSE_MAX_S);
        pause_s(pause);
    }
    s->closing = 1;
    for (const double until = clock_seconds() + FAREWELL_S; s->n_running > 0 && clock_seconds() < until;)
        pause_s(1e-3);
    const int is_busy = s->n_running > 0;
    say(s, TAG_LEFT);
    if (!is_busy) {
        close_problem(s);
        free(s);
    }
    return STATUS_OK;
}
