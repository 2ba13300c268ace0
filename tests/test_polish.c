#include <math.h>
#include <string.h>

#include "functions.h"
#include "base/random.h"
#include "study/local.h"
#include "study/polish.h"
#include "study/refine.h"

enum { VAR = 3, OBJ = 2 };

static const char *const ALGORITHMS[] = {"cobyla", "bobyqa", "sbplx", "isres"};
static const double LOWER[VAR] = {-1, -1, -1}, UPPER[VAR] = {2, 2, 2};

/* Of the start, and the least that is allowed. */
static const double START[VAR] = {0, 0.9, -0.6}, AT_START = 2.17;

typedef struct {
    size_t n;
    int fails, breaks;
    double jag; /* height of saw teeth on both objectives */
} Toy;

static double tooth(double x)
{
    return x * 100.0 - floor(x * 100.0);
}

/* f1 = |x - (1, 0, 0)|^2, f2 = 1 + x1: with f2 kept at its start value x1 = 0, the best is (0, 0, 0), f1 = 1. */
static Status evaluate(size_t n, const double X[], const size_t draws[], double F[], double G[], unsigned char ok[],
                       void *user, Err *err)
{
    (void)draws;
    Toy *w = user;
    (void)G;
    for (size_t i = 0; i < n; i++) {
        const double *x = X + i * VAR;
        F[i * OBJ] = (x[0] - 1) * (x[0] - 1) + x[1] * x[1] + x[2] * x[2];
        F[i * OBJ + 1] = 1 + x[0];
        for (size_t k = 0; k < OBJ && w->jag > 0.0; k++)
            F[i * OBJ + k] += w->jag * (tooth(x[0] + 0.3 * x[1]) + tooth(x[2] - 0.7 * x[1]));
        ok[i] = !(w->fails && w->n > 0 && (w->fails == 2 || w->n % 3 == 0));
        if (!ok[i])
            F[i * OBJ] = w->n % 2 ? NAN : -1e300; /* what is written beside a failure must not be believed */
        w->n++;
    }
    return w->breaks && w->n > 5 ? (fail)(err, STATUS_IO, "the disk is full") : STATUS_OK;
}

/* f2 kept at its start value, or free. */
static Status polish(Toy *w, const char *algorithm, int keep_second, size_t evals, PolishResult *r, Err *err)
{
    static double x[VAR], f[OBJ];
    const double weight[OBJ] = {1, 0}, bound[OBJ] = {INFINITY, keep_second ? 1.0 : INFINITY};
    Function place;
    Queue *q;
    const Problem problem = function_problem(&place, VAR, OBJ, 0, LOWER, UPPER, evaluate, w);
    const PolishConfig c = {.algorithm = algorithm, .goal = {weight, bound}, .max_evals = evals, .seed = 1};
    *r = (PolishResult){.x = x, .f = f};
    CHECK_OK(queue_open(&q, &problem, QUEUE_AS_ASKED, 0, 0, err), err);
    const Status status = polish_run(q, &c, START, r, err);
    queue_close(q);
    return status;
}

enum { KNOWN = 20 };

/* The same with a surface on some designs of a hypercube, from the start's own values. */
static Status follow(Toy *w, const double weight[], const double bound[], size_t n_known, size_t evals, LocalResult *r,
                     Err *err)
{
    static double x[VAR], f[OBJ], X[KNOWN * VAR], F[KNOWN * OBJ], noise[KNOWN];
    Toy exact = {.jag = w->jag};
    unsigned char ok[KNOWN];
    Function place;
    Queue *q;
    const Problem problem = function_problem(&place, VAR, OBJ, 0, LOWER, UPPER, evaluate, w);
    Random random = random_stream(1, RANDOM_TEST, 0, 0);
    for (size_t i = 0; i < KNOWN * VAR; i++)
        X[i] = -1 + 3 * random_uniform(&random);
    for (size_t i = 0; i < KNOWN; i++)
        noise[i] = 1.0;
    memcpy(x, START, sizeof x);
    evaluate(KNOWN, X, NULL, F, NULL, ok, &exact, err);
    evaluate(1, x, NULL, f, NULL, ok, &exact, err);
    const LocalConfig c = {
        .goal = {weight, bound}, .known = {n_known, X, F, noise}, .noise = 1.0, .max_evals = evals, .seed = 1};
    *r = (LocalResult){.x = x, .f = f};
    CHECK_OK(queue_open(&q, &problem, QUEUE_AS_ASKED, 0, 0, err), err);
    const Status status = local_run(q, &c, r, err);
    queue_close(q);
    return status;
}

