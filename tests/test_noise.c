/* Answers that scatter: what is learnt of the spread, who dominates whom then, what is simulated again and reported. */
#include "moga/archive.h"
#include "searches.h"
#include "moga/noise.h"
#include "moga/surrogate.h"

/* -- dominance ----------------------------------------------------------------------------------------------------- */

enum { POINTS = 40, M = 3 };

typedef struct {
    double F[POINTS * M], error[POINTS * M];
} Cloud;

/* On a coarse grid, so that equal values and intervals that touch are frequent. */
static Cloud cloud(uint32_t seed, int with_errors)
{
    Cloud c;
    Random r = random_stream(seed, RANDOM_TEST, 0, 0);
    for (size_t i = 0; i < POINTS * M; i++) {
        c.F[i] = (double)random_below(&r, 8);
        c.error[i] = with_errors ? 0.5 * (double)random_below(&r, 3) : 0.0;
    }
    return c;
}

static int surely(const Cloud *c, size_t a, size_t b)
{
    return dominates_surely(M, c->F + a * M, c->error + a * M, c->F + b * M, c->error + b * M);
}

TEST(without_errors_surely_is_plainly)
{
    for (uint32_t seed = 0; seed < 20; seed++) {
        const Cloud c = cloud(seed, 0);
        for (size_t a = 0; a < POINTS; a++)
            for (size_t b = 0; b < POINTS; b++)
                assert_int_equal(surely(&c, a, b), dominates(M, c.F + a * M, c.F + b * M));
    }
}

TEST(surely_is_a_strict_partial_order_whatever_the_errors)
{
    size_t pairs = 0;
    for (uint32_t seed = 0; seed < 20; seed++) {
        const Cloud c = cloud(seed, 1);
        for (size_t a = 0; a < POINTS; a++)
            for (size_t b = 0; b < POINTS; b++) {
                if (!surely(&c, a, b))
                    continue;
                pairs++;
                assert_false(surely(&c, b, a));
                assert_true(dominates(M, c.F + a * M, c.F + b * M));
                for (size_t d = 0; d < POINTS; d++)
                    assert_true(!surely(&c, b, d) || surely(&c, a, d));
            }
        for (size_t a = 0; a < POINTS; a++)
            assert_false(surely(&c, a, a));
    }
    assert_less(100, pairs);
}

/* -- spread -------------------------------------------------------------------------------------------------------- */

enum { DESIGNS = 400 };

/* Two answers each about means from 1 to 5; what noise_fit makes of them. */
static NoiseModel fit_of(double deviation, double share)
{
    double mean[DESIGNS], S[DESIGNS];
    size_t rows[DESIGNS], answers[DESIGNS];
    Random r = random_stream(3, RANDOM_TEST, 1, 0);
    for (size_t i = 0; i < DESIGNS; i++) {
        const double f = 1.0 + 4.0 * random_uniform(&r), c = deviation + share * f;
        const double a = f + c * random_normal(&r), b = f + c * random_normal(&r);
        rows[i] = i;
        answers[i] = 2;
        mean[i] = 0.5 * (a + b);
        S[i] = 0.5 * (a - b) * (a - b);
    }
    return noise_fit(DESIGNS, rows, answers, 1, 0, mean, S);
}

/* The estimate of a deviation from 400 repeats has a standard error of 1 / root(800) of it. */
TEST(a_constant_deviation_and_a_share_of_the_value_are_told_apart)
{
    const NoiseModel constant = fit_of(0.1, 0.0), share = fit_of(0.0, 0.03), none = fit_of(0.0, 0.0);
    assert_false(constant.is_relative);
    assert_close(constant.sd, 0.1, 0.12);
    assert_true(share.is_relative);
    assert_close(share.sd, 0.03, 0.12);
    assert_same_number(none.sd, 0.0);
    assert_same_number(noise_fit(0, NULL, NULL, 1, 0, NULL, NULL).sd, 0.0);
    assert_close(noise_variance(&share, 2.0, 0.0, 1), pow(2.0 * share.sd, 2), 1e-12);
    assert_close(noise_variance(&(NoiseModel){0.2, 0}, 7.0, 0.06, 2), (0.04 + 0.06) / 2, 1e-12);
}

