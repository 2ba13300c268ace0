/* The estimated error of a result: twice the steps, and above the error in most windows. */
#include "bench/promise.h"
#include "scene_options.h"
#include "analysis/estimate.h"

TEST(a_second_run_has_twice_the_steps_of_the_first)
{
    SceneOptions o = paper_scene();
    SimOptions finer;
    assert_true(estimate_options(&o.sim, &finer));
    assert_same_number(finer.steps_per_contact, 4); /* standard has two */
    o.sim.steps_per_contact = 7;
    assert_true(estimate_options(&o.sim, &finer) && finer.steps_per_contact == 14);
    o.sim.engine = ENGINE_CVODE;
    assert_false(estimate_options(&o.sim, &finer));
}

TEST(a_tolerance_chooses_the_steps)
{
    SimOptions o = paper_scene().sim, finer;
    assert_same_number(sim_steps_per_contact(&o), 0);
    o.tolerance = 0.01;
    assert_close(sim_steps_per_contact(&o), 2, 1e-12);
    o.tolerance = 0.00125;
    assert_close(sim_steps_per_contact(&o), 8, 1e-12);
    assert_true(estimate_options(&o, &finer));
    assert_close(sim_steps_per_contact(&finer), 16, 1e-12);
}

static void errors_of(const SimResult *result, const SimResult *finer, double error[])
{
    const Measured as_set = measured(result), again = measured(finer);
    estimate_errors(&as_set, &again, error);
}

TEST(equal_results_have_no_error_and_failed_ones_an_unknown_one)
{
    static SimResult a, b;
    double error[N_MEASURES];
    a.j1_m = b.j1_m = 0.7;
    a.j3_g = 2;
    b.j3_g = 2.001;
    errors_of(&a, &b, error);
    assert_same_number(error[MEASURE_J1], 0);
    assert_close(error[MEASURE_J3], 0.001, 1e-9);
    b.outcome = RUN_OUT_OF_STEPS;
    errors_of(&a, &b, error);
    for (int k = 0; k < N_MEASURES; k++)
        assert_true(isnan(error[k]));
}

static void open_tower(Problem *p, long replicates, double gap_tolerance_m)
{
    Settings s = paper_settings();
    snprintf(s.motion.record, OPTION_TEXT_MAX, "builtin:sylmar-like");
    s.sim.duration_s = 12;
    s.sim.replicates = replicates;
    s.sim.gap_tolerance_m = gap_tolerance_m;
    CHECK_OK(tower_open(p, &s, TOWER_AS_SET, SIZE_MAX, &(Err){0}), &(Err){0});
}

/* The other way: replicates, whose gaps scatter normally. */
TEST(the_spread_of_gaps_that_are_one_micrometre_off_is_that_of_replicates_as_built)
{
    OWNED(problem_close) Problem single, scattered;
    double x[22], error[N_MEASURES], sd[N_MEASURES];
    SimResult result, shown;
    ReplicateSummary r;
    paper_design(x, 0.004, 0.002);
    open_tower(&single, 1, 0);
    open_tower(&scattered, 24, ESTIMATE_GAP_M);
    const SimTask task = {.x = x};
    CHECK_OK(tower_simulate(&single, 1, &task, &result, &err), &err);
    CHECK_OK(estimate_designs(&single, 1, &task, &result, error, sd, &err), &err);
    CHECK_OK(tower_replicate(&scattered, 1, x, &shown, &r, &err), &err);
    for (int k = MEASURE_J1; k <= MEASURE_J3; k++) {
        assert_less(0, sd[k]);
        assert_less(sd[k], 4 * r.sd[k]);
        assert_less(r.sd[k], 4 * sd[k]);
    }
}

TEST(gaps_that_never_close_have_no_spread_and_a_building_without_gaps_an_unknown_one)
{
    OWNED(problem_close) Problem p;
    double x[22], error[2 * N_MEASURES], sd[2 * N_MEASURES];
    SimResult result[2];
    paper_design(x, 5, 0);
    open_tower(&p, 1, 0);
    const SimTask tasks[] = {{.x = x}, {.kind = SCENE_NO_CORE}};
    CHECK_OK(tower_simulate(&p, 2, tasks, result, &err), &err);
    CHECK_OK(estimate_designs(&p, 2, tasks, result, error, sd, &err), &err);
    assert_same_number(sd[MEASURE_J1], 0);
    assert_true(isnan(sd[N_MEASURES + MEASURE_J1]));
}

static SimResult run_window(const SceneOptions *o, const PromiseCase *c)
{
    SceneOptions s = *o;
    s.sim.duration_s = c->duration;
    s.core.theory = c->theory;
    return run_once(&s, &c->motion, SCENE_IMPACT, c->x);
}

TEST(the_error_is_below_its_estimate_in_nine_of_ten_results)
{
    static const int RESULTS[] = {MEASURE_J1, MEASURE_J2, MEASURE_J3, MEASURE_ED1, MEASURE_ED5_10, MEASURE_EDCS};
    SceneOptions o = paper_scene(), twice = o, fine = o;
    int below = 0, all = 0;
    OWNED(motion_free) Motion m = motion_of("builtin:kobe-like", 0.3, 3.1);
    assert_true(estimate_options(&o.sim, &twice.sim));
    fine.sim.accuracy = ACCURACY_FINE;
    const PromisePlan plan = {.options = &o, .records = &m, .n_records = 1, .n_scenes = 16};
    for (long k = 0; k < plan.n_scenes; k++) {
        PromiseCase c;
        double error[N_MEASURES];
        CHECK_OK(promise_case(&plan, 20, k % 2 ? GAPS_WIDE : GAPS_LOG_UNIFORM, k, &c, &err), &err);
        c.duration = fmin(c.duration, 3.5);
        const SimResult r = run_window(&o, &c), t = run_window(&twice, &c), f = run_window(&fine, &c);
        errors_of(&r, &t, error);
        for (size_t i = 0; i < sizeof RESULTS / sizeof RESULTS[0]; i++, all++)
            below += fabs(measure_value(&r, RESULTS[i]) - measure_value(&f, RESULTS[i])) <=
                     ESTIMATE_FACTOR * error[RESULTS[i]];
        motion_free(&c.motion);
    }
    print_message("%d of %d errors are below their estimate\n", below, all);
    assert_at_most(9 * all, 10 * below);
}

SUITE(NULL, NULL)
