/* The evaluation queue: every part is simulated once, and neither order of arrival nor number of workers changes a
 * number. */
#include "check.h"

#include <stdatomic.h>

#include "evaluate/isolated.h"
#include "evaluate/queue.h"

enum { VAR = 2, OBJ = 2, PARTS = 3, DESIGNS = 60, WORKERS = 4 };

typedef struct {
    double value, repeat, variant;
} Part;

typedef struct {
    Problem problem;
    atomic_int n_tasks, n_under_way, most_under_way, tasks_left; /* tasks_left: then a stop is asked for */
    int rests;
    double fault_at[2]; /* x[0] of designs whose second part ends everything */
    size_t n_heard;
    long heard[DESIGNS];
} Bench;

static Status simulate(void *self, size_t worker, const Task *t, Err *why)
{
    Bench *b = self;
    Part *part = t->result;
    Random r = random_stream((uint32_t)t->id, RANDOM_TEST, 0, (uint32_t)t->part);
    const int n = ++b->n_under_way;
    if (n > b->most_under_way)
        b->most_under_way = n;
    if (b->rests)
        rest(2e-3 * random_uniform(&r));
    *part = (Part){t->x[0] + (double)t->part, (double)t->repeat, t->variant.kind};
    b->n_tasks++;
    b->n_under_way--;
    if (worker >= b->problem.n_workers)
        return (fail)(why, STATUS_INTERNAL, "worker %zu", worker);
    if (t->part == 1 && (t->x[0] == b->fault_at[0] || t->x[0] == b->fault_at[1]))
        return (fail)(why, STATUS_BAD_DATA, "design %g", t->x[0]);
    return STATUS_OK;
}

/* Failed where x[1] is negative. */
static void combine(const Problem *, size_t, const void *parts, Evaluation *e)
{
    const Part *part = parts;
    e->f[0] = e->seconds = 0.0;
    for (int k = 0; k < PARTS; k++)
        e->f[0] = 2.0 * e->f[0] + part[k].value;
    e->f[1] = part[0].repeat + 100.0 * part[2].variant;
    e->replicates = PARTS;
    if (e->x[1] == 2.0) {
        e->f[1] = -0.0;
        e->sd[0] = INFINITY;
    }
    if (e->x[1] < 0.0)
        evaluation_set_outcome(e, OUTCOME_ERROR, "negative");
}

static const double LOWER[VAR] = {-1e3, -1e3}, UPPER[VAR] = {1e3, 1e3};

static const Simulator SIMULATOR = {.simulate = simulate, .combine = combine};

static void judge(const Evaluation *e, double f[], double g[], const void *)
{
    f[0] = -e->f[0];
    f[1] = e->f[1];
    g[0] = e->f[0] - 10.0;
}

static double f_of(double x)
{
    return 4.0 * x + 2.0 * (x + 1.0) + x + 2.0;
}

static Bench bench;
static Finished done;

/* Of a bench that has done nothing yet. */
static Queue *open_queue(size_t workers, Observer observer)
{
    Queue *q;
    bench = (Bench){.fault_at = {-1.0, -1.0}};
    bench.problem = (Problem){.n_var = VAR,
                              .n_obj = OBJ,
                              .n_con = 1,
                              .lower = LOWER,
                              .upper = UPPER,
                              .judge = judge,
                              .simulator = &SIMULATOR,
                              .self = &bench,
                              .n_parts = PARTS,
                              .part_size = sizeof(Part),
                              .n_workers = workers,
                              .observer = observer};
    CHECK_OK(queue_open(&q, &bench.problem, &err), &err);
    return q;
}

static void ask(Queue *q, int n)
{
    for (int i = 0; i < n; i++)
        CHECK_OK(queue_ask(q,
                           &(Asked){.id = i == 0 ? 101 : 0,
                                    .x = (double[]){i, i % 7 == 6 ? -1.0 : 1.0},
                                    .repeat = (size_t)i % 3,
                                    .kind = KIND_INFILL},
                           &err),
                 &err);
}

static Status note_done(const Evaluation *e, void *user, Err *)
{
    Bench *b = user;
    b->heard[b->n_heard++] = e->id;
    return STATUS_OK;
}

