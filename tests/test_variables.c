/* Design variables: which there are, what a design of them is, and every command that takes one. */
#include "runs.h"

#include "scene_options.h"

static DesignSpace space_of(const char *variables, long gap_zones, long bumper_zones, int n_floors)
{
    DesignOptions o = scene_defaults().design;
    DesignSpace space;
    snprintf(o.variables, sizeof o.variables, "%s", variables);
    o.gap_zones = gap_zones;
    o.bumper_zones = bumper_zones;
    CHECK_OK(design_space_make(&space, &o, CORE_BOX, n_floors, &err), &err);
    const int by_floor = gap_zones == 0 || (space.n_bumpers > 0 && bumper_zones == 0);
    assert_int_equal(design_space_floors(&o, CORE_BOX, space.n_var), by_floor ? n_floors : 0);
    return space;
}

static void expect_names(const DesignSpace *s, const char *const names[], int n)
{
    char name[TABLE_NAME_MAX];
    assert_int_equal(s->n_var, n);
    for (int j = 0; j < n; j++) {
        design_variable_name(s, j, name);
        assert_string_equal(name, names[j]);
    }
}

TEST(the_default_is_a_gap_per_floor_and_two_thicknesses)
{
    static const char *const WANT[] = {"gap_01_m", "gap_02_m", "gap_03_m", "t_base_m", "t_top_m"};
    const DesignSpace s = space_of("gaps, thickness", 0, 1, 3);
    double lower[5], upper[5];
    const DesignOptions o = scene_defaults().design;
    expect_names(&s, WANT, 5);
    design_bounds(&s, &o, lower, upper);
    assert_true(lower[2] == 0.001 && upper[2] == 0.5 && lower[3] == 0.004 && upper[4] == 0.04);
}

TEST(a_core_of_given_areas_has_no_thickness_to_search)
{
    static const char *const WANT[] = {"gap_01_m", "gap_02_m", "bumper_log10_n_m"};
    DesignOptions o = scene_defaults().design;
    DesignSpace s;
    Design d;
    double lower[3], upper[3];
    snprintf(o.variables, sizeof o.variables, "gaps, thickness, bumper");
    CHECK_OK(design_space_make(&s, &o, CORE_EFFECTIVE, 2, &err), &err);
    expect_names(&s, WANT, 3);
    assert_int_equal(design_space_floors(&o, CORE_EFFECTIVE, 3), 2);
    design_bounds(&s, &o, lower, upper);
    assert_true(upper[1] == o.gap_m.at[1] && lower[2] == log10(o.bumper_n_m.at[0]));
    design_of(&s, (double[]){0.1, 0.2, 8}, &d);
    assert_true(d.gap[0][1] == 0.2 && d.gap[1][1] == 0.2 && d.t_base == 0 && d.t_top == 0);
    assert_close(d.bumper[1], 1e8, 1e-12);
}

TEST(zones_bumpers_and_side_are_columns_after_the_papers)
{
    static const char *const ONE[] = {"gap_zone_1_m", "gap_zone_2_m",     "t_base_m",
                                      "t_top_m",      "bumper_log10_n_m", "side_m"};
    static const char *const ZONES[] = {"gap_m", "t_base_m", "t_top_m", "bumper_zone_1_log10_n_m",
                                        "bumper_zone_2_log10_n_m"};
    static const char *const FLOORS[] = {"gap_m", "t_base_m", "t_top_m", "bumper_01_log10_n_m", "bumper_02_log10_n_m"};
    const DesignSpace one = space_of("gaps, thickness, bumper, side", 2, 1, 7);
    const DesignSpace zones = space_of("thickness,bumper,gaps", 1, 2, 7);
    const DesignSpace floors = space_of("gaps, thickness, bumper", 1, 0, 2);
    expect_names(&one, ONE, 6);
    expect_names(&zones, ZONES, 5);
    expect_names(&floors, FLOORS, 5);
}

TEST(every_floor_has_the_gap_and_the_bumper_of_its_zone)
{
    for (int n = 2; n <= 40; n++)
        for (int zones = 1; zones <= n && zones < 9; zones++) {
            const DesignSpace s = space_of("gaps, thickness, bumper, side", zones, zones, n);
            double x[DESIGN_VARIABLES_MAX];
            Design d;
            int floors[9] = {0};
            for (int j = 0; j < s.n_var; j++)
                x[j] = j < zones ? 0.01 * (j + 1) : j < zones + 2 ? 0.02 / (j - zones + 1) : 7 + 0.1 * (j - zones - 2);
            design_of(&s, x, &d);
            assert_true(d.t_base == 0.02 && d.t_top == 0.01 && d.side == x[s.n_var - 1]);
            for (int j = 0; j < n; j++) {
                const int z = (int)round(d.gap[0][j] / 0.01) - 1;
                assert_true(z >= 0 && z < zones && (j == 0 || d.gap[0][j] >= d.gap[0][j - 1]));
                assert_close(d.bumper[j], pow(10, 7 + 0.1 * z), 1e-12);
                floors[z]++;
            }
            for (int z = 0; z < zones; z++) /* as even as can be */
                assert_true(floors[z] == n / zones || floors[z] == n / zones + 1);
        }
}

