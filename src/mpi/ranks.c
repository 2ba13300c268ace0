#include <inttypes.h>
#include <mpi.h>
#include <pthread.h>
#include <stdatomic.h>

#include "base/clock.h"
#include "evaluate/tasks.h"
#include "mpi/message.h"

/* Tasks wait at a rank for so long in all, so that it has the next ones when it is done; where a task takes longer than
 * PREFETCH_MAX_S the way of a message, a millisecond, is nothing, and none waits: a short batch ends earlier. */
static const double AHEAD_S = 0.02, PREFETCH_MAX_S = 0.2;
enum { DEPTH_MAX = 64 }; /* tasks of a worker, the one under way included */

static const double PAUSE_MAX_S = 5e-4, LOOK_S = 0.05;

/* After a stop: as long as results come, and so long after the last one. mpirun allows a second before it kills. */
static const double LAST_ANSWERS_S = 0.6;

/* To read records and build scenes, on machines that share a file system. */
static const double OPEN_S = 600.0;

enum { MESSAGES_AT_ONCE = 64 };

typedef struct {
    size_t n_workers, n_under_way;
    double silent_s;
    char host[HOST_MAX];
} Rank;

typedef struct {
    Task task;
    int rank;             /* that does it; 0: none */
    MPI_Request request;  /* of the message, which has come when its result does */
    TaskMessage *message; /* NULL: none was ever sent */
} Ticket;

typedef struct {
    Queue *queue;
    const Problem *problem;
    int n;
    Rank *rank; /* (n + 1); [0], this one, is not used */
    Ticket *ticket;
    size_t *idle; /* (n_idle) tickets */
    size_t n_tickets, n_idle, n_under_way;
    void *in; /* (in_max) bytes of the message at hand */
    size_t in_max;
    int64_t epoch;
    double task_s; /* [s] a task takes, over the last ones */
    double looked_s, came_s;
    int has_stopped;
    atomic_int ending;
    int is_running;
    pthread_t thread;
} Ranks;

/* -- receiving ----------------------------------------------------------------------------------------------------- */

static void give(Ranks *r, Ticket *t, Status status, const Err *why)
{
    Rank *rank = &r->rank[t->rank];
    t->rank = 0;
    rank->n_under_way--;
    r->n_under_way--;
    queue_give(r->queue, &t->task, status, why);
    r->idle[r->n_idle++] = t - r->ticket;
}

/* Tasks of that rank, 0: of all, count as never begun where the status is STATUS_STOPPED. */
static void give_up(Ranks *r, int rank, Status status, const char *words)
{
    Err why;
    fail(&why, status, "%s", words);
    for (size_t i = 0; i < r->n_tickets; i++)
        if (r->ticket[i].rank > 0 && (rank == 0 || r->ticket[i].rank == rank))
            give(r, &r->ticket[i], status, &why);
}

/* Of a task that was given up meanwhile nothing is taken. */
static void take_result(Ranks *r, int from, size_t n)
{
    const DoneMessage *m = r->in;
    char words[HOST_MAX + 120];
    Err why = {0};
    r->came_s = clock_seconds();
    if (n >= sizeof m->epoch && m->epoch != r->epoch)
        return;
    Ticket *t = is_done_message(m, n, r->problem->part_size, r->n_tickets) ? &r->ticket[m->ticket] : NULL;
    if (!t || (t->rank != from && t->rank != 0)) {
        snprintf(words, sizeof words, "rank %d on %s sends results of tasks that it does not have", from,
                 r->rank[from].host);
        give_up(r, from, STATUS_INTERNAL, words);
        return;
    }
    if (t->rank == 0)
        return;
    memcpy(m->status == STATUS_OK ? t->task.result : (void *)why.text, m->part, n - sizeof *m);
    r->task_s = r->task_s > 0.0 ? 0.95 * r->task_s + 0.05 * m->seconds : m->seconds;
    give(r, t, (Status)m->status, &why);
}

/* The next message, whatever it is, into r->in; its tag, or 0: there is none. */
static int receive(Ranks *r, int *from, size_t *n)
{
    MPI_Message message;
    MPI_Status about;
    int there, count;
    MPI_Improbe(MPI_ANY_SOURCE, MPI_ANY_TAG, MPI_COMM_WORLD, &there, &message, &about);
    if (!there)
        return 0;
    MPI_Get_count(&about, MPI_BYTE, &count);
    *n = count;
    void *wider = *n > r->in_max ? realloc(r->in, *n) : r->in;
    if (!wider && *n > 0)
        MPI_Abort(MPI_COMM_WORLD, status_exit_code(STATUS_NO_MEMORY));
    r->in = wider;
    r->in_max = *n > r->in_max ? *n : r->in_max;
    MPI_Mrecv(r->in, count, MPI_BYTE, &message, &about);
    *from = about.MPI_SOURCE;
    r->rank[*from].silent_s = 0.0;
    return about.MPI_TAG;
}

