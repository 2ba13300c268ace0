/* The engine `fast` against closed forms, symmetry, conservation and printed numbers. Limits of gaps, strength and steps
 * are cases of `imtet-bench stability`, agreement with CVODE is in test_window.c. */
#include "bench/stability/bob.h"

#include "base/csv.h"
#include "sim/fast/fast.h"
#include "one_scene.h"

/* ---- one ball and a wall ------------------------------------------------------------------------------------ */

/* A free mass behind a gap, set in motion by a short push of the ground, and a core too heavy to move. */
typedef struct {
    double m, k, v, r; /* [kg], [N/m^1.5], [m/s], [-] */
    FastTolerances tolerances;
} Ball;

typedef struct {
    SimResult result;
    double speed, penetration, duration, closing; /* Hertz's, and when it closes */
    double dt;
} Bounce;

/* Push: a(t) a triangle of two samples, so that the speed afterwards is v; the ball then flies 3 dt to the wall. With
 * `until` >= 0 the run stops there, in units of Hertz's duration after closing. */
static void bounce(const Ball *ball, double until, Bounce *b)
{
    OWNED(model_free) SimModel model;
    FastWork *work;
    b->penetration = contact_hertz_indentation(ball->k, ball->m, ball->v);
    b->duration = contact_hertz_duration(ball->k, ball->m, ball->v);
    b->speed = ball->v;
    b->dt = 7.3 * b->duration;
    double accel[12] = {0, -ball->v / b->dt};
    /* after the triangle (2 dt) the ball has gone v dt */
    const Motion motion = {.accel = accel, .n = 12, .dt_s = b->dt};
    b->closing = 5 * b->dt;
    bobs_model(&model, 1, &(Bob){.mass = ball->m, .gap = ball->v * b->dt + ball->v * 3 * b->dt}, 0,
               &(Contact){.k = ball->k, .a = 1.5 * (1 - ball->r), .v0_floor = 1e-300});
    CHECK_OK(fast_create(&work, 1, 1, 0, 0, &err), &err);
    const double end = until >= 0 ? b->closing + until * b->duration : 8 * b->dt;
    fast_run(work, &model, &motion, &(EngineOptions){.duration = end}, &ball->tolerances, &b->result);
    fast_free(work);
}

TEST(rebound_has_its_closed_form_over_twelve_decades_of_mass_stiffness_and_speed)
{
    const double table[][2] = {{.3, .58128804}, {.5, .66296220}, {.7, .76799979}, {.9, .90901574}};
    const double decades[] = {1e-6, 1e-3, 1, 1e3, 1e6};
    for (int r = 0; r < 4; r++)
        for (int i = 0; i < 5; i++)
            for (int which = 0; which < 3; which++) {
                const double d = decades[i];
                Ball ball = {1000 * (which == 0 ? d : 1), 4.865e10 * (which == 1 ? d : 1), 0.3 * (which == 2 ? d : 1),
                             table[r][0], fast_tolerances(ACCURACY_FINE)};
                Bounce b;
                bounce(&ball, -1, &b);
                assert_int_equal(b.result.outcome, RUN_OK);
                assert_int_equal(b.result.impacts, 1);
                assert_close(b.result.input_energy_j, 0.5 * ball.m * ball.v * ball.v, 1e-10);
                assert_close(sqrt(b.result.kinetic_strain_j / b.result.input_energy_j), table[r][1], 1e-6);
                assert_close(sqrt(1 - b.result.contact_loss_j / b.result.input_energy_j), table[r][1], 1e-6);
            }
}

/* Penetration and force as shares of those without loss; stored energy until the contact has lasted so many durations. */
static void check_impact(double rebound, double penetration, double force, double duration)
{
    Ball ball = {280000, 4.865e10, 0.4, rebound, fast_tolerances(ACCURACY_FINE)};
    Bounce b;
    bounce(&ball, -1, &b);
    if (rebound == 1)
        assert_close(b.result.kinetic_strain_j, b.result.input_energy_j, 1e-8);
    assert_close(b.result.indentation_max_m, penetration * b.penetration, 1e-4);
    assert_close(b.result.j3_g * 9.81 * ball.m, force * ball.k * pow(b.penetration, 1.5), 1e-4);
    bounce(&ball, duration - 1e-4, &b);
    assert_less(0, b.result.contact_stored_j);
    bounce(&ball, duration + 1e-4, &b);
    assert_same_number(b.result.contact_stored_j, 0);
}

TEST(hertz_impact_has_its_penetration_force_and_duration)
{
    check_impact(1, 1, 1, 1);
}

