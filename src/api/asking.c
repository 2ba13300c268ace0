#include "api/asking.h"

#include <errno.h>
#include <omp.h>
#include <pthread.h>
#include <signal.h>

#include "base/linalg.h"
#include "evaluate/tasks.h"

static void wait_for(sem_t *turn)
{
    while (sem_wait(turn) != 0 && errno == EINTR)
        ;
}

/* -- the executor, in the search's turn ---------------------------------------------------------------------------- */

Status asking_add(Asking *a, const double x[], Err *err)
{
    Evaluation *row;
    if (a->table.n == a->room) {
        const size_t room = 2 * a->room + 64;
        AskedDesign *wider = realloc(a->design, room * sizeof *wider);
        if (!wider)
            return fail_memory(err, room, "designs");
        a->design = wider;
        a->room = room;
    }
    TRY(evaluation_table_add(&a->table, &row, err));
    memcpy(row->x, x, a->table.n_var * sizeof *x);
    row->id = (long)a->table.n;
    a->design[a->table.n - 1] = (AskedDesign){0};
    return STATUS_OK;
}

/* A resumed search asks again for what was under way. */
static Status note_task(Asking *a, const Task *task, Err *err)
{
    const size_t row = (size_t)task->id - 1;
    if (row == a->table.n)
        TRY(asking_add(a, task->x, err));
    if (row >= a->table.n || memcmp(a->table.row[row].x, task->x, a->table.n_var * sizeof *task->x) != 0)
        return fail(err, STATUS_INTERNAL, "design %ld is another one than was asked for before", task->id);
    memcpy(task->result, &row, sizeof row);
    a->design[row].is_due = 1;
    a->design[row].slot = task->slot;
    return STATUS_OK;
}

static Status take_tasks(Asking *a, Err *err)
{
    Task task;
    Status status = STATUS_OK;
    while (status == STATUS_OK && queue_take(a->queue, 0, &task)) {
        status = note_task(a, &task, err);
        if (status != STATUS_OK)
            queue_give(a->queue, &task, status, err);
    }
    return status;
}

static void give_answers(Asking *a, Status status, const Err *why)
{
    for (size_t i = a->n_finished; i < a->table.n; i++)
        if (a->design[i].is_due && (a->design[i].place == DESIGN_TOLD || status != STATUS_OK)) {
            a->design[i].is_due = 0;
            queue_give(a->queue, &(Task){.slot = a->design[i].slot}, status, why);
        }
}

static Status executor_start(void **self, Queue *queue, size_t *n, Err *err)
{
    (void)n;
    Asking *a = queue_problem(queue)->self;
    (void)err;
    a->queue = queue;
    *self = a;
    return STATUS_OK;
}

static void help(void *self)
{
    Asking *a = self;
    Err why = {.text = "stopped"};
    Status status = take_tasks(a, &why);
    if (status == STATUS_OK && a->n_told < a->table.n) {
        sem_post(&a->back);
        wait_for(&a->go);
    }
    give_answers(a, status == STATUS_OK && a->is_closing ? STATUS_STOPPED : status, &why);
}

static void executor_stop(void *self)
{
    (void)self;
}

static const Executor ASKING = {.start = executor_start, .help = help, .stop = executor_stop};

/* -- the simulator: what was told ---------------------------------------------------------------------------------- */

static Status simulate(void *self, size_t worker, const Task *task, Err *err)
{
    (void)self;
    (void)worker;
    return fail(err, STATUS_INTERNAL, "design %ld is not simulated here", task->id);
}

static void combine(const Problem *p, size_t n, const void *parts, Evaluation *e)
{
    const Asking *a = p->self;
    size_t row;
    (void)n;
    memcpy(&row, parts, sizeof row);
    const Evaluation *told = &a->table.row[row];
    evaluation_set_outcome(e, told->outcome, told->reason);
    memcpy(e->f, told->f, p->n_obj * sizeof *e->f);
    if (p->n_extra > 0)
        memcpy(e->extra, told->extra, p->n_extra * sizeof *e->extra);
    e->replicates = 1;
}

static const Simulator TOLD = {.simulate = simulate, .combine = combine};

/* -- the search ---------------------------------------------------------------------------------------------------- */

/* Without memory for a copy the last state stays, which is as good. */
static int note_generation(const SearchView *view, void *user)
{
    Asking *a = user;
    unsigned char *copy = view->state ? realloc(a->state, view->n_state) : NULL;
    if (!copy)
        return 0;
    memcpy(copy, view->state, view->n_state);
    a->state = copy;
    a->n_state = view->n_state;
    for (size_t i = a->n_finished; i < view->n; i++) {
        a->table.row[i].kind = (EvaluationKind)view->kind[i];
        a->table.row[i].generation = (long)view->generation[i];
    }
    a->n_finished = view->n;
    return 0;
}

static void *search(void *user)
{
    Asking *a = user;
    const SearchStart start = {.n = a->n_finished,
                               .n_later = a->known.n - a->n_finished,
                               .row = a->known.row,
                               .state = a->state,
                               .n_state = a->n_state};
    omp_set_num_threads((int)a->threads);
    a->status =
        search_resume(&a->problem, &a->config, a->known.n > 0 ? &start : NULL, note_generation, a, &a->reason, &a->why);
    a->is_over = 1;
    sem_post(&a->back);
    return NULL;
}

static Status start(Asking *a, Err *err)
{
    sigset_t all, before;
    for (size_t i = 0; i < a->table.n; i++)
        TRY(evaluation_table_append(&a->known, &a->table.row[i], err));
    sigfillset(&all); /* signals are the caller's */
    pthread_sigmask(SIG_SETMASK, &all, &before);
    const int failed = pthread_create(&a->thread, NULL, search, a);
    pthread_sigmask(SIG_SETMASK, &before, NULL);
    if (failed)
        return fail(err, STATUS_NO_MEMORY, "no thread for the search");
    a->is_running = 1;
    return STATUS_OK;
}

/* A turn of the search, whose BLAS has one thread. */
static Status take_turn(Asking *a, Err *err)
{
    Status status = STATUS_OK;
    linalg_begin();
    if (a->is_running)
        sem_post(&a->go);
    else
        status = start(a, err);
    if (status == STATUS_OK)
        wait_for(&a->back);
    linalg_end();
    return status;
}

Status asking_advance(Asking *a, Err *err)
{
    if (!a->is_over && a->n_told == a->table.n)
        TRY(take_turn(a, err));
    if (a->is_over && a->status != STATUS_OK)
        return fail(err, a->status, "%s", a->why.text);
    return STATUS_OK;
}

void asking_open(Asking *a)
{
    Problem *p = &a->problem;
    p->simulator = &TOLD;
    p->executor = &ASKING;
    p->self = a;
    p->n_parts = p->n_workers = 1;
    p->part_size = sizeof(size_t);
    a->table = a->known = evaluation_table(p->n_var, p->n_obj, p->n_extra);
    sem_init(&a->go, 0, 0);
    sem_init(&a->back, 0, 0);
}

void asking_close(Asking *a)
{
    Err unused;
    a->is_closing = 1;
    if (a->is_running && !a->is_over)
        take_turn(a, &unused);
    if (a->is_running)
        pthread_join(a->thread, NULL);
    sem_destroy(&a->go);
    sem_destroy(&a->back);
    evaluation_table_free(&a->table);
    evaluation_table_free(&a->known);
    free(a->design);
    free(a->state);
}