static int receive_all(Ranks *r)
{
    int moved = 0, from, tag;
    size_t n;
    while (moved < MESSAGES_AT_ONCE && (tag = receive(r, &from, &n)) != 0) {
        moved++;
        if (tag == TAG_DONE)
            take_result(r, from, n);
    }
    return moved;
}

/* -- sending ------------------------------------------------------------------------------------------------------- */

static size_t depth_of(const Ranks *r)
{
    if (!(r->task_s > 0.0) || r->task_s > PREFETCH_MAX_S)
        return 1;
    return 1 + (size_t)fmin(ceil(AHEAD_S / r->task_s), DEPTH_MAX - 1);
}

static size_t message_bytes(const Ranks *r)
{
    return sizeof(TaskMessage) + r->problem->n_var * sizeof(double);
}

static Status more_tickets(Ranks *r, Err *err)
{
    const size_t n = r->n_tickets > 0 ? 2 * r->n_tickets : 256;
    Ticket *ticket = realloc(r->ticket, n * sizeof *ticket);
    if (ticket)
        r->ticket = ticket;
    size_t *idle = realloc(r->idle, n * sizeof *idle);
    if (idle)
        r->idle = idle;
    for (; ticket && idle && r->n_tickets < n; r->n_tickets++) {
        Ticket *t = &ticket[r->n_tickets];
        *t = (Ticket){.request = MPI_REQUEST_NULL, .message = calloc(1, message_bytes(r))};
        if (!t->message)
            break;
        idle[r->n_idle++] = r->n_tickets;
    }
    return r->n_idle > 0 ? STATUS_OK : fail_memory(err, n, "tasks under way");
}

static void send_task(Ranks *r, int to, const Task *task)
{
    const size_t ticket = r->idle[--r->n_idle];
    Ticket *t = &r->ticket[ticket];
    TaskMessage *m = t->message;
    t->task = *task;
    t->rank = to;
    *m = (TaskMessage){r->epoch, ticket, task->id, task->part, task->repeat, task->variant};
    memcpy(m->x, task->x, r->problem->n_var * sizeof *task->x);
    MPI_Wait(&t->request, MPI_STATUS_IGNORE); /* of before, whose result is there */
    MPI_Isend(m, (int)message_bytes(r), MPI_BYTE, to, TAG_TASK, MPI_COMM_WORLD, &t->request);
    if (r->rank[to].n_under_way++ == 0)
        r->rank[to].silent_s = 0.0;
    r->n_under_way++;
}

/* Every rank gets one task for each of its workers before any gets a second, and so on. Returns how many. */
static int deal(Ranks *r)
{
    const size_t depth = depth_of(r);
    int n = 0;
    Task task;
    Err why = {0};
    for (size_t level = 1; level <= depth; level = level < depth && 2 * level > depth ? depth : 2 * level)
        for (int i = 1; i <= r->n; i++)
            while (r->rank[i].n_under_way < level * r->rank[i].n_workers) {
                if (!queue_take(r->queue, 0, &task))
                    return n;
                const Status status = r->n_idle > 0 ? STATUS_OK : more_tickets(r, &why);
                if (status == STATUS_OK)
                    send_task(r, i, &task);
                else
                    queue_give(r->queue, &task, status, &why);
                n++;
            }
    return n;
}

/* -- ranks that do not answer, and the end ------------------------------------------------------------------------- */

static void tell_stop(Ranks *r)
{
    r->has_stopped = 1;
    r->came_s = clock_seconds();
    for (int i = 1; i <= r->n; i++)
        if (r->rank[i].n_under_way > 0)
            MPI_Send(&r->epoch, sizeof r->epoch, MPI_BYTE, i, TAG_STOP, MPI_COMM_WORLD);
}

/* Seconds that this process ran: where the whole job was suspended, no rank was silent. */
static void count_silence(Ranks *r, double seconds)
{
    char words[HOST_MAX + 120];
    for (int i = 1; i <= r->n; i++) {
        Rank *rank = &r->rank[i];
        if (rank->n_under_way == 0)
            continue;
        rank->silent_s += fmin(seconds, 2 * LOOK_S);
        if (rank->silent_s < SILENT_S)
            continue;
        snprintf(words, sizeof words, "rank %d on %s was taken for dead (silent for %g s)", i, rank->host, SILENT_S);
        give_up(r, i, STATUS_STOPPED, words);
    }
}

static const Task *any_task(const Ranks *r)
{
    size_t i = 0;
    while (r->ticket[i].rank == 0)
        i++;
    return &r->ticket[i].task;
}

/* Now and then. */
static void look_after(Ranks *r)
{
    const double now = clock_seconds(), since = now - r->looked_s;
    if (since < LOOK_S)
        return;
    r->looked_s = now;
    if (r->n_under_way == 0)
        return;
    count_silence(r, since);
    if (r->n_under_way > 0 && !r->has_stopped) {
        const Task *task = any_task(r);
        if (r->ending || !task->may_go_on(task->user))
            tell_stop(r);
    } else if (now > r->came_s + LAST_ANSWERS_S) {
        give_up(r, 0, STATUS_STOPPED, "stopped");
    }
}

