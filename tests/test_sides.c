/* Gaps of which the two sides differ: a single mass against closed forms, the tower against its own mirror image. */
#include "bench/stability/bob.h"
#include "evaluate/replicates.h"
#include "program.h"
#include "scene_options.h"

/* -- one mass ------------------------------------------------------------------------------------------------------ */

static const double MASS = 1e3;

/* A single mass in one engine, pushed to the right by a triangular pulse of 1 m/s that lasts 2 s. */
static SimResult push(Engine engine, double omega, double right, double left, double v, double duration, OnsetLog *log)
{
    double pulse[] = {0, -v, 0};
    const Motion motion = {.accel = pulse, .n = 3, .dt_s = 1};
    OWNED(model_free) SimModel model;
    SimResult r;
    bobs_model(&model, 1, &(Bob){.mass = MASS, .omega = omega}, 0,
               &(Contact){.k = 4.8650e10, .a = 0, .v0_floor = 1e-6});
    CHECK_OK(model_set_gaps(&model, &right, &left, &err), &err);
    const EngineOptions o = {.duration = duration, .accuracy = ACCURACY_FINE, .onsets = log};
    CHECK_OK(engine_entry(engine)->run(&model, &motion, &o, &r, &err), &err);
    assert_ran(&r);
    return r;
}

TEST(a_free_mass_flies_to_its_own_gap_on_either_side_and_not_at_all_where_there_is_nothing)
{
    for (Engine e = 0; e < ENGINE_COUNT; e++) {
        ContactOnset at[4];
        OnsetLog log = {.n_max = 4, .at = at};
        /* at 2 s the mass is at 1 m with 1 m/s; right gap 1.5 m: closes at 2.5 s, flies back to -0.7 m: 4.7 s */
        SimResult r = push(e, 0, 1.5, 0.7, 1, 5, e == ENGINE_CVODE ? &log : NULL);
        assert_int_equal(r.impacts, 2);
        if (log.n == 2) {
            assert_close(at[0].t, 2.5, 1e-8);
            assert_close(at[1].t, 4.7 + contact_hertz_duration(4.865e10, MASS, 1), 1e-6);
            assert_close(at[1].speed, 1, 1e-6);
        }
        assert_close(r.peak_displacement_m[0], 1.5 + contact_hertz_indentation(4.865e10, MASS, 1), 1e-6);
        assert_int_equal(push(e, 0, INFINITY, 0.7, 1, 5, NULL).impacts, 0);
        assert_int_equal(push(e, 0, 1.5, INFINITY, 1, 5, NULL).impacts, 1);
        r = push(e, 0, 1.5, INFINITY, 1, 5, NULL);
        assert_close(r.indentation_max_m, contact_hertz_indentation(4.865e10, MASS, 1), 1e-6);
        r = push(e, 0, INFINITY, 1.5, -1, 5, NULL);
        assert_int_equal(r.impacts, 1);
        assert_close(r.indentation_max_m, contact_hertz_indentation(4.865e10, MASS, 1), 1e-6);
    }
}

/* Against a stop that it just touches an oscillator sees half of its orbit: it returns after pi / w and not 2 pi / w
 * (S. W. Shaw and P. J. Holmes, J. Sound Vib. 90 (1983) 129). Contacts of some ms stretch that a little. */
TEST(an_oscillator_at_a_stop_has_twice_its_frequency)
{
    const double omega = 2 * M_PI * 0.35;
    ContactOnset at[16];
    OnsetLog log = {.n_max = 16, .at = at};
    const SimResult r = push(ENGINE_CVODE, omega, 0, INFINITY, 1, 16, &log);
    assert_less(8, log.n);
    for (int i = log.n - 4; i < log.n; i++)
        assert_close(at[i].t - at[i - 1].t, M_PI / omega, 0.02);
    assert_int_equal(push(ENGINE_FAST, omega, 0, INFINITY, 1, 16, NULL).impacts, r.impacts);
}

/* -- the tower ----------------------------------------------------------------------------------------------------- */

/* Under the built-in record, with sign -1 under its mirror image. */
static SimResult tower(GapSides sides, Engine engine, double sign, const double x[])
{
    SceneOptions o = scene_defaults();
    o.design.gap_sides = sides;
    o.sim.engine = engine;
    o.sim.duration_s = 18;
    o.sim.forces = FORCES_YES;
    OWNED(motion_free) Motion motion = motion_of("builtin:kobe-like", 0.3, 1.5);
    for (size_t i = 0; i < motion.n; i++)
        motion.accel[i] *= sign;
    SimResult r = run_once(&o, &motion, SCENE_IMPACT, x);
    r.seconds = 0;
    return r;
}

/* Irregular gaps of 20 floors from x on, equal ones are chaotic; behind them the walls. */
static void set_gaps(double x[22], double from, double to)
{
    for (int j = 0; j < 20; j++)
        x[j] = from + (to - from) * fmod(0.618 * (j + 1), 1);
    x[20] = 0.03;
    x[21] = 0.02;
}

TEST(equal_gaps_on_each_side_give_the_bytes_of_a_gap_on_both)
{
    double both[22], each[42];
    set_gaps(both, 0.005, 0.03);
    memcpy(each, both, 20 * sizeof *both);
    memcpy(each + 20, both, sizeof both);
    const SimResult a = tower(GAPS_BOTH, ENGINE_FAST, 1, both), b = tower(GAPS_EACH, ENGINE_FAST, 1, each);
    assert_less(50, a.impacts);
    assert_memory_equal(&a, &b, sizeof a);
}