/* -- archive ------------------------------------------------------------------------------------------------------- */

/* 60 designs on a line; every third is answered again, some several times. */
static void insert_noisy(Archive *a, uint32_t seed, int settle_often)
{
    Random r = random_stream(seed, RANDOM_TEST, 2, 0);
    CHECK_OK(pareto_archive_init(a, 4, 1, M, 1, &err), &err);
    for (size_t i = 0; i < 120; i++) {
        const double x = i < 60 ? (double)i : (double)(3 * random_below(&r, 20)), g = x < 50.0 ? -1.0 : 1.0;
        double f[M];
        for (size_t k = 0; k < M; k++)
            f[k] = fmod(x * (double)(7 + 4 * k), 10.0) + 1.0 + 0.5 * random_normal(&r);
        CHECK_OK(pareto_archive_insert(a, &x, f, &g, 1, KIND_SAMPLED, i, &err), &err);
        if (settle_often)
            pareto_archive_update_noise(a);
    }
    pareto_archive_update_noise(a);
}

TEST(a_design_has_the_mean_and_the_deviation_of_its_answers)
{
    OWNED(pareto_archive_free) Archive a;
    insert_noisy(&a, 5, 0);
    assert_int_equal(a.n_replicates, 60);
    assert_int_equal(a.n_usable, 60);
    for (size_t row = 0; row < 60; row++)
        for (size_t k = 0; k < M; k++) {
            double n = 0.0, mean = 0.0, S = 0.0;
            for (size_t i = 0; i < a.n; i++)
                if (a.X[i] == a.X[row]) {
                    n += 1.0;
                    mean += a.Y[i * M + k];
                }
            mean /= n;
            for (size_t i = 0; i < a.n; i++)
                if (a.X[i] == a.X[row])
                    S += pow(a.Y[i * M + k] - mean, 2.0);
            assert_int_equal(a.replicates[row], (size_t)n);
            assert_close(a.F[row * M + k], mean, 1e-12);
            assert_less(fabs(a.S[row * M + k] - S), 1e-10);
            const double variance = noise_variance(&a.noise[k], a.F[row * M + k], a.S[row * M + k], a.replicates[row]);
            assert_close(a.error[row * M + k], sqrt(variance / n), 1e-12);
        }
    assert_close(a.noise[0].is_relative ? 5.5 * a.noise[0].sd : a.noise[0].sd, 0.5, 0.5);
}

TEST(the_front_is_what_nobody_dominates_surely_in_whatever_order_answers_come)
{
    for (uint32_t seed = 0; seed < 20; seed++) {
        OWNED(pareto_archive_free) Archive a, b;
        size_t n_front = 0;
        insert_noisy(&a, seed, 0);
        insert_noisy(&b, seed, 1);
        for (size_t i = 0; i < a.n; i++) {
            int wanted = a.usable[i] && a.X[i] < 50.0;
            for (size_t j = 0; j < a.n && wanted; j++)
                wanted = !(a.usable[j] && a.X[j] < 50.0 &&
                           dominates_surely(M, a.F + j * M, a.error + j * M, a.F + i * M, a.error + i * M));
            assert_int_equal(a.on_front[i], wanted);
            n_front += (size_t)wanted;
        }
        assert_int_equal(a.n_front, n_front);
        assert_int_equal(b.n_front, n_front);
        assert_memory_equal(a.front, b.front, n_front * sizeof *a.front);
        assert_memory_equal(a.error, b.error, 60 * M * sizeof *a.error);
    }
}

