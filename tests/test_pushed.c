/* Forces on floors over time: closed forms of a single mass, a ground motion told as forces, files that are wrong. */
#include "bench/stability/bob.h"
#include "motion/forces.h"
#include "program.h"
#include "one_scene.h"

/* -- one mass ------------------------------------------------------------------------------------------------------ */

static const double MASS = 2e5, OMEGA = 2 * M_PI * 0.8, STEP = 1e-3, FORCE = 3e5;
enum { SAMPLES = 4001 };

typedef double ForceFn(double t);

/* Undamped, under a force that is linear between samples; 1: in free flight alone, nothing to meet. */
static SimResult push(Engine engine, ForceFn force, double duration, double gap)
{
    static double accel[SAMPLES], f[SAMPLES];
    const Motion motion = {.accel = accel, .n = SAMPLES, .dt_s = STEP, .force = f, .n_force = 1};
    OWNED(model_free) SimModel model;
    SimResult r;
    for (int i = 0; i < SAMPLES; i++)
        f[i] = FORCE * force(i * STEP);
    bobs_model(&model, 1, &(Bob){.mass = MASS, .omega = OMEGA, .gap = gap}, 0,
               &(Contact){.k = 4.8650e10, .a = 0, .v0_floor = 1e-6});
    const EngineOptions o = {.duration = duration, .accuracy = ACCURACY_FINE};
    CHECK_OK(engine_entry(engine)->run(&model, &motion, &o, &r, &err), &err);
    assert_ran(&r);
    assert_less(r.energy_balance_error, 1e-6);
    return r;
}

static double step_force(double t)
{
    return t < 1e9;
}

static double ramp_force(double t)
{
    return fmin(t / 0.5, 1);
}

static double blast(double t)
{
    return fmax(1 - t / 0.2, 0);
}

static double half_sine(double t)
{
    return t < 0.3125 ? sin(M_PI * t / 0.3125) : 0; /* a quarter of the period */
}

/* K. Chopra's and Biggs's textbooks: response of an undamped oscillator, in units of F / k. */
TEST(a_single_mass_answers_step_ramp_half_sine_and_blast_as_the_closed_forms_say)
{
    const double rest = FORCE / (MASS * OMEGA * OMEGA), period = 2 * M_PI / OMEGA;
    for (Engine e = 0; e < ENGINE_COUNT; e++) {
        SimResult r = push(e, step_force, 3, 1e300);
        assert_close(r.j1_m, 2 * rest, 1e-5);
        assert_close(r.j3_g * GRAVITY, FORCE / MASS, 1e-5); /* absolute: the ground is at rest */
        assert_close(r.input_energy_j, FORCE * rest * (1 - cos(OMEGA * 3)), 1e-5);
        r = push(e, step_force, 4, 1e300); /* to the last sample */
        assert_close(r.input_energy_j, FORCE * rest * (1 - cos(OMEGA * 4)), 1e-5);
        r = push(e, ramp_force, 3, 1e300);
        assert_close(r.j1_m, rest * (1 + fabs(sin(M_PI * 0.5 / period)) / (M_PI * 0.5 / period)), 1e-5);
        r = push(e, half_sine, 3, 1e300); /* beta 2: the peak comes after the pulse */
        assert_close(r.j1_m, rest * 4.0 / 3 * cos(M_PI / 4), 1e-4);
        const double t = 0.2, u = rest * (sin(OMEGA * t) / (OMEGA * t) - cos(OMEGA * t));
        const double v = rest * OMEGA * (sin(OMEGA * t) + (cos(OMEGA * t) - 1) / (OMEGA * t));
        r = push(e, blast, 3, 1e300); /* free vibration after it */
        assert_close(r.j1_m, hypot(u, v / OMEGA), 1e-4);
        assert_close(r.input_energy_j, 0.5 * MASS * (v * v + pow(OMEGA * u, 2)), 1e-4);
        assert_close(r.kinetic_strain_j, r.input_energy_j, 1e-6);
    }
}

TEST(a_pushed_mass_meets_its_stop_at_the_time_and_speed_of_the_closed_form)
{
    const double rest = FORCE / (MASS * OMEGA * OMEGA), v = rest * OMEGA; /* at u = F/k */
    for (Engine e = 0; e < ENGINE_COUNT; e++) {
        const SimResult r = push(e, step_force, 0.6, rest);
        assert_int_equal(r.impacts, 1);
        assert_close(r.indentation_max_m, contact_hertz_indentation(4.865e10, MASS, v), 1e-3);
    }
}