TEST(damped_impact_has_its_known_penetration_force_and_duration)
{
    check_impact(0.7, 0.902920, 0.911023, 1.03332);
}

TEST(rebound_converges_with_at_least_third_order)
{
    const double exact = contact_rebound(0.45);
    double worst[2] = {0};
    for (int fine = 0; fine < 2; fine++)
        for (int i = 0; i < 40; i++) { /* the closing falls anywhere in a step */
            Ball ball = {1000,
                         4.865e10,
                         0.3 * (1 + 0.01 * i),
                         0.7,
                         {.steps_per_contact = fine ? 32 : 8,
                          .solver_tolerance = 1e-13,
                          .steps_max = 1e7,
                          .peak_tolerance = 1e-6}};
            Bounce b;
            bounce(&ball, -1, &b);
            worst[fine] = fmax(worst[fine], fabs(sqrt(b.result.kinetic_strain_j / b.result.input_energy_j) - exact));
        }
    if (!(log(worst[0] / worst[1]) / log(4) > 3)) {
        print_error("rebound errors %.3g and %.3g: order %.2f\n", worst[0], worst[1],
                    log(worst[0] / worst[1]) / log(4));
        fail();
    }
}

TEST(at_every_accuracy_an_impact_rebounds_right_wherever_it_falls_in_a_step)
{
    const double allowed[] = {[ACCURACY_COARSE] = 2e-2, [ACCURACY_STANDARD] = 3e-3, [ACCURACY_FINE] = 1e-6};
    for (int accuracy = ACCURACY_COARSE; accuracy <= ACCURACY_FINE; accuracy++)
        for (int i = 0; i < 200; i++) {
            const double r = 0.3 + 0.23 * (i % 4), speed = 0.3 * pow(1.02, i);
            Ball ball = {1000, 4.865e10, speed, r, fast_tolerances((Accuracy)accuracy)};
            Bounce b;
            bounce(&ball, -1, &b);
            const double rebound = sqrt(b.result.kinetic_strain_j / b.result.input_energy_j);
            assert_less(fabs(rebound - contact_rebound(1.5 * (1 - r))), allowed[accuracy]);
        }
}

/* A heavy floor flies freely and holds a million times the energy of the blow. */
TEST(a_blow_too_weak_for_the_books_still_has_its_largest_acceleration)
{
    const Contact contact = {.k = 4.865e10, .v0_floor = 1e-300};
    for (int i = 0; i < 60; i++) {
        OWNED(model_free) SimModel model;
        FastWork *work;
        SimResult result;
        const double m = 1000, v = 0.1 * pow(1.03, i), dt = 7.3 * contact_hertz_duration(contact.k, m, v);
        double accel[12] = {0, -v / dt};
        const Motion motion = {.accel = accel, .n = 12, .dt_s = dt};
        const Bob floors[] = {{.mass = 1e6 * m, .gap = 1e9}, {.mass = m, .gap = v * (4 + 0.01 * i) * dt}};
        const FastTolerances tolerances = fast_tolerances(ACCURACY_STANDARD);
        bobs_model(&model, 2, floors, 0, &contact);
        CHECK_OK(fast_create(&work, 2, 2, 0, 0, &err), &err);
        fast_run(work, &model, &motion, &(EngineOptions){.duration = 8 * dt}, &tolerances, &result);
        assert_int_equal(result.impacts, 1);
        const double depth = contact_hertz_indentation(contact.k, m, v);
        assert_close(result.peak_acceleration_g[1] * 9.81, contact.k * pow(depth, 1.5) / m, 3e-2);
        fast_free(work);
    }
}

/* ---- the tower ---------------------------------------------------------------------------------------------- */

static SimResult tower_run(Tower *t, SceneKind kind)
{
    SimResult r;
    CHECK_OK(sim_run(t->worker, kind, t->x, &r, &err), &err);
    return r;
}

