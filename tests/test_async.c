/* An asynchronous search: what depends on what, nothing lost, nobody idle. The order in which results come is made by a
 * script here: every design takes so many ticks of a clock that does not run. */
#include "runs.h"
#include "functions.h"
#include "searches.h"

#include "base/random.h"
#include "base/hypervolume.h"
#include "evaluate/textbook.h"

enum { VAR_MAX = 22, OBJ_MAX = 7, ROWS_MAX = 400, GENERATIONS_MAX = 120, WORKERS_MAX = 8 };

typedef struct {
    Problem problem;
    Function function;
    double lower[VAR_MAX], upper[VAR_MAX];
    uint32_t script; /* chooses the ticks */
    int hurried;     /* rests at random moments: time passes otherwise, the order stays */
    size_t n_taken, fault_after;
    Task task[WORKERS_MAX]; /* (n_under_way) */
    double end[WORKERS_MAX], clock;
    size_t n_under_way;
} World;

typedef struct {
    size_t n, last_generation;
    double X[ROWS_MAX * VAR_MAX], F[ROWS_MAX * OBJ_MAX];
    unsigned char ok[ROWS_MAX], kind[ROWS_MAX];
    size_t generation[ROWS_MAX];
    Moments moments;
    StopReason reason;
} Seen;

static World here;
static Seen whole, rest_of_it;

static Random stream_of(const World *w, const double x[], uint32_t name)
{
    uint64_t bits;
    memcpy(&bits, x, sizeof bits);
    return random_stream((uint32_t)(bits ^ bits >> 32), RANDOM_TEST, w->script, name);
}

static int answer(const World *w, const double x[], double f[])
{
    textbook_dtlz2(w->problem.n_var, w->problem.n_obj, x, f);
    return ((size_t)(1e9 * x[0])) % 17 != 0;
}

static Status evaluate(size_t n, const double X[], const size_t draws[], double F[], double G[], unsigned char ok[],
                       void *user, Err *err)
{
    const World *w = user;
    (void)draws;
    (void)G;
    (void)err;
    for (size_t i = 0; i < n; i++)
        ok[i] = (unsigned char)answer(w, X + i * w->problem.n_var, F + i * w->problem.n_obj);
    return STATUS_OK;
}

/* One thread that is n_workers of them: gives the design whose ticks end first. */
static Status script_start(void **self, Queue *q, Err *err)
{
    (void)err;
    *self = q;
    here.n_under_way = 0;
    here.clock = 0.0;
    return STATUS_OK;
}

static void script_take(World *w, Queue *q)
{
    while (w->n_under_way < w->problem.n_workers && queue_take(q, 0, &w->task[w->n_under_way])) {
        const Task *t = &w->task[w->n_under_way];
        Random ticks = stream_of(w, t->x, 1);
        Err err = {0};
        if (++w->n_taken == w->fault_after)
            queue_give(q, t, (fail)(&err, STATUS_IO, "the disk is full"), &err);
        else
            w->end[w->n_under_way++] = w->clock + 1.0 + 20.0 * pow(random_uniform(&ticks), 4.0);
    }
}

static void script_help(void *self)
{
    World *w = &here;
    size_t first = 0;
    Err err = {0};
    script_take(w, self);
    if (w->n_under_way == 0)
        return;
    for (size_t i = 1; i < w->n_under_way; i++)
        if (w->end[i] < w->end[first])
            first = i;
    const Task task = w->task[first];
    Random pause = stream_of(w, task.x, 2);
    if (w->hurried && random_below(&pause, 4) == 0)
        rest(1e-3 * random_uniform(&pause));
    w->clock = w->end[first];
    w->n_under_way--;
    w->task[first] = w->task[w->n_under_way];
    w->end[first] = w->end[w->n_under_way];
    const Status status = function_simulate(&w->function, 0, &task, &err);
    queue_give(self, &task, status, &err);
}

static void script_stop(void *self)
{
    (void)self;
}

static const Executor SCRIPT = {script_start, script_help, script_stop};

static void world(size_t n_var, size_t n_obj, size_t workers)
{
    memset(&here, 0, sizeof here);
    for (size_t d = 0; d < n_var; d++)
        here.upper[d] = 1.0;
    here.problem = function_problem(&here.function, n_var, n_obj, 0, here.lower, here.upper, evaluate, &here);
    here.problem.n_workers = workers;
    here.problem.executor = &SCRIPT;
}

