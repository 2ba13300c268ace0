#include "evaluate/queue.h"

#include <omp.h>
#include <pthread.h>

#include "base/carve.h"
#include "evaluate/cluster.h"
#include "evaluate/pool.h"

/* A design that is pending, or room for one. */
typedef struct Slot {
    struct Slot *next; /* in its list */
    const Problem *problem;
    Evaluation e;
    int is_finished;
    size_t repeat, sequence;
    size_t n_parts, n_taken, n_given;
    Variant variant;
    double *f, *g; /* (n_obj) (n_con) minimised */
    char *parts;   /* in the order in which they are taken */
    char *ordered; /* by their numbers, where these differ */
} Slot;

typedef struct {
    Queue *queue;
    size_t number;
    pthread_t id;
} Thread;

struct Queue {
    const Problem *problem;
    Slot *idle;         /* room that is used again */
    Slot *first, *last; /* pending designs in the order of asking */
    Slot *work;         /* before it every design has all its parts taken; NULL: all have */
    Slot *given;        /* by the last queue_next */
    size_t n;           /* pending */
    size_t n_asked;     /* ever */
    size_t n_waiting;   /* tasks that nobody has taken */
    size_t n_under_way;
    long last_id;
    int closed;
    Status status;
    size_t rank; /* of the task that ended it */
    Err why;
    void *executing;  /* the problem's executor; without one: */
    Thread *thread;   /* (n_threads) */
    size_t n_threads; /* 0: the client itself is the worker, while it waits */
    size_t n_first;   /* of these; the others take ahead, where there is enough for all */
    pthread_mutex_t lock, finishing;
    pthread_cond_t some, plenty, news; /* tasks wait; enough for those who take ahead; a design is finished */
};

/* The arrays of a slot, in one store with it. */
static void layout(void *slot, Carve *c)
{
    Slot *s = slot;
    const Problem *p = s->problem;
    CARVE(c, s->e.x, p->n_var);
    CARVE(c, s->e.f, p->n_obj);
    CARVE(c, s->e.sd, p->n_obj);
    CARVE(c, s->e.extra, p->n_extra);
    CARVE(c, s->e.room, REASON_MAX);
    CARVE(c, s->f, p->n_obj);
    CARVE(c, s->g, p->n_con);
    s->parts = carve(c, p->n_parts, p->part_size);
    s->ordered = carve(c, p->order ? p->n_parts : 0, p->part_size);
}

/* -- tasks --------------------------------------------------------------------------------------------------------- */

/* What ends it: of faults the one of the first task; a stop, or a fault of the observer, only where there is none. */
static void end(Queue *q, size_t rank, Status status, const char *why)
{
    if (q->status == STATUS_OK || rank < q->rank) {
        q->rank = rank;
        q->status = fail(&q->why, status, "%s", why);
    }
    pthread_cond_broadcast(&q->some);
    pthread_cond_broadcast(&q->plenty);
    pthread_cond_broadcast(&q->news);
}

/* A worker that takes ahead does so only where there is enough for all. Of those that wait one worker takes no more
 * than leaves some for the others. */
size_t queue_take(Queue *q, size_t worker, int wait, size_t n_max, Task tasks[])
{
    const Problem *p = q->problem;
    const size_t least = worker < q->n_first ? 1 : q->n_first;
    size_t n = 0;
    pthread_mutex_lock(&q->lock);
    while (n < n_max && !q->closed && q->status == STATUS_OK) {
        while (q->work && q->work->n_taken == q->work->n_parts)
            q->work = q->work->next;
        Slot *s = q->work;
        if (!s || q->n_waiting < least) {
            if (n > 0 || !wait)
                break;
            pthread_cond_wait(least > 1 ? &q->plenty : &q->some, &q->lock);
            continue;
        }
        if (!goes_on(&p->observer)) {
            end(q, SIZE_MAX, STATUS_STOPPED, "stopped");
            break;
        }
        const size_t i = s->n_taken++;
        tasks[n++] = (Task){.id = s->e.id,
                            .part = p->order ? p->order[i] : i,
                            .repeat = s->repeat,
                            .variant = s->variant,
                            .x = s->e.x,
                            .result = s->parts + i * p->part_size,
                            .size = p->part_size,
                            .observer = &p->observer,
                            .slot = s};
        q->n_under_way++;
        q->n_waiting--;
        if (n == 1)
            n_max = MIN_OF(n_max, 1 + q->n_waiting / q->n_first);
    }
    pthread_mutex_unlock(&q->lock);
    return n;
}

/* Numbers as a run stores them: 0 has no sign, and what is not finite is not known. */
static void make_canonical(size_t n, double values[])
{
    for (size_t i = 0; i < n; i++)
        values[i] = isfinite(values[i]) ? values[i] + 0.0 : NAN;
}