TEST(wrong_variables_are_refused_with_their_key)
{
    FOR_EACH (const char *, list, "gaps", "thickness, bumper", "gaps, thickness, bumpr", "gaps,,thickness",
              "gaps, thickness, symmetric", "none") {
        expect(65, "design.variables",
               brief("simulate configs/quick.ini --design none --set 'design.variables=%s'", *list));
    }
    DesignSpace space;
    DesignOptions o = scene_defaults().design;
    o.gap_zones = 5;
    assert_refused(design_space_make(&space, &o, CORE_BOX, 4, &err), STATUS_BAD_DATA, "design.gap_zones");
}

/* -- the same building by other variables -------------------------------------------------------------------------- */

static SimResult simulate(const SceneOptions *o, const double x[])
{
    OWNED(motion_free) Motion motion = motion_of("builtin:kobe-like", 0.3, 1.5);
    const SimResult r = run_once(o, &motion, SCENE_IMPACT, x);
    assert_less(10, r.impacts);
    return r;
}

TEST(a_design_is_simulated_the_same_by_any_variables)
{
    SceneOptions plain = scene_defaults(), zoned = plain;
    double x[22], z[10] = {0.002, 0.004, 0.008, 0.012, 0.016, 0.012, 0.0064, 9, 8.5, 9.4};
    plain.sim.duration_s = zoned.sim.duration_s = 14;
    plain.sim.forces = zoned.sim.forces = FORCES_YES;
    plain.contact.bumper_stiffness_n_m = 1e9;
    plain.core.width_m = 9.4;
    snprintf(zoned.design.variables, sizeof zoned.design.variables, "gaps, thickness, bumper, side");
    zoned.design.gap_zones = 5;
    zoned.design.bumper_zones = 2;
    for (int j = 0; j < 20; j++)
        x[j] = z[j / 4];
    x[20] = z[5];
    x[21] = z[6];
    SimResult a = simulate(&plain, x), b = simulate(&zoned, z);
    assert_true(a.j1_m != b.j1_m); /* the bumpers of the upper half differ */
    z[8] = 9;
    b = simulate(&zoned, z);
    assert_close_in(b, a, 1e-12, j1_m, j3_g);
    assert_close(b.mcore_kg, a.mcore_kg, 1e-15);
    assert_close(b.forces.core_stress_pa, a.forces.core_stress_pa, 1e-12);
}

/* -- commands ------------------------------------------------------------------------------------------------------ */
#define SHORT SIX_FLOORS "--set motion.record=builtin:elcentro-like --set sim.duration_s=4 --set sim.accuracy=coarse "
#define WIDE  "--set design.variables=gaps,thickness,bumper,side --set design.gap_zones=3 "

static char *said; /* by the search */

static void make_run(void)
{
    said = output_of("optimize configs/quick.ini --out @/run --threads 2 --max-evals 24 --set search.initial=12 "
                     "--set search.population=12 --set search.polish=0 " WIDE SHORT);
}

static int end_run(void **state)
{
    free(said);
    return clear_place(state);
}

TEST(a_named_design_that_cannot_be_predicted_is_said_to_be_so)
{
    OWNED(run_free) Run run;
    long n = 0;
    CHECK_OK(run_read(&run, there("run"), &err), &err);
    for (size_t k = 0; k <= run.schema.n_obj; k++)
        n += run_is_unpredictable(&run, k < run.schema.n_obj ? run_best(&run, k) : run_knee(&run));
    for (const char *at = said; (at = strstr(at, "  unpredictable\n")); at++)
        n--;
    assert_int_equal(n, 0);
}

TEST(every_command_follows_the_variables_of_a_run)
{
    static const char HEADER[] =
        "id,gap_zone_1_m,gap_zone_2_m,gap_zone_3_m,t_base_m,t_top_m,bumper_log10_n_m,side_m,j1_m,";
    FREED char *front = text_of(there("run/front.csv"));
    assert_int_equal(strncmp(front, HEADER, sizeof HEADER - 1), 0);
    FOR_EACH (
        const char *, command, "choose @/run --csv @/chosen.csv",
        "simulate configs/quick.ini " SHORT WIDE "--json --design @/run:knee",
        "simulate configs/quick.ini " SHORT WIDE "--design @/run/front.csv",
        "simulate configs/quick.ini " SHORT WIDE "--replicates 2 --design @/run:knee", "evaluate @/run --design knee",
        "polish @/run --design knee --max-evals 24", "building configs/quick.ini " WIDE "--design @/run:knee",
        "check configs/quick.ini " WIDE SHORT,
        "optimize configs/quick.ini --out @/again --max-evals 20 --set search.polish=0 --set search.start=@/run " WIDE
            SHORT,
        "report @/run") {
        free(output_of("%s", *command));
    }
}

TEST(designs_of_other_variables_are_refused)
{
    expect(65, "design.variables", "simulate configs/quick.ini " SHORT "--design @/run:knee");
    expect(65, "other design.variables: a design of these",
           "simulate configs/quick.ini " SHORT "--design @/run/front.csv");
}

SUITE_FILLED(make_place, make_run, end_run)