/* -- buildings ----------------------------------------------------------------------------------------------------- */

static const char STOREYS[] = "height_m,mass_kg,stiffness_n_m\n4,2.1e5,3e8\n3.5,1.9e5,2.4e8\n3.5,1.5e5,1.9e8\n";
static const double MASSES[] = {2.1e5, 1.9e5, 1.5e5};

static SceneOptions three_storeys(Engine engine)
{
    SceneOptions o = scene_defaults();
    write_in_place("three/storeys.csv", STOREYS);
    snprintf(o.building.model, sizeof o.building.model, "%s", there("three"));
    o.sim.engine = engine;
    o.sim.accuracy = ACCURACY_FINE;
    return o;
}

/* Relative to the ground a shaken building is one that is pushed by -m a. */
TEST(a_ground_motion_told_as_forces_gives_the_same_displacements_and_energy)
{
    Motion motion, told;
    CHECK_OK(motion_load(&motion, "builtin:elcentro-like", UNIT_FROM_FILE, &err), &err);
    told = motion;
    told.n_force = 3;
    told.accel = calloc(motion.n, sizeof *told.accel);
    told.force = calloc(3 * motion.n, sizeof *told.force);
    for (size_t i = 0; i < motion.n; i++)
        for (size_t j = 0; j < 3; j++)
            told.force[3 * i + j] = -MASSES[j] * motion.accel[i];
    for (Engine e = 0; e < ENGINE_COUNT; e++) {
        const SceneOptions o = three_storeys(e);
        const SimResult a = simulate(&o, SCENE_NO_CORE, &motion, NULL), b = simulate(&o, SCENE_NO_CORE, &told, NULL);
        assert_close_in(b, a, 1e-5, j1_m, j2_m);
        assert_close_in(b, a, 1e-6, input_energy_j, ed1_pct);
        /* and half of each is the whole */
        for (size_t i = 0; i < motion.n; i++)
            motion.accel[i] *= 0.5;
        told.accel = memcpy(told.accel, motion.accel, motion.n * sizeof *told.accel);
        for (size_t i = 0; i < 3 * motion.n; i++)
            told.force[i] *= 0.5;
        const SimResult both = simulate(&o, SCENE_NO_CORE, &told, NULL);
        assert_close(both.j1_m, a.j1_m, 1e-5);
        assert_close(both.input_energy_j, a.input_energy_j, 1e-6);
        memset(told.accel, 0, motion.n * sizeof *told.accel);
        for (size_t i = 0; i < motion.n; i++)
            motion.accel[i] *= 2;
        for (size_t i = 0; i < 3 * motion.n; i++)
            told.force[i] *= 2;
    }
    free(told.accel);
    free(told.force);
    motion_free(&motion);
}

/* A blast of 0.1 s on three floors of the built-in tower, with the ground at rest or not. */
static void blast_on_tower(Motion *m, const char *record)
{
    MotionOptions o = {.stretch = 1, .factor = 1, .unit = "from_file", .channel = "auto"};
    write_in_place("blast.csv", "time_s,floor_05_n,floor_06_n,floor_07_n\n0,3e7,4e7,2e7\n0.1,0,0,0\n12,0,0,0\n");
    snprintf(o.record, sizeof o.record, "%s", record);
    snprintf(o.forces, sizeof o.forces, "%s", there("blast.csv"));
    CHECK_OK(motion_open(m, &o, &err), &err);
    CHECK_OK(motion_scale(m, &o, &err), &err);
    assert_int_equal(m->n_force, 7);
    assert_close(motion_force(m, 4, 0.05), 1.5e7, 1e-9);
    assert_true(motion_force(m, 0, 0.05) == 0 && motion_force(m, 5, 3) == 0);
}

