/* The engines that others are judged by: CVODE with events, and the tied structure. */
#include "bench/stability/bob.h"

#include "sim/joined.h"
#include "scene_options.h"

typedef struct {
    SceneOptions s;
    Building b;
    CoreBeam core;
    SimModel model;
    double gaps[FLOORS_MAX];
} Stage;

/* Gap_j = gap j, the Guyan frame, the paper's Table 1 core. */
static void stage_set(Stage *stage, double gap)
{
    memset(stage, 0, sizeof *stage);
    stage->s = paper_scene();
    stage->s.core.section = CORE_EFFECTIVE;
    CHECK_OK(load_model(&stage->b, "guyan", &err), &err);
    CHECK_OK(make_core_of(&stage->core, &stage->s, stage->b.n, 1, 1, &err), &err);
    for (int j = 0; j < stage->b.n; j++)
        stage->gaps[j] = gap * (j + 1);
    CHECK_OK(model_create(&stage->model, stage->b.n, stage->b.model.n, &err), &err);
    CHECK_OK(model_set(&stage->model, &stage->s, &stage->b, &stage->core, stage->gaps, &err), &err);
}

static void stage_without_core(Stage *stage)
{
    stage_set(stage, 0);
    CHECK_OK(model_set(&stage->model, &stage->s, &stage->b, NULL, NULL, &err), &err);
}

static void stage_free(Stage *stage)
{
    model_free(&stage->model);
    building_free(&stage->b);
}

/* 3 s of two sines, sampled every 50 ms; the last sample is not zero. */
enum { SINES_N = 61 };
static Motion sines(double accel[SINES_N], double scale)
{
    Motion m = {.accel = accel, .n = SINES_N, .dt_s = 0.05};
    for (int k = 0; k < SINES_N; k++)
        accel[k] = scale * (3 * sin(2.5 * m.dt_s * k) + 2 * sin(8.2 * m.dt_s * k));
    return m;
}

static SimResult run_cvode(const Stage *stage, const Motion *m, double duration, Accuracy accuracy)
{
    SimResult r;
    CHECK_OK(engine_cvode(&stage->model, m, &(EngineOptions){.duration = duration, .accuracy = accuracy}, &r, &err),
             &err);
    return r;
}

static SimResult run_tied(const Stage *stage, const Motion *m, double duration, Accuracy accuracy)
{
    SimResult r;
    OWNED(joined_free) Joined both;
    OWNED(model_free) SimModel model;
    CHECK_OK(joined_make(&both, &stage->b, &stage->core, &err), &err);
    CHECK_OK(model_create(&model, stage->b.n, stage->b.model.n, &err), &err);
    CHECK_OK(model_set(&model, &stage->s, &both.building, NULL, NULL, &err), &err);
    CHECK_OK(engine_fast(&model, m, &(EngineOptions){.duration = duration, .accuracy = accuracy}, &r, &err), &err);
    joined_book(&both, &r);
    return r;
}

/* One free mass, one free core mass at rest. A triangular pulse of 2 s brings the mass to 1 m/s and 1 m; it has passed
 * the remaining half metre and closes the gap at t = 2.5 s. The core does not feel the ground (gamma = 0). */
static const double IMPACT_AT = 2.5, MASS = 1e5, CORE_MASS = 3e5, REDUCED = 0.75e5;

static SimResult single_impact(double a, double duration)
{
    OWNED(model_free) SimModel model;
    SimResult r;
    double pulse[] = {0, -1, 0};
    const Motion m = {.accel = pulse, .n = 3, .dt_s = 1};
    bobs_model(&model, 1, &(Bob){.mass = MASS, .gap = 1.5}, CORE_MASS,
               &(Contact){.k = 4.8650e10, .a = a, .v0_floor = 1e-3});
    CHECK_OK(engine_cvode(&model, &m, &(EngineOptions){.duration = duration, .accuracy = ACCURACY_FINE}, &r, &err),
             &err);
    assert_ran(&r);
    return r;
}

