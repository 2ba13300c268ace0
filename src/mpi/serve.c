#include <mpi.h>
#include <pthread.h>
#include <stdatomic.h>
#include <stdlib.h>
#include <time.h>

#include "base/clock.h"
#include "mpi/message.h"

/* A look at the messages at least so often: idle; while tasks are under way, whose end is looked for at once; while a
 * message is on its way, which goes on when MPI is called. */
static const double PAUSE_IDLE_S = 1e-3, PAUSE_BUSY_S = 1e-2, PAUSE_SENDING_S = 1e-4;

/* When rank 0 has left, what is under way gets so long to end. */
static const double FAREWELL_S = 0.3;

typedef struct Job {
    struct Job *next;
    Task task;
    int64_t epoch;
    uint64_t ticket;
    Status status;
    Err why;
    double seconds;
    double numbers[]; /* x (n_var), then the part */
} Job;

typedef struct {
    Job *first, *last;
} Line;

typedef struct Service Service;

typedef struct {
    Service *service;
    size_t number;
    pthread_t thread;
} Worker;

struct Service {
    ReopenFn reopen;
    Problem problem; /* {0}: none is open */
    void *recipe;
    size_t recipe_size;
    int64_t epoch;
    atomic_int stopped; /* tasks under way are to end */
    Worker *worker;
    size_t n_workers; /* that run */
    pthread_mutex_t lock;
    pthread_cond_t work, news;
    Line waiting, done;
    size_t n_running;
    int closing;
    Buffer in, out;
    MPI_Request request;
    int is_sending, has_left;
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

/* -- tasks ----------------------------------------------------------------------------------------------------------- */

static void put(Line *line, Job *job)
{
    job->next = NULL;
    if (line->first)
        line->last->next = job;
    else
        line->first = job;
    line->last = job;
}

static Job *take(Line *line)
{
    Job *job = line->first;
    if (job)
        line->first = job->next;
    return job;
}

static int may_go_on(void *user)
{
    return !((Service *)user)->stopped;
}

static void do_job(Service *s, size_t worker, Job *job)
{
    const double began = clock_seconds();
    job->why = (Err){0};
    job->status = s->stopped ? fail(&job->why, STATUS_STOPPED, "stopped")
                             : s->problem.simulator->simulate(s->problem.self, worker, &job->task, &job->why);
    job->seconds = clock_seconds() - began;
}

static void *work(void *user)
{
    const Worker *w = user;
    Service *s = w->service;
    Job *job;
    pthread_mutex_lock(&s->lock);
    while (!s->closing) {
        if (!(job = take(&s->waiting))) {
            pthread_cond_wait(&s->work, &s->lock);
            continue;
        }
        s->n_running++;
        pthread_mutex_unlock(&s->lock);
        do_job(s, w->number, job);
        pthread_mutex_lock(&s->lock);
        s->n_running--;
        put(&s->done, job);
        pthread_cond_signal(&s->news);
    }
    pthread_mutex_unlock(&s->lock);
    return NULL;
}

static Status take_tasks(Service *s, size_t n, Err *err)
{
    const size_t n_var = s->problem.n_var, size = n_var * sizeof(double) + s->problem.part_size;
    int64_t epoch;
    buffer_get(&s->in, &epoch, sizeof epoch);
    while (s->in.n < n) {
        TaskMessage m;
        Job *job = malloc(sizeof *job + size);
        if (!job)
            return no_memory(err, size);
        memset(job->numbers + n_var, 0, s->problem.part_size);
        buffer_get(&s->in, &m, sizeof m);
        buffer_get(&s->in, job->numbers, n_var * sizeof(double));
        job->epoch = epoch;
        job->ticket = m.ticket;
        job->task = (Task){.id = m.id,
                           .part = m.part,
                           .repeat = m.repeat,
                           .variant = m.variant,
                           .size = s->problem.part_size,
                           .x = job->numbers,
                           .result = job->numbers + n_var,
                           .may_go_on = may_go_on,
                           .user = s};
        pthread_mutex_lock(&s->lock);
        put(&s->waiting, job);
        pthread_cond_signal(&s->work);
        pthread_mutex_unlock(&s->lock);
    }
    return STATUS_OK;
}

/* -- the problem ----------------------------------------------------------------------------------------------------- */

static void free_line(Line *line)
{
    for (Job *job; (job = take(line));)
        free(job);
}

static void close_problem(Service *s)
{
    pthread_mutex_lock(&s->lock);
    s->closing = 1;
    s->stopped = 1;
    pthread_cond_broadcast(&s->work);
    pthread_mutex_unlock(&s->lock);
    for (; s->n_workers > 0; s->n_workers--)
        pthread_join(s->worker[s->n_workers - 1].thread, NULL);
    free_line(&s->waiting);
    free_line(&s->done);
    free(s->worker);
    s->worker = NULL;
    problem_close(&s->problem);
    free(s->recipe); /* of which the problem may have been made */
    s->recipe = NULL;
}

static Status start_workers(Service *s, Err *err)
{
    const size_t n = s->problem.n_workers;
    s->closing = 0;
    s->worker = calloc(n, sizeof *s->worker);
    if (!s->worker)
        return fail(err, STATUS_NO_MEMORY, "no memory for %zu threads", n);
    for (; s->n_workers < n; s->n_workers++) {
        Worker *w = &s->worker[s->n_workers];
        *w = (Worker){.service = s, .number = s->n_workers};
        if (pthread_create(&w->thread, NULL, work, w) != 0)
            return fail(err, STATUS_NO_MEMORY, "no thread for the simulations (%zu of %zu)", s->n_workers + 1, n);
    }
    return STATUS_OK;
}

/* The problem of the recipe, which is kept; one that is open already stays so. */
static Status open_problem(Service *s, void *recipe, size_t size, Err *err)
{
    if (s->recipe && size == s->recipe_size && memcmp(recipe, s->recipe, size) == 0) {
        free(recipe);
        return STATUS_OK;
    }
    close_problem(s);
    s->recipe = recipe;
    s->recipe_size = size;
    TRY(s->reopen(&s->problem, recipe, size, err));
    return start_workers(s, err);
}

static Status answer_open(Service *s, Err *err)
{
    OpenMessage m;
    Err why = {0};
    buffer_get(&s->in, &m, sizeof m);
    void *recipe = malloc(m.recipe_size);
    if (!recipe)
        return no_memory(err, m.recipe_size);
    MPI_Bcast(recipe, (int)m.recipe_size, MPI_BYTE, 0, MPI_COMM_WORLD);
    s->epoch = m.epoch;
    OpenedMessage answer = {.epoch = m.epoch};
    answer.status = (int32_t)open_problem(s, recipe, m.recipe_size, &why);
    s->problem.part_size = m.part_size; /* parts may be wanted whole (evaluate/tower.h) */
    s->stopped = 0;
    answer.inputs = s->problem.inputs;
    answer.n_workers = s->n_workers;
    host_name(answer.host);
    memcpy(answer.why, why.text, sizeof answer.why);
    if (answer.status != STATUS_OK)
        close_problem(s);
    MPI_Send(&answer, sizeof answer, MPI_BYTE, 0, TAG_OPENED, MPI_COMM_WORLD);
    return STATUS_OK;
}

/* -- messages -------------------------------------------------------------------------------------------------------- */

static Status widen(Buffer *b, size_t n, Err *err)
{
    if (n <= b->n_max)
        return STATUS_OK;
    char *wider = realloc(b->bytes, n);
    if (!wider)
        return no_memory(err, n);
    b->bytes = wider;
    b->n_max = n;
    return STATUS_OK;
}

static void obey_stop(Service *s)
{
    int64_t epoch;
    buffer_get(&s->in, &epoch, sizeof epoch);
    if (epoch == s->epoch)
        s->stopped = 1;
}

static Status receive(Service *s, int *moved, Err *err)
{
    MPI_Message message;
    MPI_Status about;
    int n;
    MPI_Improbe(0, MPI_ANY_TAG, MPI_COMM_WORLD, moved, &message, &about);
    if (!*moved)
        return STATUS_OK;
    MPI_Get_count(&about, MPI_BYTE, &n);
    TRY(widen(&s->in, (size_t)n, err));
    MPI_Mrecv(s->in.bytes, n, MPI_BYTE, &message, &about);
    s->in.n = 0;
    s->has_left = about.MPI_TAG == TAG_LEAVE;
    if (about.MPI_TAG == TAG_STOP)
        obey_stop(s);
    if (about.MPI_TAG == TAG_OPEN)
        return answer_open(s, err);
    return about.MPI_TAG == TAG_TASKS ? take_tasks(s, (size_t)n, err) : STATUS_OK;
}

/* As many results as one message holds. */
static void pack(Service *s)
{
    const size_t part = s->problem.part_size;
    s->out.n = 0;
    buffer_put(&s->out, &s->epoch, sizeof s->epoch);
    while (s->done.first && s->out.n + done_bytes(part) <= s->out.n_max) {
        Job *job = take(&s->done);
        const DoneMessage m = {job->ticket, job->seconds, job->status};
        if (job->epoch == s->epoch) {
            buffer_put(&s->out, &m, sizeof m);
            if (job->status == STATUS_OK)
                buffer_put(&s->out, job->task.result, part);
            else
                buffer_put(&s->out, job->why.text, sizeof job->why.text);
        }
        free(job);
    }
}

static Status send_results(Service *s, int *moved, Err *err)
{
    int is_through = 1;
    *moved = 0;
    if (s->is_sending)
        MPI_Test(&s->request, &is_through, MPI_STATUS_IGNORE);
    s->is_sending = !is_through;
    if (s->is_sending)
        return STATUS_OK;
    TRY(widen(&s->out, at_least(DONE_BYTES, done_bytes(s->problem.part_size)), err));
    pthread_mutex_lock(&s->lock);
    pack(s);
    const int is_busy = s->n_running > 0 || s->waiting.first;
    pthread_mutex_unlock(&s->lock);
    const int has_results = s->out.n > sizeof s->epoch, is_due = is_busy && clock_seconds() > s->sent_s + ALIVE_S;
    if (!has_results && !is_due)
        return STATUS_OK;
    MPI_Isend(s->out.bytes, has_results ? (int)s->out.n : 0, MPI_BYTE, 0, has_results ? TAG_DONE : TAG_ALIVE,
              MPI_COMM_WORLD, &s->request);
    s->sent_s = clock_seconds();
    *moved = s->is_sending = 1;
    return STATUS_OK;
}

/* Until a task is done, or so long. */
static void wait_for_news(Service *s, double *pause)
{
    struct timespec until;
    pthread_mutex_lock(&s->lock);
    const double longest = s->is_sending ? PAUSE_SENDING_S : s->n_running > 0 ? PAUSE_BUSY_S : PAUSE_IDLE_S;
    *pause = longer_pause(*pause, longest);
    clock_gettime(CLOCK_MONOTONIC, &until);
    until.tv_nsec += (long)(1e9 * *pause);
    until.tv_sec += until.tv_nsec / 1000000000;
    until.tv_nsec %= 1000000000;
    if (!s->done.first || s->is_sending)
        pthread_cond_timedwait(&s->news, &s->lock, &until);
    pthread_mutex_unlock(&s->lock);
}

/* -- life ------------------------------------------------------------------------------------------------------------ */

static Status exchange(Service *s, Err *err)
{
    double pause = PAUSE_MIN_S;
    while (!s->has_left) {
        int came, went;
        TRY(receive(s, &came, err));
        TRY(send_results(s, &went, err));
        if (came || went)
            pause = PAUSE_MIN_S;
        else
            wait_for_news(s, &pause);
    }
    return STATUS_OK;
}

/* A task that takes longer than that ends with the process. */
static int all_end(Service *s)
{
    const double until = clock_seconds() + FAREWELL_S;
    size_t n;
    s->stopped = 1;
    do {
        nanosleep(&(struct timespec){.tv_nsec = 1000000}, NULL);
        pthread_mutex_lock(&s->lock);
        n = s->n_running;
        pthread_mutex_unlock(&s->lock);
    } while (n > 0 && clock_seconds() < until);
    return n == 0;
}

Status serve(ReopenFn reopen, Err *err)
{
    pthread_condattr_t monotonic;
    Service *s = calloc(1, sizeof *s);
    if (!s)
        return no_memory(err, sizeof *s);
    s->reopen = reopen;
    pthread_condattr_init(&monotonic);
    pthread_condattr_setclock(&monotonic, CLOCK_MONOTONIC);
    pthread_mutex_init(&s->lock, NULL);
    pthread_cond_init(&s->work, NULL);
    pthread_cond_init(&s->news, &monotonic);
    TRY(exchange(s, err));
    MPI_Send(NULL, 0, MPI_BYTE, 0, TAG_LEFT, MPI_COMM_WORLD);
    if (!all_end(s))
        return STATUS_OK;
    close_problem(s);
    free(s->in.bytes);
    free(s->out.bytes);
    free(s);
    return STATUS_OK;
}
