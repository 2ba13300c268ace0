/* A search that goes on from any generation's end makes the same bytes as one that never stopped. */
#include <omp.h>

#include "base/pack.h"
#include "searches.h"

typedef struct {
    Problem problem;
    Function function;
    double lower[SEEN_VAR], upper[SEEN_VAR];
    size_t fail_every; /* every so many-th design fails, told by its bytes; 0: none, 1: all */
    double noise;      /* [-] of the answers, told by the design's bytes too */
    double pause_s;    /* that an answer takes */
} World;

static int fails(const World *w, const double x[])
{
    uint64_t bits;
    memcpy(&bits, x, sizeof bits);
    return w->fail_every > 0 && (bits >> 20) % w->fail_every == 0;
}

static void evaluate(FunctionCall *q, void *user)
{
    const World *w = user;
    textbook_dtlz2(w->problem.n_var, w->problem.n_obj, q->x, q->f);
    for (size_t k = 0; w->noise > 0.0 && k < w->problem.n_obj; k++)
        q->f[k] += w->noise * sin(1e6 * q->x[0] + 1e7 * q->x[1] + (double)k);
    q->ok = !fails(w, q->x);
    if (w->pause_s > 0.0)
        rest(w->pause_s);
    if (w->problem.n_con > 0)
        q->g[0] = 0.3 - q->x[0];
}

static void world(World *w, size_t n_var, size_t n_obj, size_t n_con)
{
    memset(w, 0, sizeof *w);
    for (size_t d = 0; d < n_var; d++)
        w->upper[d] = 1.0;
    w->problem = function_problem(&w->function, n_var, n_obj, n_con, w->lower, w->upper, evaluate, w);
}

static SearchConfig config(size_t initial, size_t max_evals)
{
    SearchConfig c = search_config(7, 24, 40);
    c.initial = initial;
    c.max_evals = max_evals;
    return c;
}

static void assert_same_search(const World *w, const Seen *a, const Seen *b)
{
    const Problem *p = &w->problem;
    assert_int_equal(a->n, b->n);
    assert_int_equal(a->reason, b->reason);
    assert_int_equal(a->last_generation, b->last_generation);
    assert_memory_equal(a->X, b->X, a->n * p->n_var * sizeof *a->X);
    assert_memory_equal(a->Y, b->Y, a->n * p->n_obj * sizeof *a->Y);
    assert_memory_equal(a->ok, b->ok, a->n);
    assert_memory_equal(a->kind, b->kind, a->n);
    assert_memory_equal(a->on_front, b->on_front, a->n);
    assert_memory_equal(a->generation, b->generation, a->n * sizeof *a->generation);
    const size_t last_a = a->moments.n - 1, last_b = b->moments.n - 1;
    assert_int_equal(a->moments.n_state[last_a], b->moments.n_state[last_b]);
    assert_memory_equal(a->moments.state[last_a], b->moments.state[last_b], a->moments.n_state[last_a]);
}

static World here;
static Seen whole, resumed;
static EvaluationTable before; /* of the moment that was asked for last */

static SearchStart moment(const Seen *s, size_t k)
{
    const size_t n = s->moments.rows[k];
    evaluation_table_free(&before);
    before = evaluations_of(&here.problem, 1, n, s->X, s->Y, s->G, s->ok, s->kind, s->generation);
    return (SearchStart){n, 0, before.row, s->moments.state[k], s->moments.n_state[k], NULL, NULL};
}

/* From every `step`-th moment but the last. */
static void check_every_moment(SearchConfig c, size_t step)
{
    run_noting(&here.problem, &c, NULL, &whole);
    assert_less(step + 1, whole.moments.n);
    for (size_t k = 0; k + 1 < whole.moments.n; k += step) {
        const SearchStart start = moment(&whole, k);
        run_noting(&here.problem, &c, &start, &resumed);
        assert_int_equal(resumed.first_generation, k + 1);
        assert_same_search(&here, &whole, &resumed);
    }
}

