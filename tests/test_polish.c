#include "functions.h"
#include "study/polish.h"

enum { VAR = 3, OBJ = 2 };

static const double LOWER[VAR] = {-1, -1, -1}, UPPER[VAR] = {2, 2, 2};

/* Of the start, and the least that is allowed. */
static const double START[VAR] = {0, 0.9, -0.6}, AT_START = 2.17;

typedef struct {
    size_t n;
    int fails, breaks;
    double jag;      /* height of saw teeth on both objectives */
    double gain_min; /* of the goal */
} Toy;

static double tooth(double x)
{
    return x * 100.0 - floor(x * 100.0);
}

/* f1 = |x - (1, 0, 0)|^2, f2 = 1 + x1: with f2 kept at its start value x1 = 0, the best is (0, 0, 0), f1 = 1. */
static void evaluate(FunctionCall *q, void *user)
{
    Toy *w = user;
    const double *x = q->x;
    q->f[0] = (x[0] - 1) * (x[0] - 1) + x[1] * x[1] + x[2] * x[2];
    q->f[1] = 1 + x[0];
    for (size_t k = 0; k < OBJ && w->jag > 0.0; k++)
        q->f[k] += w->jag * (tooth(x[0] + 0.3 * x[1]) + tooth(x[2] - 0.7 * x[1]));
    q->ok = !(w->fails && w->n > 0 && (w->fails == 2 || w->n % 3 == 0));
    if (!q->ok)
        q->f[0] = w->n % 2 ? NAN : -1e300; /* what is written beside a failure must not be believed */
    w->n++;
    if (w->breaks && w->n > 5)
        q->status = (fail)(q->why, STATUS_IO, "the disk is full");
}

static const double FIRST[OBJ] = {1, 0}, KEPT[OBJ] = {INFINITY, 1}, FREE[OBJ] = {INFINITY, INFINITY};

typedef struct {
    double x[VAR], f[OBJ];
    size_t n_evaluated, n_failed;
} Polished;

/* From the start, whose own answer is known; at least one bound: COBYLA, else BOBYQA. */
static Status polish(Toy *w, const double weight[], const double bound[], size_t evals, Polished *r, Err *why)
{
    Toy exact = {.jag = w->jag};
    Function place;
    Improved out = {0};
    const Problem problem = function_problem(&place, VAR, OBJ, 0, LOWER, UPPER, evaluate, w);
    Improver m = {.problem = &problem,
                  .out = &out,
                  .replicates = 1,
                  .enough = -INFINITY,
                  .gain_min = w->gain_min,
                  .budget = evals};
    CHECK_OK(queue_open(&m.queue, &problem, why), why);
    CHECK_OK(improver_reserve(&m, why), why);
    memcpy(m.x, START, sizeof START);
    evaluate(&(FunctionCall){.x = m.x, .f = m.first}, &exact);
    for (size_t k = 0; k < OBJ; k++) {
        m.weight[k] = weight[k];
        m.scale[k] = 1;
        m.slack[k] = bound[k] - m.first[k];
    }
    m.value = improver_sum(&m, m.first);
    const Status status = polish_descend(&m, why);
    *r = (Polished){.n_evaluated = out.cost.n_evaluated, .n_failed = out.cost.n_failed};
    memcpy(r->x, m.x, sizeof r->x);
    evaluate(&(FunctionCall){.x = r->x, .f = r->f}, &exact);
    assert_close(m.value, improver_sum(&m, r->f), 1e-12); /* what was believed is what it is */
    queue_close(m.queue);
    free(m.store);
    return status;
}

TEST(an_objective_is_lowered_to_what_the_bound_on_the_other_allows)
{
    Toy w = {0};
    Polished r;
    CHECK_OK(polish(&w, FIRST, KEPT, 200, &r, &err), &err);
    assert_at_most(r.f[1], 1.0);
    assert_close(r.f[0], 1.0, 1e-3);
    assert_int_equal(r.n_evaluated, w.n);
}

