#include <string.h>

#include "check.h"
#include "polish/polish.h"

enum { VAR = 3, OBJ = 2 };

static const char *const ALGORITHMS[] = {"cobyla", "bobyqa", "sbplx", "isres"};
static const double LOWER[VAR] = {-1, -1, -1}, UPPER[VAR] = {2, 2, 2};

typedef struct {
    size_t n;
    int fails, breaks;
} World;

/* f1 = |x - (1, 0, 0)|^2, f2 = 1 + x1: with f2 kept at its start value x1 = 0, the best is (0, 0, 0), f1 = 1. */
static Status evaluate(size_t n, const double X[], const size_t draws[], double F[], double G[], unsigned char ok[],
                       void *user, Err *err)
{
    (void)draws;
    World *w = user;
    (void)G;
    for (size_t i = 0; i < n; i++) {
        const double *x = X + i * VAR;
        F[i * OBJ] = (x[0] - 1) * (x[0] - 1) + x[1] * x[1] + x[2] * x[2];
        F[i * OBJ + 1] = 1 + x[0];
        ok[i] = !(w->fails && w->n > 0 && (w->fails == 2 || w->n % 3 == 0));
        if (!ok[i])
            F[i * OBJ] = w->n % 2 ? NAN : -1e300; /* what is written beside a failure must not be believed */
        w->n++;
    }
    return w->breaks && w->n > 5 ? (fail)(err, STATUS_IO, "the disk is full") : STATUS_OK;
}

static Status polish(World *w, const char *algorithm, int keep_second, size_t evals, PolishResult *r, Err *err)
{
    static double x[VAR], f[OBJ], f_start[OBJ];
    static const double slack[OBJ] = {0, 0}, start[VAR] = {0, 0.9, -0.6};
    const unsigned char keep[OBJ] = {1, (unsigned char)keep_second};
    const Problem problem = {VAR, OBJ, 0, LOWER, UPPER, evaluate, NULL, w, 0, NULL, 0};
    const PolishConfig c = {
        .algorithm = algorithm, .improve = 0, .keep = keep, .slack = slack, .max_evals = evals, .seed = 1};
    *r = (PolishResult){.x = x, .f = f, .f_start = f_start};
    return polish_run(&problem, &c, start, r, err);
}

static void test_every_algorithm_improves_what_it_is_asked_to_and_keeps_the_rest(void **state)
{
    (void)state;
    for (size_t i = 0; i < sizeof ALGORITHMS / sizeof ALGORITHMS[0]; i++) {
        World w = {0};
        PolishResult r;
        Err err = {0};
        CHECK_OK(polish(&w, ALGORITHMS[i], 1, 2000, &r, &err), &err);
        assert_close(r.f_start[0], 2.17, 1e-12);
        if (!(r.f[0] < 1.1 && r.f[0] >= 1.0 - 1e-9 && r.f[1] <= 1.0))
            fail_msg("%s: f = %g, %g", ALGORITHMS[i], r.f[0], r.f[1]);
        assert_int_equal(r.n_evaluated, w.n);
    }
}

static void test_without_anything_to_keep_the_free_minimum_is_found(void **state)
{
    (void)state;
    World w = {0};
    PolishResult r;
    Err err = {0};
    CHECK_OK(polish(&w, "cobyla", 0, 500, &r, &err), &err);
    assert_true(r.f[0] < 1e-3);
}

static void test_no_more_simulations_are_made_than_allowed(void **state)
{
    (void)state;
    for (size_t i = 0; i < sizeof ALGORITHMS / sizeof ALGORITHMS[0]; i++)
        for (size_t evals = 1; evals < 40; evals += 13) {
            World w = {0};
            PolishResult r;
            Err err = {0};
            CHECK_OK(polish(&w, ALGORITHMS[i], 1, evals, &r, &err), &err);
            assert_true(w.n <= evals);
            assert_true(r.f[0] <= r.f_start[0]);
        }
}

static void test_failed_simulations_are_a_finite_wall_and_never_the_answer(void **state)
{
    (void)state;
    for (int fails = 1; fails <= 2; fails++)
        for (size_t i = 0; i < sizeof ALGORITHMS / sizeof ALGORITHMS[0]; i++) {
            World w = {.fails = fails};
            PolishResult r;
            Err err = {0};
            CHECK_OK(polish(&w, ALGORITHMS[i], 1, 300, &r, &err), &err);
            assert_true(r.n_failed > 0 && w.n <= 300);
            assert_true(isfinite(r.f[0]) && r.f[0] <= r.f_start[0] && r.f[0] > 0.9);
            assert_true(fails == 1 || r.f[0] == r.f_start[0]);
        }
}

static void test_a_program_fault_ends_it_with_its_message(void **state)
{
    (void)state;
    World w = {.breaks = 1};
    PolishResult r;
    Err err = {0};
    assert_int_equal(polish(&w, "cobyla", 1, 300, &r, &err), STATUS_IO);
    assert_non_null(strstr(err.text, "disk"));
    assert_int_equal(polish(&w, "simplex", 1, 300, &r, &err), STATUS_USAGE);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_every_algorithm_improves_what_it_is_asked_to_and_keeps_the_rest),
        cmocka_unit_test(test_without_anything_to_keep_the_free_minimum_is_found),
        cmocka_unit_test(test_no_more_simulations_are_made_than_allowed),
        cmocka_unit_test(test_failed_simulations_are_a_finite_wall_and_never_the_answer),
        cmocka_unit_test(test_a_program_fault_ends_it_with_its_message),
    };
    return cmocka_run_group_tests_name("polish", tests, NULL, NULL);
}