static void *exchange(void *user)
{
    Ranks *r = user;
    double pause = PAUSE_MIN_S;
    while (!r->ending || r->n_under_way > 0) {
        const int moved = receive_all(r) + deal(r);
        look_after(r);
        pause = moved > 0 ? PAUSE_MIN_S : longer_pause(pause, PAUSE_MAX_S);
        if (moved == 0)
            pause_s(pause);
    }
    return NULL;
}

/* -- life ---------------------------------------------------------------------------------------------------------- */

static Status check_opened(Ranks *r, int from, const OpenedMessage *m, Err *err)
{
    Rank *rank = &r->rank[from];
    memcpy(rank->host, m->host, sizeof rank->host);
    rank->n_workers = m->n_workers;
    if (m->status != STATUS_OK)
        return fail(err, (Status)m->status, "rank %d on %s: %s", from, m->host, m->why);
    if (m->inputs != r->problem->inputs)
        return bad_data(err,
                        "rank %d on %s reads other files than rank 0 (content %016" PRIx64 ", here %016" PRIx64
                        "): records and building must be the same on every machine",
                        from, m->host, m->inputs, r->problem->inputs);
    return STATUS_OK;
}

/* A stop that is asked for meanwhile does not wait for the ranks. */
static Status receive_opened(Ranks *r, double until, int n_open, int *from, int *tag, Err *err)
{
    const Observer *o = &r->problem->observer;
    size_t n;
    while ((*tag = receive(r, from, &n)) == 0) {
        if (o->go_on && !o->go_on(o->user))
            return fail(err, STATUS_STOPPED, "stopped while the ranks open the problem");
        if (clock_seconds() > until)
            return fail(err, STATUS_INTERNAL, "only %d of %d ranks have opened the problem within %g s", n_open, r->n,
                        OPEN_S);
        pause_s(PAUSE_MAX_S);
    }
    return *tag != TAG_OPENED || n == sizeof(OpenedMessage)
               ? STATUS_OK
               : fail(err, STATUS_INTERNAL, "rank %d says in %zu bytes that it has opened the problem", *from, n);
}

/* Of several faults the one of the first rank. */
static Status wait_until_open(Ranks *r, Err *err)
{
    const double until = clock_seconds() + OPEN_S;
    Status status = STATUS_OK;
    int first_bad = r->n + 1, from, tag;
    for (int n_open = 0; n_open < r->n;) {
        OpenedMessage m = {0};
        Err why = {0};
        TRY(receive_opened(r, until, n_open, &from, &tag, err));
        if (tag == TAG_OPENED)
            memcpy(&m, r->in, sizeof m);
        if (tag != TAG_OPENED || m.epoch != r->epoch)
            continue;
        n_open++;
        if (check_opened(r, from, &m, &why) != STATUS_OK && from < first_bad) {
            first_bad = from;
            *err = why;
            status = why.code;
        }
    }
    return status;
}

static Status open_problem(Ranks *r, Err *err)
{
    const OpenMessage m = {r->epoch, r->problem->recipe_size, r->problem->part_size};
    for (int i = 1; i <= r->n; i++)
        MPI_Send(&m, sizeof m, MPI_BYTE, i, TAG_OPEN, MPI_COMM_WORLD);
    MPI_Bcast((void *)r->problem->recipe, (int)m.recipe_size, MPI_BYTE, 0, MPI_COMM_WORLD);
    return wait_until_open(r, err);
}

static void stop(void *self)
{
    Ranks *r = self;
    r->ending = 1;
    if (r->is_running)
        pthread_join(r->thread, NULL);
    for (size_t i = 0; i < r->n_tickets; i++) {
        int is_through;
        MPI_Test(&r->ticket[i].request, &is_through, MPI_STATUS_IGNORE);
        if (is_through)
            free(r->ticket[i].message); /* else of a rank that is dead, and the program ends */
    }
    free(r->rank);
    free(r->in);
    free(r->ticket);
    free(r->idle);
    free(r);
}

static Status start(void **self, Queue *q, Err *err)
{
    size_t n;
    Ranks *r;
    TRY_ROOM(r, 1, "a set of ranks", err);
    *self = r;
    cluster_executor(&n);
    r->queue = q;
    r->problem = queue_problem(q);
    r->n = (int)n;
    r->epoch = (int64_t)(1e9 * clock_seconds());
    r->looked_s = clock_seconds();
    TRY_ROOM(r->rank, r->n + 1, "ranks", err);
    TRY(open_problem(r, err));
    r->is_running = pthread_create(&r->thread, NULL, exchange, r) == 0;
    return r->is_running ? STATUS_OK : fail(err, STATUS_NO_MEMORY, "no thread for %d ranks", r->n);
}

const Executor EXECUTOR_RANKS = {start, NULL, stop};
