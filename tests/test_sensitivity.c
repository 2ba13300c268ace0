/* Slopes of results: closed forms where there are some. */
#include "scene_options.h"
#include "towers.h"
#include "settings/options.h"
#include "analysis/sensitivity.h"

enum { FLOORS = 6, N_VAR = FLOORS + 2 };

static Settings short_scene(double x[N_VAR], double gap)
{
    Settings s = paper_settings();
    six_floors(&s.building, &s.core);
    s.motion.stretch = 1;
    s.sim.duration_s = 8;
    s.sim.accuracy = ACCURACY_COARSE;
    for (int j = 0; j < N_VAR; j++)
        x[j] = j < FLOORS ? gap + 0.001 * j : j == FLOORS ? 0.03 : 0.01;
    return s;
}

static const Sensitivity *named(const Sensitivity *list, size_t n, const char *name)
{
    for (size_t i = 0; i < n; i++)
        if (strcmp(list[i].name, name) == 0)
            return &list[i];
    fail_msg("%s is missing", name);
    return NULL;
}

/* Of a square tube the mass is quadratic in the thickness, so that the central difference is exact. */
TEST(the_mass_changes_with_the_thickness_as_the_section_says)
{
    FREED Sensitivity *list;
    size_t n;
    double x[N_VAR], base = 0, top = 0;
    Settings s = short_scene(x, 5);
    CHECK_OK(sensitivity_find(&s, x, 1, &list, &n, &err), &err);
    for (int j = 0; j < FLOORS; j++) {
        const double part = j / (FLOORS - 1.0), t = x[FLOORS] + (x[FLOORS + 1] - x[FLOORS]) * part;
        const double height = j == 0 ? 4 : 3.5;
        const double slope = s.core.density_kg_m3 * height * (4 * s.core.width_m - 8 * t);
        base += (1 - part) * slope;
        top += part * slope;
    }
    assert_close(named(list, n, "t_base_m")->slope[MEASURE_MCORE], base, 1e-9);
    assert_close(named(list, n, "t_top_m")->slope[MEASURE_MCORE], top, 1e-9);
}

TEST(without_contact_only_the_building_matters_and_its_slope_is_that_of_the_building_alone)
{
    FREED Sensitivity *list;
    size_t n;
    double x[N_VAR], j1[2];
    Settings s = short_scene(x, 5);
    CHECK_OK(sensitivity_find(&s, x, 3, &list, &n, &err), &err);
    for (int j = 0; j < FLOORS; j++)
        assert_true(list[j].slope[MEASURE_J1] == 0 && list[j].error[MEASURE_J1] == 0);
    /* Of a softer contact fewer core modes are kept: sums of other lengths round differently. */
    assert_at_most(fabs(named(list, n, "contact.radius_m")->slope[MEASURE_J2]), 1e-12);
    const Sensitivity *damping = named(list, n, "building.damping");
    for (int side = 0; side < 2; side++) {
        Settings other = s;
        other.building.damping.at[0] += (side ? 0.5 : -0.5) * damping->step;
        j1[side] = simulated_as(SCENE_NO_CORE, &other, NULL).j1_m;
    }
    assert_less(damping->slope[MEASURE_J1], 0);
    assert_close(damping->slope[MEASURE_J1], (j1[1] - j1[0]) / damping->step, 1e-6);
    assert_true(isnan(damping->slope[MEASURE_J3]) && list[0].slope[MEASURE_J3] == 0); /* of what changes J3 none */
    assert_less(damping->error[MEASURE_J1], 0.01 * fabs(damping->slope[MEASURE_J1]));
}

TEST(the_ground_is_a_parameter_where_there_is_one)
{
    Sensitivity *list;
    size_t n;
    double x[N_VAR], rotation[2];
    Settings s = short_scene(x, 5);
    CHECK_OK(sensitivity_find(&s, x, 1, &list, &n, &err), &err);
    for (size_t i = 0; i < n; i++)
        assert_string_not_equal(list[i].name, "core.foundation_factor");
    free(list);
    snprintf(s.core.foundation, sizeof s.core.foundation, "rotation=1e12");
    CHECK_OK(sensitivity_find(&s, x, 1, &list, &n, &err), &err);
    const Sensitivity *ground = named(list, n, "core.foundation_factor");
    for (int side = 0; side < 2; side++) {
        Settings other = s;
        other.sim.forces = FORCES_YES;
        snprintf(other.core.foundation, sizeof other.core.foundation, "rotation=%.17g",
                 1e12 * (1 + (side ? 0.5 : -0.5) * ground->step));
        rotation[side] = simulated_as(SCENE_IMPACT, &other, x).forces.base_rotation_rad;
    }
    assert_close(ground->slope[MEASURE_BASE_ROTATION], (rotation[1] - rotation[0]) / ground->step, 1e-6);
    free(list);
}

/* Of storeys that do not reach it, the ductility d / y alone changes, by -d / y^2. */
TEST(the_strength_of_storeys_is_a_parameter_where_they_yield)
{
    FREED Sensitivity *list;
    size_t n;
    double x[N_VAR];
    Settings s = short_scene(x, 5);
    s.building.yield_drift = 0.5;
    CHECK_OK(sensitivity_find(&s, x, 1, &list, &n, &err), &err);
    const SimResult r = simulated_as(SCENE_IMPACT, &s, x);
    const Sensitivity *strength = named(list, n, "building.yield_drift");
    assert_less(0, r.ductility);
    assert_close(strength->slope[MEASURE_DUCTILITY], -r.ductility / 0.5, 1e-3);
    assert_same_number(strength->slope[MEASURE_HYSTERESIS], 0);
    assert_less(fabs(strength->slope[MEASURE_J1]), 1e-6 * r.j1_m);
}

TEST(with_contact_the_slopes_are_differences_of_simulations_on_any_number_of_threads)
{
    FREED Sensitivity *one, *two, *three;
    size_t n, same;
    double x[N_VAR], j1[2];
    Settings s = short_scene(x, 0.002);
    s.search.threads = 1;
    CHECK_OK(sensitivity_find(&s, x, 2, &one, &n, &err), &err);
    s.search.threads = 2;
    CHECK_OK(sensitivity_find(&s, x, 2, &two, &same, &err), &err);
    assert_int_equal(n, same);
    for (size_t i = 0; i < n; i++)
        for (int k = 0; k < N_MEASURES; k++)
            assert_true(one[i].slope[k] == two[i].slope[k] || (isnan(one[i].slope[k]) && isnan(two[i].slope[k])));
    CHECK_OK(sensitivity_find(&s, x, 1, &three, &n, &err), &err);
    for (int side = 0; side < 2; side++) {
        double changed[N_VAR];
        memcpy(changed, x, sizeof x);
        changed[FLOORS - 1] += (side ? 0.5e-3 : -0.5e-3);
        j1[side] = simulated_as(SCENE_IMPACT, &s, changed).j1_m;
    }
    assert_close(three[FLOORS - 1].slope[MEASURE_J1], (j1[1] - j1[0]) / 1e-3, 1e-9);
}

SUITE(NULL, NULL)