TEST(a_design_that_was_lucky_once_falls_out)
{
    OWNED(pareto_archive_free) Archive a;
    const double X[] = {0, 1, 0, 1, 0}, F[] = {1.0, 2.0, 1.05, 0.5, 5.0, 6.0, 1.0, 0.52, 5.1, 6.0};
    CHECK_OK(pareto_archive_init(&a, 2, 1, 2, 0, &err), &err);
    for (size_t i = 0; i < 5; i++) {
        CHECK_OK(pareto_archive_insert(&a, X + i, F + 2 * i, NULL, 1, KIND_SAMPLED, 0, &err), &err);
        assert_true(i != 1 || a.n_front == 2);
    }
    pareto_archive_update_noise(&a);
    assert_true(a.n_front == 1 && a.front[0] == 1 && !a.on_front[0]);
}

TEST(a_design_with_an_answer_that_failed_is_no_longer_used)
{
    OWNED(pareto_archive_free) Archive a;
    const double X[] = {0, 1}, F[] = {1, 1, 2, 2};
    CHECK_OK(pareto_archive_init(&a, 2, 1, 2, 0, &err), &err);
    for (size_t i = 0; i < 3; i++)
        CHECK_OK(pareto_archive_insert(&a, X + i % 2, F + 2 * (i % 2), NULL, i < 2, KIND_SAMPLED, 0, &err), &err);
    pareto_archive_update_noise(&a);
    assert_true(!a.usable[0] && a.n_usable == 1 && a.n_failed == 1);
    assert_true(a.n_front == 1 && a.front[0] == 1);
}

/* -- search -------------------------------------------------------------------------------------------------------- */

enum { VAR = 5, OBJ = 2 };

/* Convex front f1 + root... of two distances: minima of (x - 0)^2 and (x - 1)^2 along the diagonal. Additive noise. */
typedef struct {
    Problem problem;
    Function function;
    double lower[VAR], upper[VAR], noise;
    size_t n_asked, n_repeated;
} World;

static void exact(const double x[], double f[])
{
    f[0] = f[1] = 0.0;
    for (size_t d = 0; d < VAR; d++) {
        f[0] += x[d] * x[d] / VAR;
        f[1] += (x[d] - 1.0) * (x[d] - 1.0) / VAR;
    }
}

/* The draw is named by the design and how often it was asked for, so that a search that goes on gets the same. */
static void evaluate(FunctionCall *q, void *user)
{
    World *w = user;
    uint64_t bits;
    memcpy(&bits, q->x, sizeof bits);
    Random r = random_stream((uint32_t)(bits ^ bits >> 32), RANDOM_TEST, 3, (uint32_t)q->draw);
    exact(q->x, q->f);
    for (size_t k = 0; k < OBJ; k++)
        q->f[k] += w->noise * random_normal(&r);
    w->n_repeated += q->draw > 0;
    w->n_asked++;
}

static World world(double noise, int is_noisy)
{
    World w = {.noise = noise};
    for (size_t d = 0; d < VAR; d++)
        w.upper[d] = 1.0;
    w.problem.is_noisy = is_noisy;
    return w;
}

static SearchConfig config(uint32_t seed, double repeats)
{
    SearchConfig c = search_config(seed, 16, 24);
    c.initial = 20;
    c.max_evals = 200;
    c.surrogate = SURROGATE_OFF;
    c.replicate_share = repeats;
    c.replicates_max = 4;
    return c;
}

static void run(World *w, const SearchConfig *c, const SearchStart *start, Seen *seen)
{
    const int is_noisy = w->problem.is_noisy;
    w->problem = function_problem(&w->function, VAR, OBJ, 0, w->lower, w->upper, evaluate, w);
    w->problem.is_noisy = is_noisy;
    run_noting(&w->problem, c, start, seen);
    assert_int_equal(seen->reason, STOP_EVALUATIONS);
}

static Seen seen, again;