static SearchConfig config(size_t initial, size_t max_evals)
{
    SearchConfig c = search_config(5, 24, 60);
    c.initial = initial;
    c.generations = 100;
    c.max_evals = max_evals;
    c.asynchronous = 1;
    return c;
}

static int observe(const SearchView *v, void *user)
{
    Seen *s = user;
    assert_true(v->n <= ROWS_MAX && s->moments.n < GENERATIONS_MAX);
    s->n = v->n;
    s->last_generation = v->generation_now;
    memcpy(s->X, v->X, v->n * v->n_var * sizeof *v->X);
    memcpy(s->F, v->F, v->n * v->n_obj * sizeof *v->F);
    memcpy(s->ok, v->ok, v->n);
    memcpy(s->kind, v->kind, v->n);
    memcpy(s->generation, v->generation, v->n * sizeof *v->generation);
    moments_note(&s->moments, v);
    return 0;
}

static void forget_it(Seen *s)
{
    moments_free(&s->moments);
    memset(s, 0, sizeof *s);
}

static void search(const SearchConfig *c, const SearchStart *start, Seen *seen)
{
    Err err = {0};
    memset(seen, 0, sizeof *seen);
    here.n_taken = 0;
    CHECK_OK(search_resume(&here.problem, c, start, observe, seen, &seen->reason, &err), &err);
}

static void assert_same(const Seen *a, const Seen *b)
{
    const size_t n_var = here.problem.n_var, m = here.problem.n_obj;
    assert_int_equal(a->n, b->n);
    assert_int_equal(a->reason, b->reason);
    assert_int_equal(a->last_generation, b->last_generation);
    assert_memory_equal(a->X, b->X, a->n * n_var * sizeof *a->X);
    assert_memory_equal(a->F, b->F, a->n * m * sizeof *a->F);
    assert_memory_equal(a->ok, b->ok, a->n);
    assert_memory_equal(a->kind, b->kind, a->n);
    assert_memory_equal(a->generation, b->generation, a->n * sizeof *a->generation);
}

static void assert_all_different(const Seen *s)
{
    const size_t n_var = here.problem.n_var;
    for (size_t i = 0; i < s->n; i++)
        for (size_t j = 0; j < i; j++)
            assert_memory_not_equal(s->X + i * n_var, s->X + j * n_var, n_var * sizeof *s->X);
}

TEST(one_worker_makes_the_bytes_of_a_search_in_batches)
{
    world(6, 3, 1);
    SearchConfig c = config(20, 90);
    search(&c, NULL, &whole);
    c.asynchronous = 0;
    search(&c, NULL, &rest_of_it);
    assert_same(&whole, &rest_of_it);
    forget_it(&whole);
    forget_it(&rest_of_it);
}

TEST(the_same_order_of_arrival_makes_the_same_bytes_whatever_the_time)
{
    world(6, 3, 4);
    const SearchConfig c = config(20, 120);
    search(&c, NULL, &whole);
    assert_int_equal(whole.n, 120);
    assert_int_equal(whole.reason, STOP_EVALUATIONS);
    assert_all_different(&whole);
    here.hurried = 1;
    search(&c, NULL, &rest_of_it);
    assert_same(&whole, &rest_of_it);
    forget_it(&rest_of_it);
    here.script = 1;
    search(&c, NULL, &rest_of_it);
    assert_int_equal(rest_of_it.n, 120);
    assert_memory_not_equal(whole.X, rest_of_it.X, 120 * 6 * sizeof *whole.X);
    forget_it(&whole);
    forget_it(&rest_of_it);
}

TEST(every_design_has_the_objectives_of_a_search_in_batches)
{
    double f[OBJ_MAX];
    world(6, 3, 4);
    const SearchConfig c = config(20, 80);
    search(&c, NULL, &whole);
    for (size_t i = 0; i < whole.n; i++) {
        assert_int_equal(answer(&here, whole.X + i * 6, f), whole.ok[i]);
        if (whole.ok[i])
            assert_memory_equal(f, whole.F + i * 3, sizeof *f * 3);
    }
    forget_it(&whole);
}