TEST(early_window_has_the_digits_that_independent_integrators_share)
{
    Tower t = {.settings = paper_settings()};
    snprintf(t.settings.motion.record, OPTION_TEXT_MAX, "../shared/records/northridge_sylmar_ns.csv");
    need_file(t.settings.motion.record);
    t.settings.core.section = CORE_EFFECTIVE;
    t.settings.motion.stretch = 3.0;
    t.settings.sim.duration_s = 11;
    t.settings.sim.accuracy = ACCURACY_FINE;
    tower_open(&t, 0.012, 0.0064);
    const SimResult fine = tower_run(&t, SCENE_IMPACT);
    assert_close(fine.j1_m, 0.370445, 3e-6);
    assert_close(fine.j2_m, 0.032808, 2e-5);
    assert_close(fine.j3_g, 4.859, 1.1e-4);
    assert_close(fine.ed1_pct, 2.719, 2e-4);
    assert_close(fine.ed5_10_pct, 1.574, 4e-4);
    assert_close(fine.edcs_pct, 1.634, 4e-4);
    assert_close(fine.input_energy_j, 1.3096e6, 5e-5);
    assert_less(fine.energy_balance_error, 1e-4);
    tower_close(&t);
    t.settings.sim.accuracy = ACCURACY_STANDARD;
    tower_open(&t, 0.012, 0.0064);
    const SimResult standard = tower_run(&t, SCENE_IMPACT);
    assert_close(standard.j1_m, fine.j1_m, 1e-3);
    assert_close(standard.j2_m, fine.j2_m, 3e-3);
    assert_close(standard.j3_g, fine.j3_g, 2e-2);
    assert_close_in(standard, fine, 1e-2, ed1_pct, ed5_10_pct, edcs_pct);
    tower_close(&t);
}

TEST(kobe_without_a_core_has_its_known_response)
{
    OWNED(tower_close) Tower t = {.settings = paper_settings()};
    snprintf(t.settings.motion.record, OPTION_TEXT_MAX, "../shared/records/kobe_jma_ns.csv");
    need_file(t.settings.motion.record);
    tower_open(&t, 0.012, 0.0064);
    const SimResult r = tower_run(&t, SCENE_NO_CORE);
    assert_close(r.j1_m, 1.648, 3e-3);
    assert_close(r.j2_m, 0.1475, 3e-3);
    assert_close(r.j3_g, 0.901, 3e-3);
    assert_close(r.ed1_pct, 88.8, 3e-3);
}

static void builtin_tower(Tower *t)
{
    *t = (Tower){.settings = paper_settings()};
    t->settings.sim.duration_s = 14;
    snprintf(t->settings.motion.record, OPTION_TEXT_MAX, "builtin:sylmar-like");
    tower_open(t, 0.012, 0.0064);
}

TEST(energy_balance_closes_and_damping_never_gives)
{
    OWNED(tower_close) Tower t;
    builtin_tower(&t);
    const SimResult r = tower_run(&t, SCENE_IMPACT);
    assert_less(20, r.impacts);
    assert_less(r.energy_balance_error, 1e-3);
    for (int i = 0; i < r.n_modes; i++)
        assert_less(0, r.mode_share_pct[i]);
    assert_true(r.contact_loss_j > 0 && r.damped_core_j > 0);
    const double spent =
        r.kinetic_strain_j + r.damped_building_j + r.damped_core_j + r.contact_loss_j + r.clamp_j + r.contact_stored_j;
    assert_close(spent, r.input_energy_j, 1e-3);
}

TEST(a_mirrored_motion_mirrors_the_response_to_the_last_bit)
{
    OWNED(tower_close) Tower t;
    builtin_tower(&t);
    const SimResult there = tower_run(&t, SCENE_IMPACT);
    for (size_t i = 0; i < t.motion.n; i++)
        t.motion.accel[i] = -t.motion.accel[i];
    const SimResult mirrored = tower_run(&t, SCENE_IMPACT);
    assert_memory_equal(&there.j1_m, &mirrored.j1_m, 6 * sizeof(double));
    assert_int_equal(there.impacts, mirrored.impacts);
}

TEST(a_worker_gives_the_same_bytes_whatever_it_did_before)
{
    OWNED(tower_close) Tower t;
    builtin_tower(&t);
    SimResult first = tower_run(&t, SCENE_IMPACT);
    t.x[3] = 0.1;
    tower_run(&t, SCENE_IMPACT);
    tower_run(&t, SCENE_NO_CORE);
    t.x[3] = 0.032;
    SimResult again = tower_run(&t, SCENE_IMPACT);
    first.seconds = again.seconds = 0;
    assert_memory_equal(&first, &again, sizeof first);
}

TEST(motion_that_is_not_a_number_fails_the_run_and_says_so)
{
    OWNED(tower_close) Tower t;
    builtin_tower(&t);
    t.motion.accel[40] = NAN;
    const SimResult r = tower_run(&t, SCENE_IMPACT);
    assert_int_not_equal(r.outcome, RUN_OK);
    assert_true(r.reason[0]);
}

TEST(a_negative_gap_is_no_design)
{
    OWNED(tower_close) Tower t;
    SimResult r;
    builtin_tower(&t);
    t.x[4] = -0.001;
    assert_refused(sim_run(t.worker, SCENE_IMPACT, t.x, &r, &err), STATUS_BAD_DATA, "gap_05_m");
}

SUITE(NULL, NULL)