/* Least f1: (1, 0, 0); least 2 f1 + f2: x1 = 3/4, f = 1/16, 7/4. */
TEST(without_anything_to_keep_the_free_minimum_of_a_weighted_sum_is_found)
{
    const double both[OBJ] = {2, 1};
    Toy w = {0};
    Polished r;
    CHECK_OK(polish(&w, FIRST, FREE, 100, &r, &err), &err);
    assert_less(r.f[0], 1e-6);
    CHECK_OK(polish(&w, both, FREE, 100, &r, &err), &err);
    assert_close(2 * r.f[0] + r.f[1], 2.0 / 16 + 1.75, 1e-6);
}

/* Teeth as high as a tenth of the start, much closer to each other than the steps. */
TEST(on_a_jagged_objective_there_is_a_gain_and_the_bound_is_kept_again_and_again)
{
    const double bound[OBJ] = {INFINITY, 1.2};
    double first[VAR];
    for (int again = 0; again < 2; again++) {
        Toy w = {.jag = 0.1};
        Polished r;
        CHECK_OK(polish(&w, FIRST, bound, 120, &r, &err), &err);
        assert_at_most(r.f[1], 1.2);
        assert_less(r.f[0], 0.6 * AT_START);
        if (again)
            assert_memory_equal(r.x, first, sizeof first);
        memcpy(first, r.x, sizeof first);
    }
}

TEST(no_more_simulations_are_made_than_allowed)
{
    for (int keeps = 0; keeps < 2; keeps++)
        for (size_t evals = 0; evals < 40; evals += 13) {
            Toy w = {0};
            Polished r;
            CHECK_OK(polish(&w, FIRST, keeps ? KEPT : FREE, evals, &r, &err), &err);
            assert_at_most(w.n, evals);
            assert_at_most(r.f[0], AT_START + 1e-12);
        }
}

/* From 2.17 to 1: a thousand times what is worth a descent; the last digits are not. */
TEST(what_is_left_to_gain_is_not_followed_below_what_is_worth_it)
{
    Toy w = {.gain_min = 1e-3};
    Polished r;
    CHECK_OK(polish(&w, FIRST, KEPT, 5000, &r, &err), &err);
    assert_close(r.f[0], 1.0, 5e-3);
    assert_less(w.n, 200);
}

TEST(failed_simulations_are_a_finite_wall_and_never_the_answer)
{
    for (int fails = 1; fails <= 2; fails++)
        for (int keeps = 0; keeps < 2; keeps++) {
            Toy w = {.fails = fails};
            Polished r;
            CHECK_OK(polish(&w, FIRST, keeps ? KEPT : FREE, 300, &r, &err), &err);
            assert_less(0, r.n_failed);
            assert_at_most(w.n, 300);
            assert_true(isfinite(r.f[0]));
            assert_at_most(r.f[0], AT_START + 1e-12);
            assert_at_most(keeps ? 0.99 : 0.0, r.f[0]);
        }
}

TEST(a_program_fault_ends_it_with_its_message)
{
    Toy w = {.breaks = 1};
    Polished r;
    assert_refused(polish(&w, FIRST, KEPT, 300, &r, &err), STATUS_IO, "disk");
}

TEST(a_gain_counts_beyond_twice_its_error_where_the_rest_is_kept)
{
    const struct {
        int has_changed, keeps;
        double gain, error, finer;
        int counts;
    } rows[] = {{1, 1, 0.21, 0.1, NAN, 1},  {1, 1, 0.19, 0.1, NAN, 0},      {1, 0, 0.21, 0.1, NAN, 0},
                {0, 1, 0.21, 0.1, NAN, 0},  {1, 1, 0.01, NAN, NAN, 1},      {1, 1, 0.002, 0, NAN, 1},
                {1, 1, 5e-4, 0, NAN, 0},    {1, 1, 5e-4, NAN, NAN, 0},      {1, 1, 0.21, 0.1, 0.19, 0},
                {1, 1, 0.21, 0.1, 0.21, 1}, {1, 1, 0.21, 0.1, -INFINITY, 0}};
    for (size_t i = 0; i < sizeof rows / sizeof rows[0]; i++)
        if (polish_counts(&(Improved){.has_changed = rows[i].has_changed,
                                      .keeps = rows[i].keeps,
                                      .gain = rows[i].gain,
                                      .gain_error = rows[i].error,
                                      .gain_finer = rows[i].finer}) != rows[i].counts)
            fail_msg("row %zu does not count as it should", i);
}

SUITE(NULL, NULL)