TEST(repeats_are_simulations_of_the_budget_and_no_more_than_their_share)
{
    World w = world(0.05, 1);
    const SearchConfig c = config(1, 0.4);
    size_t repeats = 0, most = 0;
    run(&w, &c, NULL, &seen);
    assert_int_equal(seen.n, 200);
    assert_int_equal(w.n_asked, 200);
    for (size_t i = 0; i < seen.n; i++) {
        repeats += seen.kind[i] == KIND_REPEAT;
        most = seen.replicates[i] > most ? seen.replicates[i] : most;
        assert_int_equal(seen.replicates[i] == 0, seen.kind[i] == KIND_REPEAT);
    }
    assert_true(repeats == seen.n_repeats && repeats == w.n_repeated);
    assert_at_most((double)repeats, 0.4 * (200 - 18 * VAR));
    assert_less(0.8 * 0.4 * (200 - 18 * VAR), repeats); /* those that the last batch brings with it are not made */
    assert_true(most > 1 && most <= 4);
}

TEST(what_answers_the_same_each_time_is_soon_left_alone)
{
    World w = world(0.0, 1), plain = world(0.0, 0);
    const SearchConfig c = config(1, 0.4);
    run(&w, &c, NULL, &seen);
    assert_int_equal(seen.n, 200);
    assert_in_range(seen.n_repeats, 8, 8 + 0.4 * (AHEAD + 12)); /* those under way when it is noticed */
    run(&plain, &c, NULL, &seen);
    assert_int_equal(plain.n_repeated, 0);
    for (size_t i = 0; i < seen.n * OBJ; i++)
        assert_same_number(seen.F[i], seen.Y[i]);
}

/* Mean of reported less true objectives over the front, in standard deviations of an answer. */
static double optimism(const Seen *s, double noise)
{
    double sum = 0.0, n = 0.0, f[OBJ];
    for (size_t i = 0; i < s->n; i++) {
        if (!s->on_front[i])
            continue;
        exact(s->X + i * VAR, f);
        for (size_t k = 0; k < OBJ; k++) {
            sum += (f[k] - s->F[i * OBJ + k]) / noise;
            n += 1.0;
        }
    }
    return sum / n;
}

TEST(repeats_take_most_of_the_optimism_out_of_the_front)
{
    double believed = 0.0, tried = 0.0;
    for (uint32_t seed = 1; seed <= 4; seed++) {
        World w = world(0.1, 1);
        const SearchConfig once = config(seed, 0.0), more = config(seed, 0.4);
        run(&w, &once, NULL, &seen);
        believed += optimism(&seen, w.noise) / 4;
        run(&w, &more, NULL, &seen);
        tried += optimism(&seen, w.noise) / 4;
    }
    if (!(believed > 0.5 && fabs(tried) < 0.5 * believed))
        fail_msg("optimism: %g standard deviations without repeats, %g with", believed, tried);
}

TEST(a_noisy_search_goes_on_from_any_generation_to_the_same_bytes)
{
    World w = world(0.3, 1);
    SearchConfig c = config(3, 0.6);
    c.surrogate = SURROGATE_ON;
    c.max_evals = 120;
    run(&w, &c, NULL, &seen);
    for (size_t k = 0; k + 1 < seen.moments.n; k += 2 + k / 2) {
        OWNED(evaluation_table_free)
        EvaluationTable before = evaluations_of(&w.problem, 1, seen.moments.rows[k], seen.X, seen.Y, NULL, seen.ok,
                                                seen.kind, seen.generation);
        const SearchStart start = {before.n, 0, before.row, seen.moments.state[k], seen.moments.n_state[k], NULL, NULL};
        run(&w, &c, &start, &again);
        assert_int_equal(again.n, seen.n);
        assert_memory_equal(again.X, seen.X, seen.n * VAR * sizeof *seen.X);
        assert_memory_equal(again.F, seen.F, seen.n * OBJ * sizeof *seen.F);
        assert_memory_equal(again.on_front, seen.on_front, seen.n);
        assert_memory_equal(again.kind, seen.kind, seen.n);
    }
}

SUITE(NULL, NULL)