/* Killed after any result: the state of the last generation, and results that came after it. */
TEST(results_after_the_last_state_are_taken_up_in_their_order)
{
    const SearchConfig c = config(20, 50);
    world(6, 3, 4);
    search(&c, NULL, &whole);
    EvaluationTable before =
        evaluations_of(&here.problem, 1, whole.n, whole.X, whole.F, NULL, whole.ok, whole.kind, whole.generation);
    for (size_t k = 0; k + 1 < whole.moments.n; k += 2)
        for (size_t later = 0; whole.moments.rows[k] + later <= whole.n; later += 1 + whole.n / 6) {
            const size_t n = whole.moments.rows[k];
            const SearchStart start = {n,    later, before.row, whole.moments.state[k], whole.moments.n_state[k],
                                       NULL, NULL,  NULL};
            search(&c, &start, &rest_of_it);
            assert_int_equal(rest_of_it.n, whole.n);
            assert_int_equal(here.n_taken, whole.n - n - later);
            assert_memory_equal(whole.X, rest_of_it.X, (n + later) * 6 * sizeof *whole.X);
            assert_memory_equal(whole.F, rest_of_it.F, (n + later) * 3 * sizeof *whole.F);
            assert_all_different(&rest_of_it);
            forget_it(&rest_of_it);
        }
    const SearchStart start = {0, whole.n, before.row, NULL, 0, NULL, NULL, NULL};
    search(&c, &start, &rest_of_it);
    assert_same(&whole, &rest_of_it);
    assert_int_equal(here.n_taken, 0);
    evaluation_table_free(&before);
    forget_it(&whole);
    forget_it(&rest_of_it);
}

/* Results that the search would not have asked for, of another program, say, are results all the same. */
TEST(results_that_nobody_asked_for_join_the_archive)
{
    double X[2 * 6], F[2 * 3];
    const unsigned char ok[2] = {1, 1}, kind[2] = {KIND_INFILL, KIND_INFILL};
    world(6, 3, 4);
    for (size_t d = 0; d < 12; d++)
        X[d] = 0.031 * (double)(d + 1);
    textbook_dtlz2(6, 3, X, F);
    textbook_dtlz2(6, 3, X + 6, F + 3);
    const SearchConfig c = config(20, 60);
    EvaluationTable before = evaluations_of(&here.problem, 1, 2, X, F, NULL, ok, kind, NULL);
    const SearchStart start = {0, 2, before.row, NULL, 0, NULL, NULL, NULL};
    search(&c, &start, &whole);
    assert_int_equal(whole.n, 60);
    assert_memory_equal(whole.X, X, sizeof X);
    assert_memory_equal(whole.F, F, sizeof F);
    assert_all_different(&whole);
    evaluation_table_free(&before);
    forget_it(&whole);
}

/* Of all that was tried, failures too. */
static double volume(const Seen *s)
{
    double lower[OBJ_MAX] = {0}, reference[OBJ_MAX];
    Hypervolume *h;
    Err err = {0};
    for (size_t k = 0; k < OBJ_MAX; k++)
        reference[k] = 1.5;
    CHECK_OK(hypervolume_create(&h, here.problem.n_obj, lower, reference, 1, &err), &err);
    for (size_t i = 0; i < s->n; i++) {
        double f[OBJ_MAX];
        answer(&here, s->X + i * here.problem.n_var, f);
        hypervolume_add(h, f);
    }
    const double share = hypervolume_share(h);
    hypervolume_free(h);
    return share * pow(1.5, (double)here.problem.n_obj);
}

/* Beside eight workers, most of what a batch is chosen from is known a little later. */
TEST(the_search_is_nearly_as_good_as_one_in_batches)
{
    world(12, 3, 8);
    SearchConfig c = config(40, 200);
    search(&c, NULL, &whole);
    const double without_waiting = volume(&whole);
    forget_it(&whole);
    c.asynchronous = 0;
    search(&c, NULL, &whole);
    const double in_batches = volume(&whole);
    forget_it(&whole);
    c.asynchronous = 1;
    c.surrogate = SURROGATE_OFF;
    search(&c, NULL, &whole);
    const double plain = volume(&whole);
    forget_it(&whole);
    assert_less(0.97 * in_batches, without_waiting);
    assert_less(plain + 0.5 * (in_batches - plain), without_waiting);
}

