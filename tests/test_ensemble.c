/* Ensembles and the predictability horizon. */
#include "check.h"

#include <stdio.h>
#include <string.h>

#include "simulator/ensemble.h"
#include "simulator/horizon.h"
#include "scene_options.h"

static void open_world(World *w, double x[22], double gap_m)
{
    Settings s;
    Err err = {0};
    paper_defaults(&s);
    snprintf(s.motion.record, OPTION_TEXT_MAX, "builtin:sylmar-like");
    s.sim.duration_s = 16;
    CHECK_OK(world_open(w, &s, &err), &err);
    for (int j = 0; j < 20; j++)
        x[j] = gap_m * (j + 1);
    x[20] = 0.012;
    x[21] = 0.0064;
}

static Ensemble run_ensemble(const World *w, const double x[], int members, double change, long threads)
{
    Crew *crew;
    Ensemble e;
    SimResult first;
    Err err = {0};
    CHECK_OK(crew_create(&crew, w->scene, threads, &err), &err);
    CHECK_OK(ensemble_run(crew, 20, x, members, change, 1, &e, &first, &err), &err);
    crew_free(crew);
    return e;
}

static void test_without_contact_there_is_no_spread(void **state)
{
    (void)state;
    World w;
    double x[22];
    open_world(&w, x, 5);
    const Ensemble e = run_ensemble(&w, x, 4, 1e-8, 1);
    assert_int_equal(e.finished, 4);
    for (int k = 0; k < N_MEASURES; k++)
        assert_true(e.spread[k] <= 1e-12 * fabs(e.mean[k]));
    world_close(&w);
}

static void test_the_numbers_do_not_depend_on_the_number_of_threads(void **state)
{
    (void)state;
    World w;
    double x[22];
    open_world(&w, x, 0.004);
    const Ensemble one = run_ensemble(&w, x, 6, 1e-8, 1), three = run_ensemble(&w, x, 6, 1e-8, 3);
    assert_memory_equal(&one, &three, sizeof one);
    world_close(&w);
}

static void test_members_that_differ_more_spread_more(void **state)
{
    (void)state;
    World w;
    double x[22];
    open_world(&w, x, 0.02);
    const Ensemble little = run_ensemble(&w, x, 6, 1e-6, 2), much = run_ensemble(&w, x, 6, 1e-2, 2);
    assert_true(much.mean[9] > 3);
    assert_true(much.spread[0] > 10 * little.spread[0]);
    assert_true(little.spread[0] < 1e-3 * little.mean[0]);
    world_close(&w);
}

static void test_the_horizon_is_never_reached_without_contact(void **state)
{
    (void)state;
    World w;
    Horizon h;
    Err err = {0};
    double x[22];
    open_world(&w, x, 5);
    CHECK_OK(horizon_find(&w, x, 1e-3, &h, &err), &err);
    for (int i = 0; i < HORIZON_LEVELS; i++)
        assert_true(isnan(h.reached_s[i]));
    assert_true(h.distance_at_end == 0);
    assert_true(h.end_s > 15.9);
    world_close(&w);
}

static void test_larger_changes_part_sooner_and_levels_are_reached_in_order(void **state)
{
    (void)state;
    World w;
    Horizon early, late;
    Err err = {0};
    double x[22];
    open_world(&w, x, 0.008);
    CHECK_OK(horizon_find(&w, x, 1e-3, &early, &err), &err);
    CHECK_OK(horizon_find(&w, x, 1e-9, &late, &err), &err);
    assert_true(early.reached_s[0] > 0);
    for (int i = 0; i < HORIZON_LEVELS; i++) {
        assert_true(!(late.reached_s[i] < early.reached_s[i]));
        assert_true(i == 0 || !(early.reached_s[i] < early.reached_s[i - 1]));
    }
    world_close(&w);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_without_contact_there_is_no_spread),
        cmocka_unit_test(test_the_numbers_do_not_depend_on_the_number_of_threads),
        cmocka_unit_test(test_members_that_differ_more_spread_more),
        cmocka_unit_test(test_the_horizon_is_never_reached_without_contact),
        cmocka_unit_test(test_larger_changes_part_sooner_and_levels_are_reached_in_order),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
