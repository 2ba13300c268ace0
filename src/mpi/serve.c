#include <mpi.h>
#include <pthread.h>
#include <stdatomic.h>

#include "base/clock.h"
#include "mpi/message.h"

/* A look at the messages at least so often: idle; while tasks are under way, which send their own results. */
static const double PAUSE_IDLE_S = 1e-3, PAUSE_BUSY_S = 1e-2;

/* When rank 0 has left, what is under way gets so long to end. */
static const double FAREWELL_S = 0.3;

typedef struct Job {
    struct Job *next;
    TaskMessage message; /* last: x (n_var) follows */
} Job;

typedef struct Service Service;

typedef struct {
    Service *service;
    size_t number;
    pthread_t thread;
    DoneMessage *done; /* with room for a part, or a reason */
} Worker;

struct Service {
    ReopenFn reopen;
    Problem problem; /* {0}: none is open */
    void *recipe;
    size_t recipe_size;
    int64_t epoch;
    atomic_int stopped; /* tasks under way are to end */
    Worker *worker;
    size_t n_workers;              /* that run */
    pthread_mutex_t lock, talking; /* talking: who calls MPI */
    pthread_cond_t work;
    Job *first, *last;
    size_t n_running;
    int closing, has_left, has_said_left;
    double sent_s;
};

static Status no_memory(Err *err, size_t bytes)
{
    char host[HOST_MAX];
    int rank;
    host_name(host);
    MPI_Comm_rank(MPI_COMM_WORLD, &rank);
    return fail(err, STATUS_NO_MEMORY, "rank %d on %s: no memory for %zu bytes", rank, host, bytes);
}

static void say(Service *s, int tag, const void *bytes, size_t n)
{
    pthread_mutex_lock(&s->talking);
    if (!s->has_said_left)
        MPI_Send(bytes, (int)n, MPI_BYTE, 0, tag, MPI_COMM_WORLD);
    s->has_said_left |= tag == TAG_LEFT;
    s->sent_s = clock_seconds();
    pthread_mutex_unlock(&s->talking);
}

/* -- tasks --------------------------------------------------------------------------------------------------------- */

static int may_go_on(void *user)
{
    return !((Service *)user)->stopped;
}

static void do_job(Worker *w, const TaskMessage *m)
{
    Service *s = w->service;
    DoneMessage *done = w->done;
    const size_t size = s->problem.part_size;
    const double began = clock_seconds();
    const Task task = {.id = m->id,
                       .part = m->part,
                       .repeat = m->repeat,
                       .variant = m->variant,
                       .x = m->x,
                       .result = done->part,
                       .size = size,
                       .may_go_on = may_go_on,
                       .user = s};
    Err why = {0};
    memset(done->part, 0, size);
    const Status status = s->stopped ? fail(&why, STATUS_STOPPED, "stopped")
                                     : s->problem.simulator->simulate(s->problem.self, w->number, &task, &why);
    *done = (DoneMessage){m->epoch, m->ticket, clock_seconds() - began, status};
    if (status != STATUS_OK)
        memcpy(done->part, why.text, WHY_BYTES);
    say(s, TAG_DONE, done, sizeof *done + (status == STATUS_OK ? size : WHY_BYTES));
}

static Job *next_job(Service *s)
{
    Job *job = s->first;
    if (job)
        s->first = job->next;
    return job;
}

static void *work(void *user)
{
    Worker *w = user;
    Service *s = w->service;
    Job *job;
    pthread_mutex_lock(&s->lock);
    while (!s->closing) {
        if (!(job = next_job(s))) {
            pthread_cond_wait(&s->work, &s->lock);
            continue;
        }
        s->n_running++;
        pthread_mutex_unlock(&s->lock);
        do_job(w, &job->message);
        free(job);
        pthread_mutex_lock(&s->lock);
        s->n_running--;
    }
    pthread_mutex_unlock(&s->lock);
    return NULL;
}

/* -- the problem --------------------------------------------------------------------------------------------------- */

static void close_problem(Service *s)
{
    pthread_mutex_lock(&s->lock);
    s->closing = 1;
    s->stopped = 1;
    pthread_cond_broadcast(&s->work);
    pthread_mutex_unlock(&s->lock);
    for (size_t i = 0; i < s->n_workers; i++) {
        pthread_join(s->worker[i].thread, NULL);
        free(s->worker[i].done);
    }
    s->n_workers = 0;
    for (Job *job; (job = next_job(s));)
        free(job);
    free(s->worker);
    s->worker = NULL;
    problem_close(&s->problem);
    free(s->recipe); /* of which the problem may have been made */
    s->recipe = NULL;
}

static Status start_workers(Service *s, Err *err)
{
    const size_t n = s->problem.n_workers, part = s->problem.part_size;
    s->closing = 0;
    TRY_ROOM(s->worker, n, "threads", err);
    for (; s->n_workers < n; s->n_workers++) {
        Worker *w = &s->worker[s->n_workers];
        *w = (Worker){.service = s, .number = s->n_workers};
        w->done = malloc(sizeof *w->done + MAX_OF(part, WHY_BYTES));
        if (!w->done || pthread_create(&w->thread, NULL, work, w) != 0) {
            free(w->done);
            return fail(err, STATUS_NO_MEMORY, "no thread for the simulations (%zu of %zu)", s->n_workers + 1, n);
        }
    }
    return STATUS_OK;
}