TEST(a_batch_has_the_same_numbers_at_any_number_of_workers)
{
    for (size_t workers = 1; workers <= WORKERS; workers++) {
        Queue *q = open_queue(workers, (Observer){.done = note_done, .user = &bench});
        bench.rests = 1;
        ask(q, DESIGNS);
        assert_int_equal(queue_pending(q), DESIGNS);
        for (int i = 0; i < DESIGNS; i++) {
            CHECK_OK(queue_next(q, &done, &err), &err);
            const Evaluation *e = done.evaluation;
            assert_true(e->id == 101 + i && e->x[0] == i && e->kind == KIND_INFILL);
            assert_true(e->replicates == PARTS && ((const Part *)done.parts)[1].value == i + 1.0);
            if (i % 7 == 6) {
                assert_true(e->outcome == OUTCOME_ERROR && isnan(e->f[0]) && isinf(e->violation));
                continue;
            }
            assert_true(e->f[0] == f_of(i) && done.f[0] == -f_of(i) && e->f[1] == i % 3);
            assert_true(done.g[0] == f_of(i) - 10.0 && e->violation == fmax(f_of(i) - 10.0, 0.0));
        }
        queue_close(q);
        assert_int_equal(bench.n_tasks, DESIGNS * PARTS);
        assert_int_equal(bench.n_heard, DESIGNS);
        assert_in_range(bench.most_under_way, 1, workers);
    }
}

/* SQLite keeps -0 as 0 and what is not finite as nothing: a search that is resumed must not see other numbers. */
TEST(numbers_are_those_that_a_run_keeps)
{
    double x[VAR] = {-0.0, 2.0};
    Queue *q = open_queue(1, (Observer){0});
    problem_repair(&bench.problem, x);
    assert_int_equal(signbit(x[0]), 0);
    CHECK_OK(queue_ask(q, &(Asked){.x = x}, &err), &err);
    CHECK_OK(queue_next(q, &done, &err), &err);
    assert_true(done.evaluation->f[1] == 0.0 && !signbit(done.evaluation->f[1]));
    assert_true(isnan(done.evaluation->sd[0]));
    queue_close(q);
}

TEST(a_single_design_keeps_as_many_workers_busy_as_it_has_parts)
{
    Queue *q = open_queue(PARTS, (Observer){0});
    bench.rests = 1;
    for (int tries = 0; tries < 200 && bench.most_under_way < PARTS; tries++) {
        ask(q, 1);
        CHECK_OK(queue_next(q, &done, &err), &err);
    }
    queue_close(q);
    assert_int_equal(bench.most_under_way, PARTS);
}

/* Whichever worker is first, the fault of the design asked for first is the one that is told. */
TEST(of_several_faults_the_first_design_is_named)
{
    for (size_t workers = 1; workers <= WORKERS; workers++)
        for (int turn = 0; turn < 10; turn++) {
            err = (Err){0};
            Status status = STATUS_OK;
            Queue *q = open_queue(workers, (Observer){0});
            bench.rests = turn % 2;
            bench.fault_at[0] = 20;
            bench.fault_at[1] = 21;
            ask(q, DESIGNS);
            while (status == STATUS_OK)
                status = queue_next(q, &done, &err);
            queue_close(q);
            assert_int_equal(status, STATUS_BAD_DATA);
            assert_string_equal(err.text, "design 20");
            assert_in_range(bench.n_tasks, 20 * PARTS, DESIGNS * PARTS - 1);
        }
}

static int some_more(void *user)
{
    Bench *b = user;
    return b->tasks_left-- > 0;
}

TEST(a_stop_finishes_what_is_under_way_and_the_observer_hears_of_it)
{
    for (size_t workers = 1; workers <= WORKERS; workers += WORKERS - 1) {
        Status status = STATUS_OK;
        Queue *q = open_queue(workers, (Observer){some_more, note_done, &bench});
        bench.rests = 1;
        bench.tasks_left = 10 * PARTS;
        ask(q, DESIGNS);
        while (status == STATUS_OK)
            status = queue_next(q, &done, &err);
        assert_int_equal(status, STATUS_STOPPED);
        assert_int_equal(bench.n_tasks, 10 * PARTS);
        assert_int_equal(bench.n_heard, 10);
        queue_close(q);
    }
}