static const double FIRST[OBJ] = {1, 0}, KEPT[OBJ] = {INFINITY, 1};

static void test_every_algorithm_improves_what_it_is_asked_to_and_keeps_the_rest(void **state)
{
    (void)state;
    for (size_t i = 0; i < sizeof ALGORITHMS / sizeof ALGORITHMS[0]; i++) {
        Toy w = {0};
        PolishResult r;
        Err err = {0};
        CHECK_OK(polish(&w, ALGORITHMS[i], 1, 2000, &r, &err), &err);
        if (!(r.f[0] < 1.1 && r.f[0] >= 1.0 - 1e-9 && r.f[1] <= 1.0))
            fail_msg("%s: f = %g, %g", ALGORITHMS[i], r.f[0], r.f[1]);
        assert_int_equal(r.n_evaluated, w.n);
    }
}

static void test_without_anything_to_keep_the_free_minimum_is_found(void **state)
{
    (void)state;
    Toy w = {0};
    PolishResult r;
    Err err = {0};
    CHECK_OK(polish(&w, "cobyla", 0, 500, &r, &err), &err);
    assert_less(r.f[0], 1e-3);
}

static void test_no_more_simulations_are_made_than_allowed(void **state)
{
    (void)state;
    for (size_t i = 0; i < sizeof ALGORITHMS / sizeof ALGORITHMS[0]; i++)
        for (size_t evals = 1; evals < 40; evals += 13) {
            Toy w = {0};
            PolishResult r;
            Err err = {0};
            CHECK_OK(polish(&w, ALGORITHMS[i], 1, evals, &r, &err), &err);
            assert_at_most(w.n, evals);
            assert_at_most(r.f[0], AT_START + 1e-12);
        }
}

static void test_failed_simulations_are_a_finite_wall_and_never_the_answer(void **state)
{
    (void)state;
    for (int fails = 1; fails <= 2; fails++)
        for (size_t i = 0; i < sizeof ALGORITHMS / sizeof ALGORITHMS[0]; i++) {
            Toy w = {.fails = fails};
            PolishResult r;
            Err err = {0};
            CHECK_OK(polish(&w, ALGORITHMS[i], 1, 300, &r, &err), &err);
            assert_true(r.n_failed > 0 && w.n <= 300);
            assert_true(isfinite(r.f[0]) && r.f[0] <= AT_START + 1e-12 && r.f[0] > 0.9);
            assert_true(fails == 1 || fabs(r.f[0] - AT_START) < 1e-12);
        }
}

static void test_a_program_fault_ends_it_with_its_message(void **state)
{
    (void)state;
    Toy w = {.breaks = 1};
    PolishResult r;
    Err err = {0};
    assert_int_equal(polish(&w, "cobyla", 1, 300, &r, &err), STATUS_IO);
    assert_non_null(strstr(err.text, "disk"));
    assert_int_equal(polish(&w, "simplex", 1, 300, &r, &err), STATUS_USAGE);
}

static void test_the_surface_leads_to_the_least_value_that_the_bound_allows(void **state)
{
    (void)state;
    Toy w = {0};
    LocalResult r;
    Err err = {0};
    CHECK_OK(follow(&w, FIRST, KEPT, KNOWN, 60, &r, &err), &err);
    assert_int_equal(w.n, r.n_evaluated);
    assert_true(w.n <= 60 && r.f[1] <= 1.0);
    assert_close(r.f[0], 1.0, 1e-2);
}

/* Least 2 f1 + f2: x1 = 3/4, f = 1/16, 7/4. */
static void test_a_weighted_sum_of_objectives_is_lowered(void **state)
{
    (void)state;
    const double weight[OBJ] = {2, 1}, bound[OBJ] = {INFINITY, INFINITY};
    Toy w = {0};
    LocalResult r;
    Err err = {0};
    CHECK_OK(follow(&w, weight, bound, KNOWN, 60, &r, &err), &err);
    assert_close(2 * r.f[0] + r.f[1], 2.0 / 16 + 1.75, 1e-3);
}

/* Teeth as high as a tenth of the start, much closer to each other than the designs: no surface foresees them. */
static void test_on_a_jagged_objective_there_is_a_gain_and_the_bound_is_kept(void **state)
{
    (void)state;
    Toy w = {.jag = 0.1};
    LocalResult r;
    Err err = {0};
    double bound[OBJ] = {INFINITY, 1.2};
    CHECK_OK(follow(&w, FIRST, bound, KNOWN, 120, &r, &err), &err);
    assert_true(r.f[1] <= 1.2 && r.f[0] < 0.6 * AT_START);
}