static void expect_mirrored(const SimResult *a, const SimResult *b)
{
    assert_less(20, a->impacts);
    assert_int_equal(a->impacts, b->impacts);
    assert_close_in(*b, *a, 1e-9, j1_m, j2_m, j3_g, edcs_pct);
    for (int j = 0; j < 20; j++)
        for (int side = 0; side < SIDES; side++)
            assert_close(b->forces.contact_force_n[1 - side][j], a->forces.contact_force_n[side][j], 1e-8);
}

TEST(mirrored_gaps_under_the_mirrored_record_give_mirrored_results)
{
    double each[42], mirrored[42], one[22];
    set_gaps(each, 0.005, 0.02);
    set_gaps(each + 20, 0.04, 0.015);
    memcpy(mirrored, each + 20, 20 * sizeof *each);
    memcpy(mirrored + 20, each, 20 * sizeof *each);
    memcpy(mirrored + 40, each + 40, 2 * sizeof *each);
    const SimResult a = tower(GAPS_EACH, ENGINE_FAST, 1, each), b = tower(GAPS_EACH, ENGINE_FAST, -1, mirrored);
    expect_mirrored(&a, &b);
    set_gaps(one, 0.005, 0.03);
    const SimResult l = tower(GAPS_LEFT, ENGINE_FAST, 1, one), r = tower(GAPS_RIGHT, ENGINE_FAST, -1, one);
    expect_mirrored(&l, &r);
    for (int j = 0; j < 20; j++)
        assert_true(l.forces.contact_force_n[0][j] == 0); /* nothing stands on the right */
    assert_less(1e-3, fabs(a.j1_m / l.j1_m - 1));
}

TEST(both_engines_agree_on_gaps_that_differ)
{
    double each[42], left[22];
    set_gaps(each, 0.01, 0.05);
    set_gaps(each + 20, 0.10, 0.03);
    set_gaps(left, 0.015, 0.05);
    for (int i = 0; i < 2; i++) {
        const GapSides sides = i ? GAPS_LEFT : GAPS_EACH;
        const SimResult fast = tower(sides, ENGINE_FAST, 1, i ? left : each);
        const SimResult cvode = tower(sides, ENGINE_CVODE, 1, i ? left : each);
        assert_less(10, fast.impacts);
        assert_close(fast.j1_m, cvode.j1_m, 2e-3);
        assert_close(fast.j2_m, cvode.j2_m, 5e-3);
        assert_close(fast.j3_g, cvode.j3_g, 2e-2);
        assert_close(fast.input_energy_j, cvode.input_energy_j, 5e-3);
        assert_close(fast.indentation_max_m, cvode.indentation_max_m, 2e-2);
    }
}

/* -- variables and commands ---------------------------------------------------------------------------------------- */

TEST(replicates_change_both_sides_together_only_where_they_are_one_variable)
{
    const double x[] = {0.1, 0.2, 0.3, 0.4, 0.02, 0.01};
    for (GapSides sides = GAPS_BOTH; sides <= GAPS_EACH; sides++) {
        DesignOptions o = scene_defaults().design;
        DesignSpace s;
        Design d, was;
        o.gap_sides = sides;
        CHECK_OK(design_space_make(&s, &o, CORE_BOX, 2, &err), &err);
        assert_int_equal(s.n_var, sides == GAPS_EACH ? 6 : 4);
        assert_int_equal(design_space_floors(&o, CORE_BOX, s.n_var), 2);
        design_of(&s, x, &was);
        d = was;
        replicate_gaps(1, 0, 0.01, &s, &d);
        assert_memory_equal(d.gap, was.gap, sizeof d.gap[0] / FLOORS_MAX * 2);
        replicate_gaps(1, 1, 0.01, &s, &d);
        assert_true((d.gap[0][0] == d.gap[1][0]) == (sides == GAPS_BOTH));
        assert_true(isinf(d.gap[0][0]) == (sides == GAPS_LEFT) && isinf(d.gap[1][1]) == (sides == GAPS_RIGHT));
        for (int j = 0; j < 2; j++)
            for (int i = 0; i < SIDES; i++)
                assert_true(isinf(d.gap[i][j]) ||
                            (d.gap[i][j] != was.gap[i][j] && fabs(d.gap[i][j] - was.gap[i][j]) < 0.05));
    }
}

#define SHORT SIX_FLOORS "--record builtin:elcentro-like --set sim.duration_s=4 --set sim.accuracy=coarse "
#define EACH  "--set design.gap_sides=each --set design.gap_zones=2 --set design.variables=gaps,thickness,bumper,side "

TEST(every_command_follows_gaps_by_side)
{
    static const char HEADER[] = "id,gap_left_zone_1_m,gap_left_zone_2_m,gap_right_zone_1_m,gap_right_zone_2_m,t_base_"
                                 "m,t_top_m,bumper_log10_n_m,side_m,j1_m,";
    free(output_of("optimize configs/quick.ini --out @/run --threads 2 --max-evals 24 --set search.initial=12 "
                   "--set search.population=12 --set search.polish=0 " EACH SHORT));
    FREED char *front = read_in_place("run/front.csv");
    assert_int_equal(strncmp(front, HEADER, sizeof HEADER - 1), 0);
    FOR_EACH (const char *, command, "simulate configs/quick.ini " SHORT EACH "--json --design @/run:knee",
              "simulate configs/quick.ini " SHORT EACH "--replicates 2 --design @/run:knee",
              "simulate configs/quick.ini " SHORT EACH "--design @/run:knee --contacts @/contacts.csv",
              "check configs/quick.ini " EACH SHORT, "status @/run", "export @/run --all --csv @/all.csv",
              has_browser() ? "report @/run --pictures @/pictures" : "report @/run", "report @/run") {
        free(output_of("%s", *command));
    }
    expect_file("run/report.html", "\"gap_side_m\":[[");
}

SUITE(make_place, clear_place)