/* Hertz: p_max = (5 m v^2 / 4 k)^0.4, duration 2.943275184 p_max / v; with r = 0.7 0.902920 and 1.03332 times that. */
TEST(an_isolated_impact_is_as_deep_and_as_long_as_hertz_says)
{
    const struct {
        double a, depth, length, tolerance;
    } law[] = {{0, 1, 1, 1e-6}, {0.45, 0.902920, 1.03332, 1e-5}};
    const double depth = pow(1.25 * REDUCED / 4.8650e10, 0.4), length = 2.943275184 * depth;
    for (int i = 0; i < 2; i++) {
        const double end = law[i].length * length, margin = end * law[i].tolerance;
        const SimResult before = single_impact(law[i].a, IMPACT_AT + end - margin);
        const SimResult after = single_impact(law[i].a, IMPACT_AT + end + margin);
        assert_close(after.indentation_max_m, law[i].depth * depth, law[i].tolerance);
        assert_less(0, before.contact_stored_j);
        assert_same_number(after.contact_stored_j, 0);
    }
}

TEST(finer_tolerances_come_nearer_to_the_finest)
{
    OWNED(stage_free) Stage stage;
    double accel[SINES_N];
    const Motion m = sines(accel, 1);
    stage_set(&stage, 0.002);
    const SimResult fine = run_cvode(&stage, &m, 0.8, ACCURACY_FINE);
    const SimResult standard = run_cvode(&stage, &m, 0.8, ACCURACY_STANDARD);
    const SimResult coarse = run_cvode(&stage, &m, 0.8, ACCURACY_COARSE);
    assert_less(5, fine.impacts);
    assert_less(fine.energy_balance_error, 1e-7);
    assert_close_in(standard, fine, 1e-5, j3_g, edcs_pct);
    assert_close_in(coarse, fine, 1e-3, j3_g, edcs_pct);
}

TEST(no_shaking_is_no_response)
{
    OWNED(stage_free) Stage stage;
    double accel[SINES_N];
    const Motion m = sines(accel, 0);
    stage_set(&stage, 0.01);
    const SimResult r = run_cvode(&stage, &m, 1, ACCURACY_STANDARD), t = run_tied(&stage, &m, 1, ACCURACY_STANDARD);
    assert_ran(&r);
    assert_ran(&t);
    assert_true(r.j1_m == 0 && r.j3_g == 0 && isnan(r.ed1_pct) && r.energy_balance_error == 0);
    assert_true(t.j1_m == 0 && t.j3_g == 0 && isnan(t.ed1_pct) && t.energy_balance_error == 0);
}

TEST(a_motion_with_nan_is_a_failed_outcome)
{
    OWNED(stage_free) Stage stage;
    double accel[SINES_N];
    const Motion m = sines(accel, 1);
    accel[7] = NAN;
    stage_set(&stage, 0.002);
    const SimResult r = run_cvode(&stage, &m, 3, ACCURACY_STANDARD), t = run_tied(&stage, &m, 3, ACCURACY_STANDARD);
    assert_int_equal(r.outcome, RUN_NOT_FINITE);
    assert_int_equal(t.outcome, RUN_NOT_FINITE);
    assert_true(r.reason[0]);
}

enum { N = 20, PARTS = 100 };

typedef struct {
    double q, v;
} Oscillator;

/* The modes of K + Kc, M + Mc without damping, and the peaks of their sum. */
typedef struct {
    double omega[N], phi[N * N], gamma[N];
    Oscillator mode[N];
    double j1, j2, j3;
} Pair;

static void pair_set(Pair *pair, const Stage *stage)
{
    static double K[N * N], M[N * N];
    memset(pair, 0, sizeof *pair);
    for (int i = 0; i < N * N; i++) {
        K[i] = stage->b.K[i] + stage->core.K[i];
        M[i] = stage->b.M[i] + stage->core.M[i];
    }
    CHECK_OK(linalg_modes(N, K, M, pair->omega, pair->phi, &err), &err);
    for (int i = 0; i < N; i++)
        for (int j = 0; j < N; j++)
            for (int k = 0; k < N; k++)
                pair->gamma[i] += pair->phi[j * N + i] * M[j * N + k];
}

/* q'' + w^2 q = -gamma (a + slope t): a free oscillation about the line -gamma (a + slope t) / w^2. */
static Oscillator swing(Oscillator o, double w, double gamma, double a, double slope, double t)
{
    const double line = -gamma / (w * w), x = o.q - line * a, v = o.v - line * slope;
    const double c = cos(w * t), s = sin(w * t);
    return (Oscillator){x * c + v / w * s + line * (a + slope * t), v * c - w * x * s + line * slope};
}

