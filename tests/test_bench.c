/* The bench measures what it says: its scenes, its errors, its tables. */
#include "bench/sweep.h"
#include "bench/promise.h"
#include "bench/search/families.h"
#include "bench/search/factors.h"
#include "bench/search/loop.h"
#include "bench/search/reference.h"
#include "program.h"
#include "scene_options.h"

typedef struct {
    SceneOptions s;
    Motion m;
} Ground;

static Ground ground(void)
{
    const Settings s = paper_settings();
    return (Ground){settings_scene(&s), motion_of("builtin:kobe-like", s.motion.pga_g, s.motion.stretch)};
}

static void ground_close(Ground *g)
{
    motion_free(&g->m);
}

TEST(irregular_gaps_are_the_same_every_time_and_within_their_bounds)
{
    double first[20], again[20], other[20];
    bench_irregular_gaps(3, 20, first);
    bench_irregular_gaps(3, 20, again);
    bench_irregular_gaps(4, 20, other);
    assert_memory_equal(first, again, sizeof first);
    assert_memory_not_equal(first, other, sizeof first);
    for (int j = 0; j < 20; j++)
        assert_true(first[j] >= 0.01 && first[j] <= 0.2);
}

TEST(scenes_have_as_many_impacts_as_their_names_say)
{
    static const long LEAST[] = {0, 1, 20, 10, 20}, MOST[] = {0, 1, 100000, 100000, 100000};
    OWNED(ground_close) Ground g = ground();
    for (int k = 0; k < N_BENCH_KINDS; k++) {
        OWNED(bench_case_close) BenchCase bench_case = {0};
        static TimedRun o;
        CHECK_OK(bench_case_open(&bench_case, bench_kind(k), &g.s, &g.m, 1, &err), &err);
        CHECK_OK(timed_run(&bench_case, ENGINE_FAST, ACCURACY_STANDARD, 0, &o, &err), &err);
        print_message("%s: %ld impacts\n", bench_case.kind->name, o.result.impacts);
        assert_int_equal(o.result.outcome, RUN_OK);
        assert_true(o.result.impacts >= LEAST[k] && o.result.impacts <= MOST[k]);
    }
}

TEST(an_error_is_zero_against_itself_and_first_order_in_a_change)
{
    static TimedRun o, changed;
    OWNED(bench_case_close) BenchCase bench_case = {0};
    OWNED(ground_close) Ground g = ground();
    CHECK_OK(bench_case_open(&bench_case, bench_kind(2), &g.s, &g.m, 1, &err), &err);
    CHECK_OK(timed_run(&bench_case, ENGINE_ETDRK4, ACCURACY_STANDARD, 1e-3, &o, &err), &err);
    changed = o;
    changed.result.j3_g *= 1.001;
    changed.onsets[0].t += 1e-3;
    for (int i = 0; i < 2 * bench_case.model.m; i++)
        changed.state[i] *= 1.01;
    const RunErrors none = run_errors(&bench_case, &o, &o), some = run_errors(&bench_case, &changed, &o);
    assert_true(none.objectives == 0 && none.state == 0 && none.first_s == 0 && none.first_speed == 0);
    assert_close(some.objectives, 1e-3, 1e-9);
    assert_close(some.state, 1e-2, 1e-9);
    assert_close(some.first_s, 1e-3, 1e-9);
}

TEST(a_sweep_has_a_row_for_every_setting_and_a_known_floor)
{
    const SweepPlan plan = {1u << ENGINE_FAST | 1u << ENGINE_NEWMARK, 0.05};
    OWNED(sweep_free) Sweep sweep = {0};
    OWNED(bench_case_close) BenchCase bench_case = {0};
    FREED char *csv = NULL;
    size_t size;
    OWNED(ground_close) Ground g = ground();
    six_floors(&g.s.building, &g.s.core);
    CHECK_OK(bench_case_open(&bench_case, bench_kind(0), &g.s, &g.m, 1, &err), &err);
    bench_case.duration = 1;
    FILE *quiet = opened("/dev/null", "w");
    CHECK_OK(sweep_run(&sweep, 0, &bench_case, &plan, quiet, &err), &err);
    fclose(quiet);
    assert_at_most(6, sweep.n);
    assert_less(sweep_floor(&sweep, 0), 1e-5);
    FILE *f = open_memstream(&csv, &size);
    sweep_write(&sweep, f);
    fclose(f);
    size_t lines = 0;
    for (const char *c = csv; *c; c++)
        lines += *c == '\n';
    assert_int_equal(lines, sweep.n + 1);
    assert_int_equal(strncmp(csv, "case,engine,tolerance,seconds,error_objectives", 45), 0);
}

