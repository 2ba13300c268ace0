/* The predictability horizon. */
#include "analysis/horizon.h"
#include "scene_options.h"

static void open_scenario(Scenario *w, double x[22], double gap_m)
{
    Settings s = paper_settings();
    snprintf(s.motion.record, OPTION_TEXT_MAX, "builtin:sylmar-like");
    s.sim.duration_s = 16;
    const SceneOptions options = settings_scene(&s);
    CHECK_OK(scenario_of(w, &options, &s.motion, &err), &err);
    paper_design(x, gap_m, gap_m);
}

TEST(the_horizon_is_never_reached_without_contact)
{
    OWNED(scenario_close) Scenario w;
    Horizon h;
    double x[22];
    open_scenario(&w, x, 5);
    CHECK_OK(horizon_find(&w, x, 1e-3, &h, &err), &err);
    for (int i = 0; i < HORIZON_LEVELS; i++)
        assert_true(isnan(h.reached_s[i]));
    assert_same_number(h.distance_at_end, 0);
    assert_less(15.9, h.end_s);
}

TEST(larger_changes_part_sooner_and_levels_are_reached_in_order)
{
    OWNED(scenario_close) Scenario w;
    Horizon early, late;
    double x[22];
    open_scenario(&w, x, 0.008);
    CHECK_OK(horizon_find(&w, x, 1e-3, &early, &err), &err);
    CHECK_OK(horizon_find(&w, x, 1e-9, &late, &err), &err);
    assert_less(0, early.reached_s[0]);
    for (int i = 0; i < HORIZON_LEVELS; i++) {
        assert_true(!(late.reached_s[i] < early.reached_s[i]));
        assert_true(i == 0 || !(early.reached_s[i] < early.reached_s[i - 1]));
    }
}

SUITE(NULL, NULL)