/* Absolute acceleration: sum phi (q'' + gamma a) = -sum phi w^2 q. */
static void pair_note_peaks(Pair *pair, const Oscillator mode[N])
{
    double below = 0;
    for (int j = 0; j < N; j++) {
        double u = 0, absolute = 0;
        for (int i = 0; i < N; i++) {
            u += pair->phi[j * N + i] * mode[i].q;
            absolute -= pair->phi[j * N + i] * pair->omega[i] * pair->omega[i] * mode[i].q;
        }
        pair->j1 = fmax(pair->j1, fabs(u));
        pair->j2 = fmax(pair->j2, fabs(u - below));
        pair->j3 = fmax(pair->j3, fabs(absolute) / 9.81);
        below = u;
    }
}

static void pair_shake(Pair *pair, const Motion *m)
{
    for (size_t k = 0; k + 1 < m->n; k++) {
        const double a = m->accel[k], slope = (m->accel[k + 1] - a) / m->dt_s;
        Oscillator now[N];
        for (int part = 1; part <= PARTS; part++) {
            for (int i = 0; i < N; i++)
                now[i] = swing(pair->mode[i], pair->omega[i], pair->gamma[i], a, slope, m->dt_s * part / PARTS);
            pair_note_peaks(pair, now);
        }
        memcpy(pair->mode, now, sizeof now);
    }
}

TEST(without_damping_the_tied_pair_is_a_sum_of_closed_forms)
{
    OWNED(stage_free) Stage stage;
    Pair pair;
    double accel[SINES_N], energy = 0;
    const Motion m = sines(accel, 1);
    stage_set(&stage, 0);
    stage.s.building.damping.at[0] = 0;
    CHECK_OK(building_damp(&stage.b, &stage.s.building, &(Err){0}), &(Err){0});
    pair_set(&pair, &stage);
    pair_shake(&pair, &m);
    for (int i = 0; i < N; i++)
        energy += 0.5 * (pow(pair.mode[i].v, 2) + pow(pair.omega[i] * pair.mode[i].q, 2));
    const SimResult r = run_tied(&stage, &m, 3, ACCURACY_FINE);
    assert_ran(&r);
    assert_close(r.j1_m, pair.j1, 1e-5);
    assert_close(r.j2_m, pair.j2, 1e-5);
    assert_close(r.j3_g, pair.j3, 1e-5);
    assert_close(r.kinetic_strain_j, energy, 1e-9);
    assert_close(r.input_energy_j, energy, 1e-8);
    assert_less(fabs(r.damped_building_j) + fabs(r.damped_core_j), 1e-9 * energy);
}

TEST(the_books_of_the_tied_pair_close)
{
    OWNED(stage_free) Stage stage;
    double accel[SINES_N];
    const Motion m = sines(accel, 1);
    stage_set(&stage, 0);
    const SimResult fine = run_tied(&stage, &m, 2.345, ACCURACY_FINE);
    const SimResult coarse = run_tied(&stage, &m, 2.345, ACCURACY_COARSE);
    assert_ran(&fine);
    assert_true(fine.energy_balance_error < 1e-8 && coarse.energy_balance_error < 1e-6);
    assert_less(1, fine.edcs_pct);
    assert_close(coarse.kinetic_strain_j, fine.kinetic_strain_j, 1e-10);
    assert_close(coarse.j3_g, fine.j3_g, 1e-3);
    assert_close(coarse.edcs_pct, fine.edcs_pct, 1e-6);
}

/* A core of next to no stiffness and mass leaves the bare building; cut short between samples, and run past the end. */
TEST(tied_to_next_to_nothing_the_building_is_the_bare_one)
{
    OWNED(stage_free) Stage stage;
    double accel[SINES_N];
    const Motion m = sines(accel, 1);
    stage_without_core(&stage);
    stage.s.core.areas_m2 = stage.s.core.inertias_m4 = LIST_OF(1e-9);
    CHECK_OK(make_core_of(&stage.core, &stage.s, stage.b.n, 1, 1, &err), &err);
    FOR_EACH (double, duration, 1.234, 3, 4.321) {
        const SimResult t = run_tied(&stage, &m, *duration, ACCURACY_FINE);
        const SimResult r = run_cvode(&stage, &m, *duration, ACCURACY_FINE);
        assert_ran(&t);
        assert_ran(&r);
        assert_close(t.j1_m, r.j1_m, 1e-7);
        assert_close(t.j2_m, r.j2_m, 1e-6);
        assert_close(t.j3_g, r.j3_g, 1e-5);
        assert_close_in(t, r, 1e-7, kinetic_strain_j, input_energy_j);
        for (int k = 0; k < 10; k++)
            assert_close(t.mode_share_pct[k], r.mode_share_pct[k], 1e-5);
    }
}

SUITE(NULL, NULL)