TEST(scenes_of_the_promise_have_their_kind_of_gaps_and_repeat)
{
    static const double LEAST[N_GAPS] = {1e-3, 0.05, 1e-3, 1e-3, 1e-3, 4.75e-3, 1e-3, 1e-3, 1e-3, 1e-3},
                        MOST[N_GAPS] = {0.5, 0.5, 5, 0.01, 0.5, 0.21, 0.5, 0.5, 0.5, 0.5};
    PromiseCase c, again;
    OWNED(ground_close) Ground g = ground();
    const PromisePlan plan = {.options = &g.s, .records = &g.m, .n_records = 1, .n_scenes = 10};
    for (long k = 0; k < plan.n_scenes * N_GAPS; k++) {
        const GapKind kind = (GapKind)(k % N_GAPS);
        int open = 0;
        CHECK_OK(promise_case(&plan, 20, kind, k, &c, &err), &err);
        CHECK_OK(promise_case(&plan, 20, kind, k, &again, &err), &err);
        assert_memory_equal(c.x, again.x, 22 * sizeof *c.x);
        assert_memory_equal(c.motion.accel, again.motion.accel, c.motion.n * sizeof *c.motion.accel);
        assert_less(motion_peak(&c.motion), 0.5001 * 9.81);
        assert_at_most(c.duration, (double)(c.motion.n - 1) * c.motion.dt_s);
        assert_true(c.duration >= 4 && c.duration <= 40);
        for (int j = 0; j < 20; j++) {
            assert_at_most(LEAST[kind], c.x[j]);
            assert_at_most(c.x[j], MOST[kind]);
            open += c.x[j] == 5;
            assert_true(kind != GAPS_GROWING || j == 0 || c.x[j] > c.x[j - 1]);
        }
        assert_true(kind == GAPS_THREE_FLOORS ? open >= 17 : open == 0);
        assert_true(c.x[20] >= 4e-3 && c.x[20] <= 0.04 && c.x[21] >= 4e-3 && c.x[21] <= c.x[20]);
        motion_free(&c.motion);
        motion_free(&again.motion);
    }
}

TEST(quantiles_are_the_least_that_a_share_does_not_exceed)
{
    double x[] = {4, 1, 3, 2, 5, 6, 8, 7, 10, 9};
    assert_true(bench_quantile(10, x, 0.9) == 9 && bench_quantile(10, x, 0.95) == 10 && bench_quantile(10, x, 0) == 1);
    assert_true(bench_median(10, x) == 5.5 && bench_median(9, x) == 5 && isnan(bench_median(0, x)));
}

/* Of six soft floors, whose swings close gaps of every kind. */
TEST(the_table_of_the_promise_has_a_row_for_every_accuracy)
{
    FREED char *page = NULL;
    size_t size;
    OWNED(ground_close) Ground g = ground();
    write_in_place("soft/storeys.csv", "height_m,mass_t,stiffness_kn_m\n4,300,2e4\n4,300,2e4\n4,300,2e4\n"
                                       "4,300,2e4\n4,300,2e4\n4,300,2e4\n");
    snprintf(g.s.building.model, sizeof g.s.building.model, "%s", there("soft"));
    g.m.n = (size_t)(20 / g.m.dt_s);
    FILE *f = open_memstream(&page, &size), *quiet = fopen("/dev/null", "w");
    assert_true(f && quiet);
    const PromisePlan plan = {.options = &g.s, .records = &g.m, .n_records = 1, .n_scenes = 1};
    CHECK_OK(promise_write(&plan, f, quiet, &err), &err);
    fclose(f);
    fclose(quiet);
    print_message("%s", page);
    assert_words(page, "\nlog-uniform,\"coarse\",j1,1,1,", "\nwide,\"standard\",j3,1,1,",
                 "\nthree floors,\"true / estimated error\",edcs_pct,1,1,", "\ncvode,\"fine\",share_points,1,1,");
}

/* -- problems of other families -- */

/* No design that a plain search finds dominates a reference by more than a thousandth of the front's range. */
static void check_nothing_is_beyond(const Course *reference, const Course *found)
{
    const size_t m = found->n_obj;
    double margin[FAMILY_OBJ_MAX];
    for (size_t k = 0; k < m; k++) {
        double low = INFINITY, high = -INFINITY;
        for (size_t j = 0; j < reference->n; j++) {
            low = fmin(low, reference->F[j * m + k]);
            high = fmax(high, reference->F[j * m + k]);
        }
        margin[k] = 1e-3 * (high - low);
    }
    for (size_t i = 0; i < found->n; i++)
        for (size_t r = 0; found->counts[i] && r < reference->n; r++) {
            int beyond = 1;
            for (size_t k = 0; k < m && beyond; k++)
                beyond = found->F[i * m + k] < reference->F[r * m + k] - margin[k];
            if (beyond)
                fail_msg("design %zu dominates reference %zu of %zu", i, r, reference->n);
        }
}