/* What is under way when the search ends is taken in, what only waits is not simulated. */
TEST(every_limit_ends_with_all_that_was_simulated)
{
    world(6, 3, 4);
    here.problem.executor = NULL; /* threads */
    SearchConfig c = config(20, 200);
    c.generations = 5;
    search(&c, NULL, &whole);
    assert_int_equal(whole.reason, STOP_GENERATIONS);
    assert_int_equal(whole.last_generation, 5);
    forget_it(&whole);
    c = config(20, 200);
    c.nondominated_share = 0.3;
    search(&c, NULL, &whole);
    assert_int_equal(whole.reason, STOP_SHARE);
    assert_in_range(whole.n, 15, 199); /* 20 sampled; 3 workers and a quarter of a batch may be under way */
    assert_all_different(&whole);
    forget_it(&whole);
}

TEST(a_fault_of_the_simulations_ends_the_search)
{
    Err err = {0};
    StopReason reason;
    const SearchConfig c = config(20, 200);
    for (size_t after = 1; after < 60; after += 7) {
        world(6, 3, 4);
        here.fault_after = after;
        memset(&whole, 0, sizeof whole);
        assert_int_equal(search_run(&here.problem, &c, observe, &whole, &reason, &err), STATUS_IO);
        assert_string_equal(err.text, "the disk is full");
        forget_it(&whole);
    }
}

/* -- the program --------------------------------------------------------------------------------------------------- */

/* Every tenth request takes 100 ms, the others 5. */
#define UNEVEN(max_evals)                                                                                              \
    "[problem]\nkind = external\ncommand = sh tests/worker.sh uneven\nvariables = 2\nobjectives = 2\n[search]\n"       \
    "population = 24\ninitial = 20\nthreads = 4\nsurrogate = off\nmax_evals = " max_evals "\n"

/* How many of 60 designs fail where the 30th is answered only after eight later ones have been asked for. */
static long failed_where_one_waits(const char *name, int tenths, const char *more)
{
    char words[512];
    snprintf(
        words, sizeof words,
        "optimize @/uneven.ini --out @/%s --max-evals 60 --set 'problem.command=sh tests/worker.sh waits @/%s.ids 38 "
        "%d' %s",
        name, name, tenths, more);
    free(output_of(words));
    snprintf(words, sizeof words, "status @/%s --json", name);
    json_t *o = json_of(words);
    const long failed = (long)number(o, "failed");
    assert_same_number(number(o, "simulated"), 60);
    json_decref(o);
    return failed;
}

/* In batches of 4, one for each worker, those later ones come after the answer; in turns the other three workers go on. */
TEST(workers_of_uneven_speed_do_not_wait_for_each_other)
{
    write_in_place("uneven.ini", UNEVEN("120"));
    assert_int_equal(failed_where_one_waits("batches", 5, ""), 1);
    assert_int_equal(failed_where_one_waits("turns", 600, "--set search.asynchronous=on"), 0);
}

/* Long enough that it does not end between two commits. */
TEST(a_killed_run_goes_on_with_every_result_it_had)
{
    char path[PATH_MAX];
    Run before, after;
    Err err = {0};
    write_in_place("killed.ini", UNEVEN("400") "asynchronous = on\n");
    for (int kill_at = 10; kill_at < 110; kill_at += 90) {
        char name[24];
        snprintf(name, sizeof name, "killed%d", kill_at);
        path_of(name, path);
        const pid_t pid = start("killed.ini", name);
        for (size_t n = 0; n < (size_t)kill_at; rest(0.01))
            if (run_read(&before, path, &err) == STATUS_OK) {
                n = before.table.n;
                run_free(&before);
            }
        kill(pid, SIGKILL);
        wait_end(pid);
        CHECK_OK(run_read(&before, path, &err), &err);
        assert_in_range(before.table.n, kill_at, 399);
        free(output_of("optimize %s", path));
        CHECK_OK(run_read(&after, path, &err), &err);
        assert_int_equal(after.table.n, 400);
        assert_memory_equal(before.table.x, after.table.x, before.table.n * 2 * sizeof *before.table.x);
        assert_memory_equal(before.F, after.F, before.table.n * 2 * sizeof *before.F);
        for (size_t i = 0; i < after.table.n; i++) {
            assert_int_equal(after.table.row[i].id, i + 1);
            assert_int_not_equal(after.table.row[i].kind, KIND_UNFINISHED);
        }
        run_free(&before);
        run_free(&after);
    }
}

SUITE(prepare, clear_place)