/* The problem of the recipe, which is kept; one that is open already stays so. */
static Status open_problem(Service *s, void *recipe, const OpenMessage *m, Err *err)
{
    const size_t size = m->recipe_size;
    if (s->recipe && size == s->recipe_size && m->part_size == s->problem.part_size &&
        memcmp(recipe, s->recipe, size) == 0) {
        free(recipe);
        return STATUS_OK;
    }
    close_problem(s);
    s->recipe = recipe;
    s->recipe_size = size;
    TRY(s->reopen(&s->problem, recipe, size, err));
    s->problem.part_size = m->part_size; /* parts may be wanted whole (evaluate/tower.h) */
    return start_workers(s, err);
}

static Status answer_open(Service *s, const OpenMessage *m, Err *err)
{
    Err why = {0};
    void *recipe = malloc(m->recipe_size);
    if (!recipe)
        return no_memory(err, m->recipe_size);
    pthread_mutex_lock(&s->talking);
    MPI_Bcast(recipe, (int)m->recipe_size, MPI_BYTE, 0, MPI_COMM_WORLD);
    pthread_mutex_unlock(&s->talking);
    s->epoch = m->epoch;
    OpenedMessage answer = {.epoch = m->epoch};
    answer.status = open_problem(s, recipe, m, &why);
    s->stopped = 0;
    answer.inputs = s->problem.inputs;
    answer.n_workers = s->n_workers;
    host_name(answer.host);
    memcpy(answer.why, why.text, sizeof answer.why);
    if (answer.status != STATUS_OK)
        close_problem(s);
    say(s, TAG_OPENED, &answer, sizeof answer);
    return STATUS_OK;
}

/* -- messages ------------------------------------------------------------------------------------------------------ */

/* The next message, to be freed: NULL: there is none. A task is the second half of a job. */
static Status receive(Service *s, Job **out, int *tag, Err *err)
{
    MPI_Message message;
    MPI_Status about;
    int n = 0, there;
    *out = NULL;
    pthread_mutex_lock(&s->talking);
    MPI_Improbe(0, MPI_ANY_TAG, MPI_COMM_WORLD, &there, &message, &about);
    if (there) {
        MPI_Get_count(&about, MPI_BYTE, &n);
        *out = malloc(sizeof(Job) + n);
        if (*out)
            MPI_Mrecv(&(*out)->message, n, MPI_BYTE, &message, &about);
        *tag = about.MPI_TAG;
    }
    pthread_mutex_unlock(&s->talking);
    return there && !*out ? no_memory(err, n) : STATUS_OK;
}

static void line_up(Service *s, Job *job)
{
    job->next = NULL;
    pthread_mutex_lock(&s->lock);
    if (s->first)
        s->last->next = job;
    else
        s->first = job;
    s->last = job;
    pthread_cond_signal(&s->work);
    pthread_mutex_unlock(&s->lock);
}

static Status obey(Service *s, Job *job, int tag, Err *err)
{
    Status status = STATUS_OK;
    if (tag == TAG_TASK) {
        line_up(s, job);
        return STATUS_OK;
    }
    if (tag == TAG_STOP && *(const int64_t *)&job->message.epoch == s->epoch)
        s->stopped = 1;
    if (tag == TAG_OPEN)
        status = answer_open(s, (const OpenMessage *)(const void *)&job->message, err);
    s->has_left = tag == TAG_LEAVE;
    free(job);
    return status;
}

static size_t n_busy(Service *s)
{
    pthread_mutex_lock(&s->lock);
    const size_t n = s->n_running + (s->first != NULL);
    pthread_mutex_unlock(&s->lock);
    return n;
}

/* -- life ---------------------------------------------------------------------------------------------------------- */

static Status exchange(Service *s, Err *err)
{
    double pause = PAUSE_MIN_S;
    while (!s->has_left) {
        Job *job;
        int tag = 0;
        TRY(receive(s, &job, &tag, err));
        if (job) {
            TRY(obey(s, job, tag, err));
            pause = PAUSE_MIN_S;
            continue;
        }
        const int is_busy = n_busy(s) > 0;
        if (is_busy && clock_seconds() > s->sent_s + ALIVE_S)
            say(s, TAG_ALIVE, NULL, 0);
        pause = longer_pause(pause, is_busy ? PAUSE_BUSY_S : PAUSE_IDLE_S);
        pause_s(pause);
    }
    return STATUS_OK;
}

/* A task that takes longer than that ends with the process. */
static int all_end(Service *s)
{
    const double until = clock_seconds() + FAREWELL_S;
    s->stopped = 1;
    while (n_busy(s) > 0 && clock_seconds() < until)
        pause_s(1e-3);
    return n_busy(s) == 0;
}

Status serve(ReopenFn reopen, Err *err)
{
    Service *s = calloc(1, sizeof *s);
    if (!s)
        return no_memory(err, sizeof *s);
    s->reopen = reopen;
    pthread_mutex_init(&s->lock, NULL);
    pthread_mutex_init(&s->talking, NULL);
    pthread_cond_init(&s->work, NULL);
    TRY(exchange(s, err));
    const int is_through = all_end(s);
    say(s, TAG_LEFT, NULL, 0);
    if (!is_through)
        return STATUS_OK;
    close_problem(s);
    free(s);
    return STATUS_OK;
}