/* Of the families with these names, on whose fronts a point of zero distance is not. */
static void search_plainly(const char *names)
{
    Settings s = default_settings();
    for (size_t i = 0; i < family_count(); i++) {
        if (!strstr(names, family(i)->name))
            continue;
        OWNED(problem_close) Problem p;
        OWNED(course_free) Course reference, found;
        CHECK_OK(family_open(&p, i, &err), &err);
        CHECK_OK(reference_make(&p, &reference, &err), &err);
        CHECK_OK(course_create(&found, 1000, p.n_obj, &err), &err);
        CHECK_OK(search_course(&s, &p, SURROGATE_OFF, &found, &err), &err);
        print_message("%s: %zu references\n", family(i)->name, reference.n);
        assert_at_most(20, reference.n);
        check_nothing_is_beyond(&reference, &found);
    }
}

TEST(no_plain_search_gets_beyond_the_references_of_a_front_in_pieces_or_under_limits)
{
    search_plainly("pieces4 limits4");
}

TEST(no_plain_search_gets_beyond_the_references_where_designs_fail)
{
    search_plainly("slab3 ball4");
}

static double sum_of(const Course *c, size_t i)
{
    double sum = 0.0;
    for (size_t k = 0; k < c->n_obj; k++)
        sum += c->F[i * c->n_obj + k];
    return sum;
}

/* Of slab3: the least sum of objectives among the designs that succeed, after 200 evaluations and after the first 52. */
TEST(a_search_makes_as_many_evaluations_as_it_may_and_betters_its_first_sample)
{
    Settings s = default_settings();
    s.search.population = 40;
    size_t which = 0;
    while (strcmp(family(which)->name, "slab3") != 0)
        which++;
    for (int i = 0; i < 2; i++) {
        double first = INFINITY, last = INFINITY;
        OWNED(problem_close) Problem p;
        OWNED(course_free) Course c;
        CHECK_OK(family_open(&p, which, &err), &err);
        CHECK_OK(course_create(&c, 200, p.n_obj, &err), &err);
        CHECK_OK(search_course(&s, &p, i ? SURROGATE_OFF : SURROGATE_ON, &c, &err), &err);
        assert_int_equal(c.n, 200);
        for (size_t j = 0; j < c.n; j++) {
            first = j < 52 && c.counts[j] ? fmin(first, sum_of(&c, j)) : first;
            last = c.counts[j] ? fmin(last, sum_of(&c, j)) : last;
            assert_true(j == 0 || c.cpu_s[j] >= c.cpu_s[j - 1]);
        }
        assert_less(last, first);
    }
}

/* Of dtlz2: simulations of the first sample, after the last iteration, with the last population, of the search. */
static void loop_simulations(double error_max, size_t found[4], double volume[2])
{
    Settings s = default_settings();
    FREED char *text;
    size_t size, n = 0;
    s.problem.kind = PROBLEM_EXTERNAL;
    snprintf(s.problem.command, sizeof s.problem.command, TEXTBOOK_WORKER " dtlz2 22 7");
    s.search.population = 20;
    const LoopPlan plan = {.settings = &s, .n_seeds = 1, .iterations = 3, .error_max = error_max};
    FILE *out = open_memstream(&text, &size);
    CHECK_OK(loop_run(&plan, out, &err), &err);
    fclose(out);
    for (char *line = strtok(text, "\n"); line; line = strtok(NULL, "\n"), n++) {
        char which[8] = "";
        size_t iteration = 0, simulations = 0;
        double share = 0.0;
        sscanf(line, "1,%7[a-z],%zu,%zu,%lf", which, &iteration, &simulations, &share);
        if (strcmp(which, "loop") == 0 && (simulations == 100 || iteration >= 3))
            found[iteration == 4 ? 2 : iteration == 3] = simulations;
        if (iteration == 0 && simulations == 100)
            volume[which[0] == 's'] = share;
        found[3] = simulations;
    }
    assert_true(n > 6);
}

TEST(the_loop_simulates_what_fails_the_error_test_and_the_search_as_many_from_the_same_sample)
{
    size_t strict[4] = {0}, never[4] = {0};
    double volume[2] = {0.0, -1.0};
    loop_simulations(0.0, strict, volume);
    assert_memory_equal(strict, ((size_t[]){100, 160, 160, 160}), sizeof strict);
    assert_true(volume[0] > 0.0 && volume[0] == volume[1]);
    loop_simulations(1e9, never, volume);
    assert_int_equal(never[1], 100);
    assert_true(never[2] > 100 && never[2] <= 120 && never[3] == never[2]);
}

SUITE(make_place, clear_place)