static Status refuse_third(const Evaluation *e, void *user, Err *why)
{
    Bench *b = user;
    (void)e;
    return ++b->n_heard < 3 ? STATUS_OK : (fail)(why, STATUS_IO, "the disk is full");
}

TEST(a_fault_of_the_observer_ends_everything)
{
    Status status = STATUS_OK;
    Queue *q = open_queue(2, (Observer){.done = refuse_third, .user = &bench});
    ask(q, DESIGNS);
    while (status == STATUS_OK)
        status = queue_next(q, &done, &err);
    assert_int_equal(status, STATUS_IO);
    assert_string_equal(err.text, "the disk is full");
    queue_close(q);
}

TEST(parts_come_back_in_any_order_and_designs_in_that_of_asking)
{
    Task task[3 * PARTS];
    Queue *q = open_queue(1, (Observer){0});
    ask(q, 3);
    for (int k = 0; k < 3 * PARTS; k++) {
        assert_int_equal(queue_take(q, 0, 0, 1, &task[k]), 1);
        assert_true(task[k].x[0] == k / PARTS && task[k].part == (size_t)k % PARTS && task[k].id == 101 + k / PARTS);
    }
    assert_int_equal(queue_take(q, 0, 0, 1, &task[0]), 0);
    for (int k = 3 * PARTS; k-- > 0;) { /* the last part first */
        CHECK_OK(simulate(&bench, 0, &task[k], &err), &err);
        queue_give(q, &task[k], STATUS_OK, &err);
    }
    for (int i = 0; i < 3; i++) {
        CHECK_OK(queue_next(q, &done, &err), &err);
        assert_int_equal(done.evaluation->id, 101 + i);
        assert_same_number(done.evaluation->f[0], f_of(i));
    }
    assert_int_not_equal(queue_next(q, &done, &err), STATUS_OK);
    queue_close(q);
}

TEST(designs_without_end_need_no_more_memory_than_those_pending)
{
    Queue *q = open_queue(3, (Observer){0});
    ask(q, 20);
    for (int i = 0; i < 3000; i++) {
        CHECK_OK(queue_next(q, &done, &err), &err);
        const double x[2] = {done.evaluation->x[0] + 1, 1};
        CHECK_OK(queue_ask(q, &(Asked){.x = x}, &err), &err);
        assert_int_equal(queue_pending(q), 20);
    }
    queue_close(q);
}

/* -- simulations in processes of their own ------------------------------------------------------------------------- */

/* Twice x; a negative one crashes, 0 ends the process. */
static Status double_or_die(void *self, size_t worker, const Task *t, Err *why)
{
    (void)self;
    (void)worker;
    (void)why;
    if (t->x[0] < 0.0)
        raise(SIGKILL);
    if (t->x[0] == 0.0)
        _exit(3);
    *(double *)t->result = 2.0 * t->x[0];
    return STATUS_OK;
}

static void note_lost(const Task *t, const char *reason)
{
    *(double *)t->result = strstr(reason, "its process ended: Killed") ? SIGKILL : -1.0;
}

TEST(a_simulation_that_crashes_ends_its_own_task_alone)
{
    Isolated q = {.doer = {.simulator = &(Simulator){.simulate = double_or_die}, .n_var = 1}, .lost = note_lost};
    CHECK_OK(isolated_open(&q, WORKERS, &err), &err);
    for (int i = 0; i < DESIGNS; i++) {
        const double x = (double)((i * 7) % 11 - 3);
        double result = 0.5;
        const Task task = {.x = &x, .result = &result, .size = sizeof result};
        size_t n_done;
        CHECK_OK(pool_do(&q.pool, (size_t)i % WORKERS, 1, &task, &n_done, &err), &err);
        assert_same_number(result, x < 0.0 ? SIGKILL : x == 0.0 ? -1.0 : 2.0 * x);
        assert_int_equal(n_done, 1);
    }
    pool_close(&q.pool);
}

SUITE(NULL, NULL)