/* The last part given completes its design, which the observer hears of outside the lock, one at a time. */
void queue_give(Queue *q, const Task *task, Status status, const Err *why)
{
    const Problem *p = q->problem;
    const Observer *o = &p->observer;
    Slot *s = task->slot;
    Evaluation *e = &s->e;
    Err fault = {0};
    pthread_mutex_lock(&q->lock);
    if (status != STATUS_OK)
        end(q, status == STATUS_STOPPED ? SIZE_MAX : s->sequence * p->n_parts + task->part, status, why->text);
    const int is_whole = status == STATUS_OK && ++s->n_given == s->n_parts;
    pthread_mutex_unlock(&q->lock);

    /* All parts of a design are in: its evaluation is made of them in the order of their numbers, of a cheap level as
     * they were taken. */
    if (is_whole) {
        const int is_ordered = p->order && s->n_parts == p->n_parts;
        for (size_t i = 0; is_ordered && i < p->n_parts; i++)
            memcpy(s->ordered + p->order[i] * p->part_size, s->parts + i * p->part_size, p->part_size);
        p->simulator->combine(p, s->n_parts, is_ordered ? s->ordered : s->parts, e);
        for (size_t k = 0; e->outcome != OUTCOME_OK && k < p->n_obj; k++)
            e->f[k] = NAN;
        make_canonical(p->n_obj, e->f);
        make_canonical(p->n_obj, e->sd);
        make_canonical(p->n_extra, e->extra);
        problem_judge(p, e, s->f, s->g);
        e->violation = e->outcome == OUTCOME_OK ? violation_of(p->n_con, s->g) : INFINITY;
        pthread_mutex_lock(&q->finishing);
        status = o->done ? o->done(e, o->user, &fault) : STATUS_OK;
    }
    pthread_mutex_lock(&q->lock);
    if (is_whole) {
        s->is_finished = 1;
        if (status != STATUS_OK)
            end(q, SIZE_MAX, status, fault.text);
        pthread_cond_signal(&q->news);
    }
    q->n_under_way--;
    if (q->status != STATUS_OK)
        pthread_cond_broadcast(&q->news);
    pthread_mutex_unlock(&q->lock);
    if (is_whole)
        pthread_mutex_unlock(&q->finishing);
}

/* Do one task, or as many of those that wait as the worker wants; 0: there is none. */
static int do_tasks(Queue *q, size_t worker, int wait)
{
    const Executor *executor = q->problem->executor;
    const Simulator *s = executor ? executor->simulator : q->problem->simulator;
    void *self = executor ? q->executing : q->problem->self;
    Task task[TASKS_MAX];
    Err why = {0};
    Pool *pool = pool_of(s, self);
    const size_t n = queue_take(q, worker, wait, pool ? pool->worker[worker].batch : 1, task);
    if (n == 0)
        return 0;
    size_t n_done = 0;
    const Status status = pool ? pool_do(pool, worker, n, task, &n_done, &why) : s->simulate(self, worker, task, &why);
    for (size_t i = 0; i < n; i++)
        queue_give(q, &task[i], i < n_done ? STATUS_OK : status, &why);
    return 1;
}

/* -- the client ---------------------------------------------------------------------------------------------------- */

static void release_given(Queue *q)
{
    if (q->given) {
        q->given->next = q->idle;
        q->idle = q->given;
    }
    q->given = NULL;
}

Status queue_ask(Queue *q, const Asked *asked, Err *err)
{
    const Problem *p = q->problem;
    const size_t n_there = asked->cheap_parts ? p->n_cheap : 0;
    pthread_mutex_lock(&q->lock);
    release_given(q);

    /* 1. An idle slot, or a new one, and nothing known in it. */
    Slot *s = q->idle ? q->idle : carve_object(layout, &(Slot){.problem = p}, sizeof *s);
    if (!s) {
        pthread_mutex_unlock(&q->lock);
        return fail_memory(err, q->n + 1, "designs under way");
    }
    q->idle = s->next;
    evaluation_forget(&s->e, p->n_obj, p->n_extra);

    /* 2. The design, of which some parts may be there. */
    if (asked->x)
        copy_values(p->n_var, asked->x, s->e.x);
    s->e.kind = asked->kind;
    s->e.id = q->last_id = asked->id > 0 ? asked->id : q->last_id + 1;
    s->next = NULL;
    s->is_finished = 0;
    s->repeat = asked->repeat;
    s->variant = asked->variant;
    s->n_parts = asked->n_parts > 0 ? asked->n_parts : p->n_parts;
    s->n_taken = s->n_given = n_there;
    s->sequence = q->n_asked++;
    if (n_there > 0)
        memcpy(s->parts, asked->cheap_parts, n_there * p->part_size);

    /* 3. Behind the last one, for whoever waits for work. */
    *(q->n++ > 0 ? &q->last->next : &q->first) = s;
    q->last = s;
    q->work = q->work ? q->work : s;
    q->n_waiting += s->n_parts - n_there;
    if (s->n_parts > 1)
        pthread_cond_broadcast(&q->some);
    else
        pthread_cond_signal(&q->some);
    if (q->n_waiting >= q->n_first)
        pthread_cond_signal(&q->plenty);
    pthread_mutex_unlock(&q->lock);
    return STATUS_OK;
}

/* The client alone adds and removes designs, so that it may count them without the lock. */
size_t queue_pending(const Queue *q)
{
    return q->n;
}