TEST(a_search_goes_on_from_any_generation_as_if_it_had_never_stopped)
{
    world(&here, 6, 3, 0);
    check_every_moment(config(20, 60), 1);
}

TEST(seven_objectives_go_on_the_same)
{
    world(&here, 22, 7, 0);
    check_every_moment(config(30, 54), 3);
}

TEST(failed_and_infeasible_designs_do_not_change_that)
{
    world(&here, 5, 2, 1);
    here.fail_every = 4;
    check_every_moment(config(16, 52), 2);
}

TEST(whole_numbers_choices_and_logarithms_go_on_the_same)
{
    static const VariableKind KINDS[] = {VARIABLE_REAL,  VARIABLE_LOG,    VARIABLE_WHOLE,
                                         VARIABLE_WHOLE, VARIABLE_CHOICE, VARIABLE_CHOICE};
    static const double UPPER[] = {1, 1, 5, 40, 2, 4};
    world(&here, 6, 3, 0);
    memcpy(here.upper, UPPER, sizeof UPPER);
    here.lower[1] = 1e-3;
    here.problem.kind = KINDS;
    check_every_moment(config(20, 90), 2);
}

/* The surface foretells badly: what is remembered of that decides about the next batch. */
TEST(a_surface_that_is_half_believed_goes_on_the_same)
{
    world(&here, 4, 2, 0);
    here.noise = 0.6;
    check_every_moment(config(16, 110), 8);
}

TEST(plain_children_and_a_world_where_everything_fails_go_on_the_same)
{
    world(&here, 6, 3, 0);
    SearchConfig c = config(20, 80);
    c.surrogate = SURROGATE_OFF;
    check_every_moment(c, 4);
    here.fail_every = 1;
    check_every_moment(c, 1);
}

TEST(the_number_of_threads_may_change_in_between)
{
    const int threads = omp_get_max_threads();
    const SearchConfig c = config(20, 48);
    world(&here, 6, 3, 0);
    omp_set_num_threads(1);
    run_noting(&here.problem, &c, NULL, &whole);
    omp_set_num_threads(3);
    const SearchStart start = moment(&whole, whole.moments.n / 2);
    run_noting(&here.problem, &c, &start, &resumed);
    omp_set_num_threads(threads);
    assert_same_search(&here, &whole, &resumed);
}

/* With the same plan the shorter search is the beginning of the longer one. */
TEST(more_simulations_than_planned_go_on_where_the_plan_ended)
{
    world(&here, 6, 3, 0);
    SearchConfig c = config(0, 40);
    c.planned_evals = 40;
    run_noting(&here.problem, &c, NULL, &resumed);
    assert_int_equal(resumed.reason, STOP_EVALUATIONS);
    c.max_evals = 64;
    run_noting(&here.problem, &c, NULL, &whole);
    assert_int_equal(whole.n, 64);
    assert_memory_equal(resumed.X, whole.X, resumed.n * here.problem.n_var * sizeof *resumed.X);

    static Seen longer;
    const SearchStart start = moment(&resumed, resumed.moments.n - 1);
    run_noting(&here.problem, &c, &start, &longer);
    assert_int_equal(longer.n, 64);
    assert_memory_equal(resumed.X, longer.X, resumed.n * here.problem.n_var * sizeof *resumed.X);
}

TEST(a_search_at_its_limit_simulates_nothing_more)
{
    world(&here, 6, 3, 0);
    const SearchConfig c = config(20, 32);
    run_noting(&here.problem, &c, NULL, &whole);
    const SearchStart end = moment(&whole, whole.moments.n - 1);
    run_noting(&here.problem, &c, &end, &resumed);
    assert_int_equal(resumed.reason, STOP_EVALUATIONS);
    assert_int_equal(resumed.moments.n, 0);
}

