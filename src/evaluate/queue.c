#include "evaluate/queue.h"

#include <omp.h>
#include <pthread.h>

#include "base/carve.h"
#include "evaluate/cluster.h"

typedef struct {
    Evaluation e;
    int is_finished;
    size_t index; /* of Queue.pool */
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
    pthread_t thread;
} Worker;

struct Queue {
    const Problem *problem;
    Slot **pool; /* (n_pool) every slot that was ever needed, and room for n_max */
    Slot **idle; /* (n_idle) */
    Slot **line; /* (head..head+n) pending designs in the order of asking, room for n_max */
    Slot *given; /* by the last queue_next */
    size_t n_pool, n_idle, n_max, head, n;
    size_t next;      /* before it, counted from head, every design has all its parts taken */
    size_t n_asked;   /* ever */
    size_t n_waiting; /* tasks that nobody has taken */
    size_t n_under_way;
    long last_id;
    int closed;
    Status status;
    size_t rank; /* of the task that ended it */
    Err why;
    void *executing;  /* the problem's executor; without one: */
    Worker *worker;   /* (n_threads) */
    size_t n_threads; /* 0: the client itself is the worker, while it waits */
    size_t n_first;   /* of these; the others take ahead, where there is enough for all */
    pthread_mutex_t lock, finishing;
    pthread_cond_t work, plenty, news; /* plenty: for those who take ahead */
};

const Problem *queue_problem(const Queue *q)
{
    return q->problem;
}

/* The one place that asks whether simulations may go on. */
static int may_go_on(void *user)
{
    const Observer *o = &((const Queue *)user)->problem->observer;
    return !o->go_on || o->go_on(o->user);
}

/* -- slots --------------------------------------------------------------------------------------------------------- */