static void test_the_same_seed_tries_the_same_designs(void **state)
{
    (void)state;
    Toy w = {.jag = 0.1};
    LocalResult r;
    Err err = {0};
    double first[VAR];
    CHECK_OK(follow(&w, FIRST, KEPT, KNOWN, 30, &r, &err), &err);
    memcpy(first, r.x, sizeof first);
    CHECK_OK(follow(&w, FIRST, KEPT, KNOWN, 30, &r, &err), &err);
    assert_memory_equal(r.x, first, sizeof first);
}

static void test_the_surface_never_believes_a_failed_evaluation_and_ends_in_time(void **state)
{
    (void)state;
    for (int fails = 1; fails <= 2; fails++) {
        Toy w = {.fails = fails};
        LocalResult r;
        Err err = {0};
        CHECK_OK(follow(&w, FIRST, KEPT, KNOWN, 41, &r, &err), &err);
        assert_int_equal(w.n, 41);
        assert_true(r.n_failed > 10 && isfinite(r.f[0]) && r.f[0] > 0.99 && r.f[1] <= 1.0);
        assert_true(r.f[0] < AT_START - 0.1 || fails == 2);
    }
}

static void test_too_few_designs_make_no_surface_and_a_fault_ends_it(void **state)
{
    (void)state;
    Toy w = {0}, broken = {.breaks = 1};
    LocalResult r;
    Err err = {0};
    CHECK_OK(follow(&w, FIRST, KEPT, VAR, 60, &r, &err), &err);
    assert_int_equal(r.n_evaluated, 0);
    assert_close(r.f[0], AT_START, 1e-12);
    assert_int_equal(follow(&broken, FIRST, KEPT, KNOWN, 60, &r, &err), STATUS_IO);
}

static void test_a_gain_counts_beyond_twice_its_error_where_the_rest_is_kept(void **state)
{
    (void)state;
    assert_true(
        refined_counts(&(Refined){.has_changed = 1, .keeps = 1, .gain_finer = NAN, .gain = 0.21, .gain_error = 0.1}));
    assert_false(
        refined_counts(&(Refined){.has_changed = 1, .keeps = 1, .gain_finer = NAN, .gain = 0.19, .gain_error = 0.1}));
    assert_false(
        refined_counts(&(Refined){.has_changed = 1, .keeps = 0, .gain_finer = NAN, .gain = 0.21, .gain_error = 0.1}));
    assert_false(
        refined_counts(&(Refined){.has_changed = 0, .keeps = 1, .gain_finer = NAN, .gain = 0.21, .gain_error = 0.1}));
    assert_true(
        refined_counts(&(Refined){.has_changed = 1, .keeps = 1, .gain_finer = NAN, .gain = 0.01, .gain_error = NAN}));
    assert_true(
        refined_counts(&(Refined){.has_changed = 1, .keeps = 1, .gain_finer = NAN, .gain = 0.002, .gain_min = 0.001}));
    assert_false(
        refined_counts(&(Refined){.has_changed = 1, .keeps = 1, .gain_finer = NAN, .gain = 5e-4, .gain_min = 0.001}));
    assert_false(refined_counts(&(Refined){
        .has_changed = 1, .keeps = 1, .gain_finer = NAN, .gain = 5e-4, .gain_min = 0.001, .gain_error = NAN}));
    assert_false(
        refined_counts(&(Refined){.has_changed = 1, .keeps = 1, .gain = 0.21, .gain_error = 0.1, .gain_finer = 0.19}));
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_every_algorithm_improves_what_it_is_asked_to_and_keeps_the_rest),
        cmocka_unit_test(test_without_anything_to_keep_the_free_minimum_is_found),
        cmocka_unit_test(test_no_more_simulations_are_made_than_allowed),
        cmocka_unit_test(test_failed_simulations_are_a_finite_wall_and_never_the_answer),
        cmocka_unit_test(test_a_program_fault_ends_it_with_its_message),
        cmocka_unit_test(test_the_surface_leads_to_the_least_value_that_the_bound_allows),
        cmocka_unit_test(test_a_weighted_sum_of_objectives_is_lowered),
        cmocka_unit_test(test_on_a_jagged_objective_there_is_a_gain_and_the_bound_is_kept),
        cmocka_unit_test(test_the_same_seed_tries_the_same_designs),
        cmocka_unit_test(test_the_surface_never_believes_a_failed_evaluation_and_ends_in_time),
        cmocka_unit_test(test_too_few_designs_make_no_surface_and_a_fault_ends_it),
        cmocka_unit_test(test_a_gain_counts_beyond_twice_its_error_where_the_rest_is_kept),
    };
    return cmocka_run_group_tests_name("polish", tests, NULL, NULL);
}