static void refuse(const SearchConfig *c, const SearchStart *start)
{
    StopReason reason;
    assert_refused(search_run(&here.problem, c, start, moment_note, &resumed, &reason, &err), STATUS_BAD_DATA,
                   "does not fit");
    assert_int_equal(resumed.moments.n, 0);
}

TEST(a_state_that_is_cut_short_or_of_another_search_is_refused)
{
    world(&here, 6, 3, 0);
    SearchConfig c = config(20, 32);
    run_noting(&here.problem, &c, NULL, &whole);
    moments_free(&resumed.moments);
    SearchStart start = moment(&whole, 1);
    for (size_t n = 0; n < start.n_state; n += 1 + n / 16) {
        SearchStart cut = start;
        cut.n_state = n;
        refuse(&c, &cut);
    }
    start.n--;
    refuse(&c, &start);
    start.n++;
    c.population++;
    refuse(&c, &start);
}

TEST(a_search_that_converges_stops_at_the_same_place_wherever_it_was_resumed)
{
    world(&here, 3, 2, 0);
    SearchConfig c = config(20, 290);
    c.stop_after = 100;
    check_every_moment(c, 5);
    run_noting(&here.problem, &c, NULL, &whole);
    assert_int_equal(whole.reason, STOP_CONVERGED);
    const SearchStart end = moment(&whole, whole.moments.n - 1);
    run_noting(&here.problem, &c, &end, &resumed);
    assert_int_equal(resumed.reason, STOP_CONVERGED);
    assert_int_equal(resumed.moments.n, 0);
    c.stop_after = 0; /* it goes on, as if it had never been asked to stop */
    run_noting(&here.problem, &c, &end, &resumed);
    assert_int_equal(resumed.reason, STOP_EVALUATIONS);
}

/* Every eight bytes of it in turn, what is known of the designs that it waits for too. */
static void check_this_is_refused_everywhere(double number)
{
    world(&here, 3, 2, 0);
    const SearchConfig c = config(12, 44);
    run_noting(&here.problem, &c, NULL, &whole);
    moments_free(&resumed.moments);
    SearchStart start = moment(&whole, whole.moments.n / 2);
    FREED unsigned char *forged = malloc(start.n_state);
    assert_non_null(forged);
    for (size_t at = 0; at + sizeof number <= start.n_state; at += sizeof number) {
        memcpy(forged, start.state, start.n_state);
        memcpy(forged + at, &number, sizeof number);
        SearchStart other = start;
        other.state = forged;
        refuse(&c, &other);
    }
}

TEST(a_state_with_a_number_anywhere_that_is_not_finite_is_refused)
{
    FOR_EACH (double, number, NAN, INFINITY, -INFINITY)
        check_this_is_refused_everywhere(*number);
}

/* What a Pack reads is what it wrote; a fault stops it before anything is changed. */
TEST(a_pack_reads_what_it_wrote_and_keeps_the_first_fault)
{
    double value = 0.1, back = 0.0;
    size_t count = 12, counted = 0;
    Pack out = {0};
    pack_expect(&out, 3);
    pack_size(&out, &count, 12);
    pack(&out, &value, sizeof value);
    assert_true(pack_finished(&out));
    Pack in = {.bytes = out.bytes, .n = out.n, .reading = 1};
    pack_expect(&in, 3);
    pack_size(&in, &counted, 12);
    assert_false(pack_finished(&in));
    pack(&in, &back, sizeof back);
    assert_true(pack_finished(&in));
    assert_int_equal(counted, 12);
    assert_same_number(back, value);
    in = (Pack){.bytes = out.bytes, .n = out.n, .reading = 1};
    back = 0.0;
    pack_expect(&in, 3);
    pack_size(&in, &counted, 11);
    pack(&in, &back, sizeof back);
    assert_false(pack_finished(&in));
    assert_same_number(back, 0.0);
    free(out.bytes);
}

static int quiet(void **state)
{
    (void)state;
    linalg_pin();
    omp_set_num_threads(1); /* more than one has a test of its own */
    return 0;
}

SUITE(quiet, NULL)