static void layout(Slot *s, const Queue *q, Carve *c)
{
    const Problem *p = q->problem;
    carve(c, 1, sizeof *s);
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

static Status slot_create(Slot **out, const Queue *q, Err *err)
{
    Slot counted;
    Carve c = {0};
    layout(&counted, q, &c);
    Slot *s = carve_store(&c);
    *out = s;
    if (!s)
        return fail_memory(err, q->n_pool + 1, "designs under way");
    layout(s, q, &(Carve){.base = (char *)s});
    return STATUS_OK;
}

static Status widen(Queue *q, Err *err)
{
    const size_t n = q->n_max > 0 ? 2 * q->n_max : 32;
    Slot ***const lists[] = {&q->pool, &q->idle, &q->line};
    for (size_t i = 0; i < sizeof lists / sizeof *lists; i++) {
        Slot **wider = realloc(*lists[i], n * sizeof *wider);
        if (!wider)
            return fail_memory(err, n, "designs under way");
        *lists[i] = wider;
    }
    q->n_max = n;
    return STATUS_OK;
}

/* An idle slot, nothing known in it. */
static Status slot_get(Queue *q, Slot **out, Err *err)
{
    const Problem *p = q->problem;
    if (q->n_idle == 0) {
        if (q->n_pool == q->n_max)
            TRY(widen(q, err));
        Slot *fresh;
        TRY(slot_create(&fresh, q, err));
        fresh->index = q->n_pool;
        q->pool[q->n_pool++] = fresh;
        q->idle[q->n_idle++] = fresh;
    }
    Slot *s = q->idle[--q->n_idle];
    const Slot was = *s;
    *s = (Slot){.e = was.e, .index = was.index, .f = was.f, .g = was.g, .parts = was.parts, .ordered = was.ordered};
    evaluation_forget(&s->e, p->n_obj, p->n_extra);
    *out = s;
    return STATUS_OK;
}

/* -- the line ------------------------------------------------------------------------------------------------------ */

static Slot *in_line(const Queue *q, size_t i)
{
    return q->line[q->head + i];
}

static void append(Queue *q, Slot *s)
{
    if (q->head + q->n == q->n_max) {
        memmove(q->line, q->line + q->head, q->n * sizeof *q->line);
        q->head = 0;
    }
    q->line[q->head + q->n++] = s;
}

static Slot *remove_first(Queue *q)
{
    Slot *s = in_line(q, 0);
    q->n--;
    q->head++;
    q->next -= q->next > 0;
    return s;
}

/* -- the client ---------------------------------------------------------------------------------------------------- */

static void fill(Queue *q, Slot *s, const Asked *asked)
{
    const Problem *p = q->problem;
    if (asked->x)
        memcpy(s->e.x, asked->x, p->n_var * sizeof *asked->x);
    s->e.kind = asked->kind;
    s->e.id = q->last_id = asked->id > 0 ? asked->id : q->last_id + 1;
    s->repeat = asked->repeat;
    s->variant = asked->variant;
    s->n_parts = asked->n_parts > 0 ? asked->n_parts : p->n_parts;
    s->sequence = q->n_asked++;
    q->n_waiting += s->n_parts - (asked->cheap_parts ? p->n_cheap : 0);
    if (!asked->cheap_parts)
        return;
    memcpy(s->parts, asked->cheap_parts, p->n_cheap * p->part_size);
    s->n_taken = s->n_given = p->n_cheap;
}

static void release_given(Queue *q)
{
    if (q->given)
        q->idle[q->n_idle++] = q->given;
    q->given = NULL;
}

Status queue_ask(Queue *q, const Asked *asked, Err *err)
{
    Slot *s;
    pthread_mutex_lock(&q->lock);
    release_given(q);
    const Status status = slot_get(q, &s, err);
    if (status == STATUS_OK) {
        fill(q, s, asked);
        append(q, s);
        if (s->n_parts > 1)
            pthread_cond_broadcast(&q->work);
        else
            pthread_cond_signal(&q->work);
        if (q->n_waiting >= q->n_first)
            pthread_cond_signal(&q->plenty);
    }
    pthread_mutex_unlock(&q->lock);
    return status;
}

/* The client alone adds and removes designs, so that it may count them without the lock. */
size_t queue_pending(const Queue *q)
{
    return q->n;
}

/* How many of those that wait one worker takes, so that all get some. */
static size_t share(Queue *q)
{
    pthread_mutex_lock(&q->lock);
    const size_t n = 1 + q->n_waiting / q->n_first;
    pthread_mutex_unlock(&q->lock);
    return n;
}

static int take(Queue *q, size_t least, int wait, Task *task);

/* One, or as many of those that wait as the worker wants. */
static int do_tasks(Queue *q, size_t worker, int wait)
{
    const Executor *executor = q->problem->executor;
    const Simulator *s = executor ? executor->simulator : q->problem->simulator;
    void *self = executor ? q->executing : q->problem->self;
    Task task[TASKS_MAX];
    Err why = {0};
    size_t n = 0, n_done = 0, n_wanted = s->batch ? s->batch(self, worker) : 1;
    const size_t least = worker < q->n_first ? 1 : q->n_first;
    for (; n < n_wanted && take(q, least, wait && n == 0, &task[n]); n++)
        if (n == 0 && n_wanted > 1)
            n_wanted = MIN_OF(n_wanted, share(q));
    if (n == 0)
        return 0;
    const Status status = simulate_tasks(s, self, worker, n, task, &n_done, &why);
    for (size_t i = 0; i < n; i++)
        queue_give(q, &task[i], i < n_done ? STATUS_OK : status, &why);
    return 1;
}

static void wait_for_news(Queue *q)
{
    const Executor *e = q->problem->executor;
    if (e ? !e->help : q->n_threads > 0) {
        pthread_cond_wait(&q->news, &q->lock);
        return;
    }
    pthread_mutex_unlock(&q->lock);
    if (e)
        e->help(q->executing);
    else
        do_tasks(q, 0, 0);
    pthread_mutex_lock(&q->lock);
}

static Status next_finished(Queue *q, Finished *out, Err *err)
{
    if (q->n == 0)
        return fail(err, STATUS_INTERNAL, "a result is waited for, but no design was asked for");
    while (q->status != STATUS_OK ? q->n_under_way > 0 : !in_line(q, 0)->is_finished)
        wait_for_news(q);
    if (q->status != STATUS_OK)
        return fail(err, q->status, "%s", q->why.text);
    Slot *s = q->given = remove_first(q);
    *out = (Finished){&s->e, s->f, s->g, s->parts};
    return STATUS_OK;
}

Status queue_next(Queue *q, Finished *out, Err *err)
{
    pthread_mutex_lock(&q->lock);
    release_given(q);
    const Status status = next_finished(q, out, err);
    pthread_mutex_unlock(&q->lock);
    return status;
}

Status queue_evaluate(Queue *q, size_t n, const double X[], const size_t repeat[], double F[], double G[],
                      unsigned char ok[], Err *err)
{
    const Problem *p = q->problem;
    Finished done;
    for (size_t i = 0; i < n; i++) {
        const Asked asked = {.x = X + i * p->n_var, .repeat = repeat ? repeat[i] : 0};
        TRY(queue_ask(q, &asked, err));
    }
    for (size_t i = 0; i < n; i++) {
        TRY(queue_next(q, &done, err));
        ok[i] = done.evaluation->outcome == OUTCOME_OK;
        memcpy(F + i * p->n_obj, done.f, p->n_obj * sizeof *F);
        if (G && p->n_con > 0)
            memcpy(G + i * p->n_con, done.g, p->n_con * sizeof *G);
    }
    return STATUS_OK;
}

/* -- executors ----------------------------------------------------------------------------------------------------- */

/* What ends it: of faults the one of the first task; a stop, or a fault of the observer, only where there is none. */
static void end(Queue *q, size_t rank, Status status, const char *why)
{
    if (q->status == STATUS_OK || rank < q->rank) {
        q->rank = rank;
        q->status = fail(&q->why, status, "%s", why);
    }
    pthread_cond_broadcast(&q->work);
    pthread_cond_broadcast(&q->plenty);
    pthread_cond_broadcast(&q->news);
}

/* The first design that has parts to be taken, or NULL: there are not that many. */
static Slot *find_work(Queue *q, size_t least)
{
    if (q->n_waiting < least)
        return NULL;
    while (q->next < q->n && in_line(q, q->next)->n_taken == in_line(q, q->next)->n_parts)
        q->next++;
    return q->next < q->n ? in_line(q, q->next) : NULL;
}

static void hand_out(Queue *q, Slot *s, Task *task)
{
    const Problem *p = q->problem;
    const size_t i = s->n_taken++;
    *task = (Task){.id = s->e.id,
                   .part = p->order ? p->order[i] : i,
                   .repeat = s->repeat,
                   .variant = s->variant,
                   .x = s->e.x,
                   .result = s->parts + i * p->part_size,
                   .size = p->part_size,
                   .may_go_on = may_go_on,
                   .user = q,
                   .slot = s->index};
    q->n_under_way++;
    q->n_waiting--;
}

static int take(Queue *q, size_t least, int wait, Task *task)
{
    Slot *s = NULL;
    pthread_mutex_lock(&q->lock);
    while (!q->closed && q->status == STATUS_OK && !(s = find_work(q, least)) && wait)
        pthread_cond_wait(least > 1 ? &q->plenty : &q->work, &q->lock);
    if (q->closed || q->status != STATUS_OK) {
        s = NULL;
    } else if (s && !may_go_on(q)) {
        end(q, SIZE_MAX, STATUS_STOPPED, "stopped");
        s = NULL;
    }
    if (s)
        hand_out(q, s, task);
    pthread_mutex_unlock(&q->lock);
    return s != NULL;
}

int queue_take(Queue *q, int wait, Task *task)
{
    return take(q, 1, wait, task);
}

/* As a run stores them: 0 has no sign, and what is not finite is not known. */
static void make_canonical(size_t n, double values[])
{
    for (size_t i = 0; i < n; i++)
        values[i] = isfinite(values[i]) ? values[i] + 0.0 : NAN;
}

/* All of a design by their numbers; of a cheap level as they were taken. */
static const char *parts_of(const Problem *p, Slot *s)
{
    if (!p->order || s->n_parts < p->n_parts)
        return s->parts;
    for (size_t i = 0; i < p->n_parts; i++)
        memcpy(s->ordered + p->order[i] * p->part_size, s->parts + i * p->part_size, p->part_size);
    return s->ordered;
}

static void complete(const Queue *q, Slot *s)
{
    const Problem *p = q->problem;
    Evaluation *e = &s->e;
    p->simulator->combine(p, s->n_parts, parts_of(p, s), e);
    for (size_t k = 0; e->outcome != OUTCOME_OK && k < p->n_obj; k++)
        e->f[k] = NAN;
    make_canonical(p->n_obj, e->f);
    make_canonical(p->n_obj, e->sd);
    make_canonical(p->n_extra, e->extra);
    problem_judge(p, e, s->f, s->g);
    e->violation = e->outcome == OUTCOME_OK ? violation_of(p->n_con, s->g) : INFINITY;
}

/* All parts of the design are in. */
static void finish(Queue *q, Slot *s)
{
    const Observer *o = &q->problem->observer;
    Err why = {0};
    complete(q, s);
    pthread_mutex_lock(&q->finishing);
    const Status status = o->done ? o->done(&s->e, o->user, &why) : STATUS_OK;
    pthread_mutex_lock(&q->lock);
    s->is_finished = 1;
    if (status != STATUS_OK)
        end(q, SIZE_MAX, status, why.text);
    pthread_cond_signal(&q->news);
    pthread_mutex_unlock(&q->lock);
    pthread_mutex_unlock(&q->finishing);
}

void queue_give(Queue *q, const Task *task, Status status, const Err *why)
{
    pthread_mutex_lock(&q->lock);
    Slot *s = q->pool[task->slot];
    if (status != STATUS_OK)
        end(q, status == STATUS_STOPPED ? SIZE_MAX : s->sequence * q->problem->n_parts + task->part, status, why->text);
    else
        s->n_given++;
    const int is_whole = status == STATUS_OK && s->n_given == s->n_parts;
    pthread_mutex_unlock(&q->lock);
    if (is_whole)
        finish(q, s);
    pthread_mutex_lock(&q->lock);
    q->n_under_way--;
    if (q->status != STATUS_OK)
        pthread_cond_broadcast(&q->news);
    pthread_mutex_unlock(&q->lock);
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
    const Worker *w = user;
    while (do_tasks(w->queue, w->number, 1))
        ;
    return NULL;
}

static Status start(Queue *q, Err *err)
{
    const Executor *e = q->problem->executor;
    q->n_first = q->problem->n_workers;
    if (e)
        TRY(e->start(&q->executing, q, &q->n_first, err));
    if (e ? !e->simulator : q->n_first == 1)
        return STATUS_OK;
    const size_t n =
        e && q->n_first > 1 ? 2 * q->n_first : q->n_first; /* of one the order of arrival is that of asking */
    TRY_ROOM(q->worker, n, "threads", err);
    for (; q->n_threads < n; q->n_threads++) {
        Worker *w = &q->worker[q->n_threads];
        *w = (Worker){.queue = q, .number = q->n_threads};
        if (pthread_create(&w->thread, NULL, work, w) != 0)
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
    pthread_cond_init(&q->work, NULL);
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
    pthread_cond_broadcast(&q->work);
    pthread_cond_broadcast(&q->plenty);
    pthread_mutex_unlock(&q->lock);
    for (size_t i = 0; i < q->n_threads; i++)
        pthread_join(q->worker[i].thread, NULL);
    if (q->executing)
        q->problem->executor->stop(q->executing);
    free(q->worker);
    pthread_mutex_destroy(&q->lock);
    pthread_mutex_destroy(&q->finishing);
    pthread_cond_destroy(&q->work);
    pthread_cond_destroy(&q->plenty);
    pthread_cond_destroy(&q->news);
    for (size_t i = 0; i < q->n_pool; i++)
        free(q->pool[i]);
    free(q->pool);
    free(q->idle);
    free(q->line);
    free(q);
}