TEST(both_engines_agree_on_impacts_under_a_blast_and_the_baselines_know_it)
{
    static const char *const RECORDS[] = {"none", "builtin:kobe-like"};
    double x[22] = {[20] = 0.03, [21] = 0.02};
    for (int j = 0; j < 20; j++)
        x[j] = 0.005 + 0.01 * fmod(0.618 * (j + 1), 1);
    for (int i = 0; i < 2; i++) {
        OWNED(motion_free) Motion m;
        SceneOptions o = scene_defaults();
        blast_on_tower(&m, RECORDS[i]);
        o.sim.duration_s = i ? 3 : 8;
        o.sim.accuracy = ACCURACY_FINE;
        const SimResult fast = simulate(&o, SCENE_IMPACT, &m, x), bare = simulate(&o, SCENE_NO_CORE, &m, x);
        for (SceneKind kind = SCENE_RIGID; kind < N_SCENES; kind++)
            assert_less(simulate(&o, kind, &m, x).energy_balance_error, 1e-4);
        const SimResult links = simulate(&o, SCENE_LINKS, &m, x); /* dashpots of nothing: the building alone */
        assert_close(links.j1_m, bare.j1_m, 1e-3);
        assert_close(links.j3_g, bare.j3_g, 1e-2);
        o.sim.engine = ENGINE_CVODE;
        const SimResult cvode = simulate(&o, SCENE_IMPACT, &m, x);
        assert_less(3, fast.impacts);
        assert_close(fast.j1_m, cvode.j1_m, 1e-5);
        assert_close(fast.j2_m, cvode.j2_m, 1e-4);
        assert_close(fast.j3_g, cvode.j3_g, 1e-3);
        assert_close(fast.input_energy_j, cvode.input_energy_j, 1e-4);
    }
}

/* -- files and commands -------------------------------------------------------------------------------------------- */

static void refuse(const char *text, const char *message)
{
    write_in_place("f.csv", text);
    expect(65, message, "check configs/quick.ini --set motion.record=none --set motion.forces=@/f.csv");
}

TEST(a_file_of_forces_that_is_wrong_is_refused_by_its_line_and_column)
{
    refuse("t,floor_01_n\n0,1\n1,0\n", "its first column is 't'");
    refuse("time_s,floor_one_n\n0,1\n1,0\n", "column 'floor_one_n': time_s and then floor_01_n");
    refuse("time_s,floor_01_n\n0.5,1\n1,0\n", "f.csv:2: time_s is 0.5; times begin at 0 and ascend");
    refuse("time_s,floor_01_n\n0,1\n1,0\n1,0\n", "f.csv:4: time_s is 1; times begin at 0 and ascend");
    refuse("time_s,floor_01_n\n0,1\n1,\n", "f.csv:3: column floor_01_n is missing");
    refuse("time_s,floor_01_n\n0,1\n", "1 rows; forces need two or more");
    refuse("time_s,floor_01_n\n0,0\n1,0\n", "motion.forces: ");
    refuse("time_s,floor_01_n\n0,0\n1,0\n", "every force is 0; leave motion.forces at none");
    refuse("time_s,floor_21_n\n0,1\n1,0\n", "motion.forces: column floor_21_n; the building has 20 floors");
    expect(65, "motion.record = none: then nothing moves but by motion.forces",
           "check configs/quick.ini --set motion.record=none");
}

TEST(histories_of_a_pushed_building_show_the_accelerations_that_the_peaks_are_of)
{
    write_in_place("f.csv", "time_s,floor_20_n\n0,1e7\n2,1e7\n2.01,0\n6,0\n");
    free(output_of("simulate configs/quick.ini --set motion.record=none --set motion.forces=@/f.csv --design none "
                   "--history @/h.csv --every 0.01 --csv @/r.csv"));
    OWNED(table_free) Table h, r;
    CHECK_OK(table_read(&h, there("h.csv"), TABLE_HEADED, &err), &err);
    CHECK_OK(table_read(&r, there("r.csv"), TABLE_WORDS, &err), &err);
    double most = 0, wanted;
    for (size_t i = 0; i < h.n_rows; i++)
        most = fmax(most, fabs(h.values[i * h.n_cols + (size_t)table_column(&h, "accel_20_g")]));
    CHECK_OK(sheet_number(&r, 0, "j3_g", NAN, &wanted, &err), &err);
    assert_close(most, wanted, 1e-2);
}

TEST(the_example_of_a_blast_runs_from_its_folder_and_ends_in_free_vibration)
{
    write_in_place("d.csv", "gap_zone_1_m,gap_zone_2_m,gap_zone_3_m,gap_zone_4_m,gap_zone_5_m,t_base_m,t_top_m\n"
                            "0.012,0.03,0.05,0.07,0.09,0.03,0.02\n");
    json_auto_t *o = as_json("simulate configs/blast.ini --design @/d.csv --json");
    json_t *r = json_is_array(json_object_get(o, "results")) ? json_array_get(json_object_get(o, "results"), 0) : o;
    assert_less(5, number(r, "impacts"));
    assert_less(0, number(r, "input_energy_j"));
    assert_less(number(r, "energy_balance_error"), 1e-3);
}

SUITE(make_place, clear_place)