/* Where there are no threads the client does the tasks itself. A fault is told when nothing is under way any more. */
Status queue_next(Queue *q, Finished *out, Err *err)
{
    if (q->n == 0)
        return fail(err, STATUS_INTERNAL, "a result is waited for, but no design was asked for");
    pthread_mutex_lock(&q->lock);
    release_given(q);
    while (q->status != STATUS_OK ? q->n_under_way > 0 : !q->first->is_finished) {
        if (q->n_threads > 0) {
            pthread_cond_wait(&q->news, &q->lock);
            continue;
        }
        pthread_mutex_unlock(&q->lock);
        do_tasks(q, 0, 0);
        pthread_mutex_lock(&q->lock);
    }
    const Status status = q->status;
    if (status == STATUS_OK) {
        Slot *s = q->given = q->first;
        q->work = q->work == s ? s->next : q->work;
        q->first = s->next;
        q->n--;
        *out = (Finished){&s->e, s->f, s->g, s->parts};
    }
    pthread_mutex_unlock(&q->lock);
    return status == STATUS_OK ? STATUS_OK : fail(err, status, "%s", q->why.text);
}

Status queue_evaluate(Queue *q, size_t n, const double X[], size_t repeat, double F[], double G[], unsigned char ok[],
                      Err *err)
{
    const Problem *p = q->problem;
    Finished done;
    for (size_t i = 0; i < n; i++) {
        const Asked asked = {.x = X + i * p->n_var, .repeat = repeat};
        TRY(queue_ask(q, &asked, err));
    }
    for (size_t i = 0; i < n; i++) {
        TRY(queue_next(q, &done, err));
        ok[i] = done.evaluation->outcome == OUTCOME_OK;
        copy_values(p->n_obj, done.f, F + i * p->n_obj);
        if (G)
            copy_values(p->n_con, done.g, G + i * p->n_con);
    }
    return STATUS_OK;
}

/* -- who does the tasks -------------------------------------------------------------------------------------------- */

size_t threads_wanted(long setting)
{
    return setting > 0 ? setting : omp_get_num_procs();
}

void executor_choose(Problem *p)
{
    size_t n_ranks;
    p->executor = p->recipe ? cluster_executor(&n_ranks) : NULL;
    p->n_workers *= p->executor ? n_ranks : 1;
}

static void *work(void *user)
{
    const Thread *t = user;
    while (do_tasks(t->queue, t->number, 1))
        ;
    return NULL;
}

/* Start the executor, and a thread for each of several workers, of an executor two: while one waits for its answer the
 * other has asked. With one worker the order of arrival is that of asking. */
static Status start(Queue *q, Err *err)
{
    const Executor *e = q->problem->executor;
    q->n_first = q->problem->n_workers;
    if (e)
        TRY(e->start(&q->executing, q->problem, &q->n_first, err));
    if (!e && q->n_first == 1)
        return STATUS_OK;
    const size_t n = e && q->n_first > 1 ? 2 * q->n_first : q->n_first;
    TRY_ROOM(q->thread, n, "threads", err);
    for (; q->n_threads < n; q->n_threads++) {
        Thread *t = &q->thread[q->n_threads];
        *t = (Thread){.queue = q, .number = q->n_threads};
        if (pthread_create(&t->id, NULL, work, t) != 0)
            return fail(err, STATUS_NO_MEMORY, "no thread for the simulations (%zu of %zu)", q->n_threads + 1, n);
    }
    return STATUS_OK;
}

/* -- life ---------------------------------------------------------------------------------------------------------- */

Status queue_open(Queue **out, const Problem *problem, Err *err)
{
    *out = NULL;
    Queue *q;
    TRY_ROOM(q, 1, "a queue", err);
    q->problem = problem;
    pthread_mutex_init(&q->lock, NULL);
    pthread_mutex_init(&q->finishing, NULL);
    pthread_cond_init(&q->some, NULL);
    pthread_cond_init(&q->plenty, NULL);
    pthread_cond_init(&q->news, NULL);
    const Status status = start(q, err);
    if (status == STATUS_OK)
        *out = q;
    else
        queue_close(q);
    return status;
}

void queue_close(Queue *q)
{
    if (!q)
        return;
    pthread_mutex_lock(&q->lock);
    q->closed = 1;
    pthread_cond_broadcast(&q->some);
    pthread_cond_broadcast(&q->plenty);
    pthread_mutex_unlock(&q->lock);
    for (size_t i = 0; i < q->n_threads; i++)
        pthread_join(q->thread[i].id, NULL);
    if (q->executing)
        q->problem->executor->stop(q->executing);
    free(q->thread);
    pthread_mutex_destroy(&q->lock);
    pthread_mutex_destroy(&q->finishing);
    pthread_cond_destroy(&q->some);
    pthread_cond_destroy(&q->plenty);
    pthread_cond_destroy(&q->news);
    release_given(q);
    *(q->n > 0 ? &q->last->next : &q->first) = q->idle; /* behind those that are pending */
    for (Slot *s = q->first, *next; s; s = next) {
        next = s->next;
        free(s);
    }
    free(q);
}
