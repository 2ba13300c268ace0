/* The core on the ground (scene/foundation.h): closed forms of rigid bodies on springs, the uncondensed beam with its
 * dashpots, the reference run of the rocking core, and every command that knows of it. */
#include <lapacke.h>

#include "scene/foundation.h"
#include "scene_options.h"

enum { N = 20 };

static Foundation parsed(const char *text)
{
    Foundation f;
    CHECK_OK(foundation_parse(text, 1, &f, &err), &err);
    return f;
}

static SceneOptions on_ground(const char *foundation)
{
    SceneOptions s = paper_scene();
    snprintf(s.core.foundation, sizeof s.core.foundation, "%s", foundation);
    return s;
}

static void make(CoreBeam *core, const SceneOptions *s)
{
    CHECK_OK(make_core_of(core, s, N, 0.03, 0.0216, &err), &err);
}

/* A core that does not bend: only its foundation moves. Stiffer, the rounding of K would show. */
static void make_rigid(CoreBeam *core, const char *foundation)
{
    SceneOptions s = on_ground(foundation);
    s.core.youngs_modulus_pa *= 300;
    s.building.heights_m = LIST_OF(4);
    CHECK_OK(make_core_of(core, &s, N, 0.02, 0.02, &err), &err);
}

static const double HEIGHT = 80;

TEST(a_rigid_block_on_a_rotational_spring_rocks_as_a_pendulum_upside_down)
{
    CoreBeam core;
    make_rigid(&core, "rotation=1e9");
    assert_close(core.omega[0], sqrt(3 * 1e9 / (core.mass_kg * HEIGHT * HEIGHT)), 2e-5);
    double turned = 0;
    for (int j = 0; j < N; j++) /* the base of a rigid rotation by 1 rad */
        turned += core.base_rotation[j] * HEIGHT * (j + 1) / N;
    assert_less(fabs(turned - 1), 1e-3); /* of a motion that is nearly rigid */
    assert_same_number(core.base_translation[0], 0);
}

TEST(a_rigid_block_on_a_translation_spring_is_a_mass_on_a_spring)
{
    CoreBeam core;
    make_rigid(&core, "translation=1e6");
    assert_close(core.omega[0], sqrt(1e6 / core.mass_kg), 2e-5);
    assert_close(core.gamma[0] * core.gamma[0], core.mass_kg, 1e-6); /* all of it is moved */
}

/* [k_x 0; 0 k_t] - w^2 m [1 h/2; h/2 h^2/3] of translation and rotation of the base. */
TEST(a_rigid_block_on_both_springs_has_the_two_frequencies_of_the_closed_form)
{
    CoreBeam core;
    make_rigid(&core, "rotation=1e9 translation=1e6");
    const double m = core.mass_kg, kx = 1e6, kt = 1e9, h = HEIGHT;
    const double a = m * m * h * h / 12, b = m * (kt + kx * h * h / 3), c = kx * kt, root = sqrt(b * b - 4 * a * c);
    assert_close(core.omega[0], sqrt((b - root) / (2 * a)), 2e-5);
    assert_close(core.omega[1], sqrt((b + root) / (2 * a)), 1e-4);
}

TEST(on_a_stiffer_and_stiffer_ground_the_core_becomes_the_clamped_one)
{
    CoreBeam clamped, soft, stiff;
    SceneOptions s = on_ground("fixed");
    make(&clamped, &s);
    for (int decade = 0; decade < 2; decade++) {
        const char *const TEXT[2][2] = {{"rotation=1e14", "rotation=1e15"}, {"translation=1e12", "translation=1e13"}};
        s = on_ground(TEXT[decade][0]);
        make(&soft, &s);
        s = on_ground(TEXT[decade][1]);
        make(&stiff, &s);
        for (int i = 0; i < 4; i++) { /* first order in the flexibility */
            const double off = clamped.omega[i] - soft.omega[i], less = clamped.omega[i] - stiff.omega[i];
            assert_true(off > 0 && off < 0.04 * clamped.omega[i]);
            assert_less(fabs(off / less - 10), 0.5);
        }
    }
}

TEST(the_factor_is_that_of_the_springs_and_its_root_that_of_the_dashpots)
{
    Foundation f, twice;
    f = parsed("soil=C radius=10");
    CHECK_OK(foundation_parse("soil=C radius=10", 2, &twice, &err), &err);
    assert_close(twice.rotation, 2 * f.rotation, 1e-14);
    assert_close(twice.translation, 2 * f.translation, 1e-14);
    assert_close(twice.rotation_dashpot, sqrt(2) * f.rotation_dashpot, 1e-14);
    assert_close(twice.cone_s, f.cone_s / sqrt(2), 1e-14);
}

/* The cones have the disc's static stiffness: rho c^2 A / z and 3 rho c^2 I / z, of the apex distances z = pi/8 (2 - nu)
 * (c = v_s) and z = cone_s c; the dashpots are rho c A and, at high frequencies, rho c I. */
TEST(springs_and_dashpots_of_the_disc_are_those_of_one_cone)
{
    const char *const TEXT[] = {"g=1e8 radius=10", "g=3e8 radius=6 nu=0.25 density=1800", "g=1e7 radius=4 nu=0.45"};
    const double G[] = {1e8, 3e8, 1e7}, R[] = {10, 6, 4}, NU[] = {0.3, 0.25, 0.45}, RHO[] = {2000, 1800, 2000};
    for (int i = 0; i < 3; i++) {
        const Foundation f = parsed(TEXT[i]);
        const double r = R[i], A = M_PI * r * r, inertia = A * r * r / 4, v_s = sqrt(G[i] / RHO[i]);
        const double c = f.rotation_dashpot / (RHO[i] * inertia), z = f.cone_s * c;
        assert_close(f.rotation, 8 * G[i] * r * r * r / (3 * (1 - NU[i])), 1e-12);
        assert_close(f.rotation, 3 * RHO[i] * c * c * inertia / z, 1e-12);
        assert_close(f.translation, RHO[i] * v_s * v_s * A / (M_PI / 8 * (2 - NU[i]) * r), 1e-12);
        assert_close(f.translation_dashpot, RHO[i] * v_s * A, 1e-12);
        assert_true(c > v_s && c <= 2 * v_s * (1 + 1e-12));
        assert_close(foundation_rotation_dashpot(&f, 1e9), f.rotation_dashpot, 1e-6);
        assert_close(foundation_rotation_dashpot(&f, c / z), 0.5 * f.rotation_dashpot, 1e-12);
    }
}

TEST(softer_classes_of_soil_are_softer)
{
    const char *const TEXT[] = {"soil=A radius=10", "soil=B radius=10", "soil=C radius=10", "soil=D radius=10"};
    for (int i = 1; i < 4; i++) {
        assert_less(parsed(TEXT[i]).rotation, parsed(TEXT[i - 1]).rotation);
        assert_less(parsed(TEXT[i]).translation_dashpot, parsed(TEXT[i - 1]).translation_dashpot);
    }
    const double G = parsed(TEXT[2]).translation * 1.7 / 80;
    assert_true(G > 3e8 && G < 5e8); /* [Pa] stiff soil or soft rock under strong shaking */
}

/* ---- dashpots ---------------------------------------------------------------------------------------------------- */

enum { WHOLE = 2 * N + 2 }; /* deflections and rotations of all nodes, the base first */

static void assemble_whole(const SceneOptions *s, const Foundation *f, double K[WHOLE][WHOLE], double M[WHOLE][WHOLE])
{
    memset(K, 0, sizeof(double[WHOLE][WHOLE]));
    memset(M, 0, sizeof(double[WHOLE][WHOLE]));
    for (int e = 0; e < N; e++) {
        double k[4][4], m[4][4];
        const CoreStorey a = core_beam_storey(&s->core, N, e, 0.03, 0.0216);
        const double E = s->core.youngs_modulus_pa;
        beam_element(&(Beam){.EI = E * a.inertia,
                             .mass_per_m = s->core.density_kg_m3 * a.area,
                             .length = list_at(&s->building.heights_m, e)},
                     k, m);
        for (int i = 0; i < 4; i++)
            for (int j = 0; j < 4; j++) {
                K[2 * e + i][2 * e + j] += k[i][j];
                M[2 * e + i][2 * e + j] += m[i][j];
            }
    }
    K[0][0] += f->translation;
    K[1][1] += f->rotation;
}

/* Frequency and damping ratio of the mode of the uncondensed, damped beam whose frequency is nearest to omega: the
 * eigenvalues of [0 1; -M^-1 K, -M^-1 C]. */
static void complex_mode(const SceneOptions *s, const Foundation *f, double omega, double *found, double *zeta)
{
    static double K[WHOLE][WHOLE], M[WHOLE][WHOLE], right[WHOLE][WHOLE + 2], A[2 * WHOLE][2 * WHOLE];
    double re[2 * WHOLE], im[2 * WHOLE];
    assemble_whole(s, f, K, M);
    memset(A, 0, sizeof A);
    memset(right, 0, sizeof right);
    for (int i = 0; i < WHOLE; i++)
        memcpy(right[i], K[i], sizeof K[i]);
    right[0][WHOLE] = f->translation_dashpot;
    right[1][WHOLE + 1] = foundation_rotation_dashpot(f, omega);
    CHECK_OK(linalg_solve_spd(WHOLE, WHOLE + 2, &M[0][0], &right[0][0], &err), &err);
    for (int i = 0; i < WHOLE; i++) {
        A[i][WHOLE + i] = 1;
        for (int j = 0; j < WHOLE; j++)
            A[WHOLE + i][j] = -right[i][j];
        A[WHOLE + i][WHOLE] = -right[i][WHOLE];
        A[WHOLE + i][WHOLE + 1] = -right[i][WHOLE + 1];
    }
    assert_int_equal(
        LAPACKE_dgeev(LAPACK_ROW_MAJOR, 'N', 'N', 2 * WHOLE, &A[0][0], 2 * WHOLE, re, im, NULL, 1, NULL, 1), 0);
    double nearest = INFINITY;
    for (int i = 0; i < 2 * WHOLE; i++) {
        const double w = hypot(re[i], im[i]);
        if (im[i] > 0 && fabs(w - omega) < nearest) {
            nearest = fabs(w - omega);
            *found = w;
            *zeta = -re[i] / w;
        }
    }
}

/* A mat of 20 m square: the disc of its area. The first mode carries the response. In the second the dashpots hold the
 * base, which the sum over modes does not know: its frequency stays too low, and its damping on the safe side. */
TEST(dashpots_by_modes_are_near_the_complex_modes_of_the_whole_beam)
{
    const char *const TEXT[] = {"soil=C radius=11.28", "soil=D radius=11.28", "g=1e8 radius=11.28"};
    for (int i = 0; i < 3; i++)
        for (int mode = 0; mode < 2; mode++) {
            CoreBeam core;
            SceneOptions s = on_ground(TEXT[i]);
            double w = 0, zeta = 0;
            s.core.damping = 0;
            make(&core, &s);
            complex_mode(&s, &core.base, core.omega[mode], &w, &zeta);
            const double w_share = core.omega[mode] / w, zeta_share = core.zeta[mode] / zeta;
            print_message("%s, mode %d: %.4f Hz, damping %.4f; complex %.4f Hz, %.4f\n", TEXT[i], mode + 1,
                          core.omega[mode] / (2 * M_PI), core.zeta[mode], w / (2 * M_PI), zeta);
            assert_true(w_share < 1 && w_share > (mode == 0 ? 0.997 : 0.85));
            assert_true(zeta_share < 1.001 && zeta_share > (mode == 0 ? 0.98 : 0.4));
        }
}

/* ---- whole runs -------------------------------------------------------------------------------------------------- */

static SimResult simulated(const SceneOptions *o, const char *record, double gap, double duration_s, SceneKind kind)
{
    SimResult r;
    Settings s = default_settings();
    SceneOptions options = *o;
    const int n = strstr(o->building.model, "tower") ? 6 : N;
    double x[N + 2] = {0};
    for (int j = 0; j < n; j++)
        x[j] = gap * (j + 1);
    x[n] = 0.03;
    x[n + 1] = 0.0216;
    snprintf(s.motion.record, sizeof s.motion.record, "%s", record);
    s.motion.pga_g = 0.3;
    s.motion.stretch = n == N ? 3 : 1;
    options.sim.duration_s = duration_s;
    options.sim.forces = FORCES_YES;
    CHECK_OK(run_under(&options, &s.motion, kind, x, NULL, &r, &err), &err);
    assert_ran(&r);
    return r;
}

/* Frequencies and response of an independent integrator (exponential Runge-Kutta, 1e-5 s) of the same core. */
TEST(the_core_on_a_rotational_spring_has_its_known_frequencies_and_response)
{
    static const double HZ[] = {1.83346, 11.2960, 32.0313, 63.895};
    const char *record = "../shared/records/northridge_sylmar_ns.csv";
    CoreBeam core;
    SceneOptions s = on_ground("rotation=5.5e11");
    make(&core, &s);
    for (int i = 0; i < 4; i++)
        assert_close(core.omega[i] / (2 * M_PI), HZ[i], 1e-5);
    need_file(record);
    s.sim.accuracy = ACCURACY_FINE;
    const SimResult r = simulated(&s, record, 0.008, 11, SCENE_IMPACT);
    assert_close(r.j1_m, 0.433255, 1e-3);
    assert_close(r.j2_m, 0.033516, 1e-3);
    assert_close(r.j3_g, 4.0867, 1e-2);
    assert_close(r.input_energy_j, 1.73866e6, 2e-3);
    assert_close(r.ed1_pct, 2.565, 5e-3);
    assert_close(r.edcs_pct, 1.691, 5e-3);
    assert_close(r.forces.contact_force_max_n, 7.99e6, 1e-2);
    s.building.yield_drift = 0.006;
    const SimResult both = simulated(&s, record, 0.008, 11, SCENE_IMPACT);
    assert_close(both.j1_m, 0.441140, 1e-3);
    assert_close(both.j3_g, 4.0661, 1e-2);
    assert_close(both.ductility, 1.405, 1e-2);
    assert_close(both.plastic_drift_ratio, 0.002427, 1e-2);
    assert_close(both.ed_hysteresis_pct, 1.206, 5e-3);
}

TEST(both_engines_agree_on_soft_ground_and_their_books_close)
{
    SceneOptions s = on_ground("soil=D radius=10");
    s.sim.accuracy = ACCURACY_FINE;
    const SimResult fast = simulated(&s, "builtin:sylmar-like", 0.001, 8, SCENE_IMPACT);
    s.sim.engine = ENGINE_CVODE;
    const SimResult cvode = simulated(&s, "builtin:sylmar-like", 0.001, 8, SCENE_IMPACT);
    assert_less(3, fast.impacts);
    assert_close(fast.j1_m, cvode.j1_m, 1e-4);
    assert_close(fast.forces.base_rotation_rad, cvode.forces.base_rotation_rad, 1e-3);
    assert_close(fast.forces.base_translation_m, cvode.forces.base_translation_m, 1e-2);
    assert_less(fast.energy_balance_error, 1e-6);
    assert_less(cvode.energy_balance_error, 1e-6);
}

/* What the springs carry is the base's shear and moment, and the disc lifts at W r / 3. */
TEST(the_foundation_reports_what_it_carries)
{
    const Foundation f = parsed("soil=D radius=10 weight=5e7");
    const SceneOptions s = on_ground("soil=D radius=10 weight=5e7"), clamped = on_ground("fixed");
    for (SceneKind kind = SCENE_IMPACT; kind <= SCENE_LINKS; kind++) {
        const SimResult r = simulated(&s, "builtin:sylmar-like", 0.008, 8, kind);
        const int has_core = kind != SCENE_NO_CORE && kind != SCENE_TMD;
        assert_int_equal(isfinite(r.forces.base_rotation_rad), has_core);
        if (!has_core)
            continue;
        const double moment = r.forces.core_overturning_nm, weight = 5e7 + GRAVITY * r.mcore_kg;
        assert_less(0, moment);
        assert_close(f.rotation * r.forces.base_rotation_rad, moment, 1e-12);
        assert_close(f.translation * r.forces.base_translation_m, r.forces.core_base_shear_n, 1e-12);
        assert_close(r.forces.uplift_ratio, moment / (weight * 10 / 3), 1e-12);
        assert_less(r.energy_balance_error, 1e-3);
        const SimResult stiff = simulated(&clamped, "builtin:sylmar-like", 0.008, 8, kind);
        assert_true(isnan(stiff.forces.base_rotation_rad) && isnan(stiff.forces.uplift_ratio));
        assert_true(fabs(stiff.forces.core_overturning_nm / moment - 1) > 1e-2);
    }
}

/* Floors and core as one: its stiffness is that of the core on the ground, and the ground damps. */
TEST(a_tied_core_rocks_too_and_its_dashpots_take_energy)
{
    SceneOptions s = on_ground("rotation=5.5e11");
    const SimResult springs = simulated(&s, "builtin:sylmar-like", 0.008, 10, SCENE_RIGID);
    s = on_ground("rotation=5.5e11 rotation_dashpot=1e10");
    const SimResult damped = simulated(&s, "builtin:sylmar-like", 0.008, 10, SCENE_RIGID);
    assert_less(damped.forces.core_overturning_nm, springs.forces.core_overturning_nm);
    assert_less(damped.energy_balance_error, 1e-6);
}

/* Beyond 0.3 of the springs they would change the modes, which are found without them. */
TEST(dashpots_that_are_large_beside_their_springs_are_refused_with_the_figure)
{
    static const struct {
        const char *foundation;
        int is_refused;
    } CASES[] = {{"rotation=5e11 translation=5e9 rotation_dashpot=1e11 translation_dashpot=1e9", 1},
                 {"rotation=5e11 rotation_dashpot=1e11", 1},
                 {"rotation=5e11 translation=5e9 translation_dashpot=1e9", 1},
                 {"rotation=5e11 translation=5e9 rotation_dashpot=1e10 translation_dashpot=1e8", 0},
                 {"soil=D radius=11.28", 0}};
    for (size_t i = 0; i < N_OF(CASES); i++) {
        Scene *scene;
        err = (Err){0};
        SceneOptions s = on_ground(CASES[i].foundation);
        s.design.thickness_m.at[1] = 0.03;
        const Status status = scene_create(&scene, &s, NULL, &err);
        assert_int_equal(status, CASES[i].is_refused ? STATUS_BAD_DATA : STATUS_OK);
        assert_true(!CASES[i].is_refused || strstr(err.text, "core.foundation: omega C / K of its dashpots is "));
        if (status == STATUS_OK)
            scene_free(scene);
    }
}

/* ---- a mat that lifts --------------------------------------------------------------------------------------------- */

static double spring_moment(const Uplift *u, double theta)
{
    const double x = fabs(theta) / u->theta_up;
    return x > 1 ? copysign(u->rotation * u->theta_up * (3 - 2 / sqrt(x)), theta) : u->rotation * theta;
}

/* Its energy is the integral of its force, the dashpot's law in the limit of slow motion the one without. */
TEST(the_mat_turns_as_its_moment_balances_and_its_energy_is_the_work_of_its_force)
{
    for (int kind = 0; kind < 3; kind++) {
        const double ratio = pow(10, kind - 1);
        const Uplift u = {.theta_up = 2e-4, .rotation = 5e11, .whole = 5e11 * (1 + ratio), .dashpot = 1, .cone_s = 1};
        double work = 0, before = 0;
        for (int i = 0; i <= 4000; i++) {
            const double d = i * 1e-6, g = uplift_lifted(&u, -d);
            double rate[MAT_STATES];
            assert_less(fabs(spring_moment(&u, g - d) + (u.whole - u.rotation) * (g - d) + u.whole * d),
                        1e-12 * u.whole * 4e-3);
            if (d < u.theta_up)
                assert_same_number(g, 0);
            uplift_rates(&u, -d, 0, (double[]){g, 0, 0}, rate);
            assert_less(fabs(rate[MAT_LIFTED]), 1e-11 * u.whole * 4e-3);
            work += 0.5 * (before - u.whole * g) * -1e-6 * (i > 0);
            before = -u.whole * g;
            assert_less(fabs(uplift_held(&u, -d, (double[]){g, 0, 0}) - work), 1e-5 * u.whole * 4e-3 * 4e-3);
        }
    }
}

typedef struct {
    SimWorker *worker;
    int n;
    double t[4100], top[4100];
} Rocking;

static void note_top(const SimSample *s, void *user)
{
    Rocking *r = user;
    FloorMotion m;
    sim_worker_motion(r->worker, s, &m);
    r->t[r->n] = s->t;
    r->top[r->n++] = m.core[N - 1];
}

/* 4 int_0^top dtheta / sqrt(2 (U(top) - U(theta)) / J), theta = top sin phi, by the rule of the midpoint. */
static double period(const Uplift *u, double J, double top)
{
    enum { PARTS = 2000, FINE = 40 };
    double sum = 0, U = 0, theta = top;
    for (int i = PARTS - 1; i >= 0; i--) {
        const double phi = 0.5 * M_PI * (i + 0.5) / PARTS, next = top * sin(phi), step = (theta - next) / FINE;
        for (int j = 0; j < FINE; j++)
            U += step * spring_moment(u, theta - (j + 0.5) * step);
        theta = next;
        sum += top * cos(phi) / sqrt(2 * U / J);
    }
    return 4 * sum * 0.5 * M_PI / PARTS;
}

/* After a push it neither gains nor loses, and swings as slowly as the law of its mat lets it. */
TEST(a_rigid_core_rocks_on_its_lifting_mat_with_the_period_of_the_quadrature)
{
    enum { SAMPLES = 4000 };
    static double accel[SAMPLES];
    const Motion motion = {.accel = accel, .n = SAMPLES, .dt_s = 0.02};
    SceneOptions s = on_ground("rotation=1e9 radius=10 anchors=1");
    FREED Rocking *r = calloc(1, sizeof *r);
    FREED CoreBeam *core = calloc(1, sizeof *core);
    double x[N + 2] = {[N] = 0.02, [N + 1] = 0.02}, z[N], J = 0;
    SimResult result;
    assert_true(r && core);
    for (int i = 0; i < 100; i++)
        accel[i] = 3 * pow(sin(M_PI * i / 100), 2);
    for (int j = 0; j < N; j++)
        x[j] = 50;
    s.core.youngs_modulus_pa *= 30;
    s.core.damping = 0;
    s.core.theory = CORE_EULER_BERNOULLI;
    s.sim.accuracy = ACCURACY_FINE;
    CHECK_OK(make_core_of(core, &s, N, 0.02, 0.02, &err), &err);
    OWNED(one_scene_free) OneScene stage = one_scene_of(&s, &motion);
    r->worker = stage.worker;
    sim_worker_sample(r->worker, 0, note_top, r);
    CHECK_OK(sim_run(r->worker, SCENE_IMPACT, x, &result, &err), &err);
    assert_ran(&result);
    assert_less(result.energy_balance_error, 1e-9);
    for (int i = 0; i < N; i++)
        z[i] = (i > 0 ? z[i - 1] : 0) + list_at(&s.building.heights_m, i);
    for (int i = 0; i < N; i++)
        for (int j = 0; j < N; j++)
            J += z[i] * z[j] * core->M[i * N + j];
    double passed[40], tops[40] = {0};
    int n = 0;
    for (int i = 110; i + 1 < r->n && n < 40; i++) {
        const double a = r->top[i - 1], b = r->top[i], c = r->top[i + 1];
        if (n > 0 && fabs(b) >= fabs(a) && fabs(b) > fabs(c)) /* the parabola's vertex */
            tops[n - 1] = fabs(b - 0.125 * (c - a) * (c - a) / (a + c - 2 * b));
        if (b * c < 0)
            passed[n++] = r->t[i] + 0.02 * b / (b - c);
    }
    assert_less(6, n);
    const double theta = tops[0] / z[N - 1];
    print_message("rocks to %.3g of theta_up, period %.5g s, linear %.5g\n", theta / core->uplift.theta_up,
                  passed[4] - passed[2], 2 * M_PI / core->omega[0]);
    assert_less(3, theta / core->uplift.theta_up);
    assert_close(passed[n - 1 - (n - 1) % 2] - passed[0], (n - 1) / 2 * period(&core->uplift, J, theta), 2e-3);
    for (int i = 1; i + 1 < n; i++)
        assert_close(tops[i], tops[0], 1e-3);
}

static SceneOptions small_tower(const char *foundation)
{
    SceneOptions s = on_ground(foundation);
    six_floors(&s.building, &s.core);
    s.sim.accuracy = ACCURACY_FINE;
    return s;
}

/* With the dashpot of the half-space and without one; storeys that yield beside it; by impacts and joined. */
TEST(both_engines_agree_where_the_mat_lifts_and_their_books_close)
{
    static const char *const GROUND[] = {"soil=C radius=6 anchors=1 weight=1e6", "rotation=3e11 radius=6 anchors=1.5"};
    for (int i = 0; i < 2; i++)
        for (SceneKind kind = SCENE_IMPACT; kind <= SCENE_RIGID; kind += SCENE_RIGID) {
            SceneOptions s = small_tower(GROUND[i]);
            s.building.yield_drift = 0.006;
            const SimResult fast = simulated(&s, "builtin:sylmar-like", 0.004, 8, kind);
            s.sim.engine = ENGINE_CVODE;
            const SimResult cvode = simulated(&s, "builtin:sylmar-like", 0.004, 8, kind);
            print_message("%s, %d: J1 %.6g m, uplift %.3g, rotation %.4g, impacts %ld, core %.4g %%\n", GROUND[i], kind,
                          fast.j1_m, fast.forces.uplift_ratio, fast.forces.base_rotation_rad, fast.impacts,
                          fast.edcs_pct);
            assert_less(1.2, fast.forces.uplift_ratio);
            assert_close(fast.j1_m, cvode.j1_m, 1e-5);
            assert_close_in(fast, cvode, 1e-3, j3_g, edcs_pct);
            assert_close(fast.forces.base_rotation_rad, cvode.forces.base_rotation_rad, 1e-4);
            assert_close(fast.forces.core_overturning_nm, cvode.forces.core_overturning_nm, 1e-3);
            assert_less(fast.energy_balance_error, 1e-6);
            assert_less(cvode.energy_balance_error, 1e-6);
        }
}

TEST(anchors_that_hold_everything_leave_the_springs)
{
    for (SceneKind kind = SCENE_IMPACT; kind <= SCENE_RIGID; kind += SCENE_RIGID) {
        SceneOptions s = small_tower("soil=C radius=6");
        const SimResult springs = simulated(&s, "builtin:sylmar-like", 0.004, 6, kind);
        s = small_tower("soil=C radius=6 anchors=1e9");
        const SimResult held = simulated(&s, "builtin:sylmar-like", 0.004, 6, kind);
        assert_close(held.j1_m, springs.j1_m, 1e-7);
        assert_close(held.j3_g, springs.j3_g, 1e-4);
        assert_close(held.edcs_pct, springs.edcs_pct, 1e-5);
        assert_close(held.forces.base_rotation_rad, springs.forces.base_rotation_rad, 1e-3);
    }
}

/* A design of configs/engineer.ini under Kobe (0.3 g, stretch 3.1), on ground of its own, as another engine has it. */
static SimResult known_design(const char *anchors, double wall, Engine engine, SceneKind kind, double duration_s)
{
    SimResult r;
    Settings s;
    CHECK_OK(known_settings(&s, anchors, &err), &err);
    s.core.wall_factor = wall;
    s.sim.engine = engine;
    s.sim.duration_s = duration_s;
    const SceneOptions options = settings_scene(&s);
    const LinearDevice links = {.link_ns_m = 0.9e6};
    CHECK_OK(run_under(&options, &s.motion, kind, KNOWN_DESIGN, &links, &r, &err), &err);
    assert_ran(&r);
    return r;
}

/* By an independent integrator: stops and links, a mat that lifts, that anchors hold, that never lifts, half the core's
 * stiffness. Peaks come within 36 s; of mats that hardly lift within 80 s, where CVODE takes too long for a test. */
TEST(a_mat_that_lifts_and_a_weaker_core_have_their_known_response)
{
    static const struct {
        const char *anchors;
        double wall, j1, drift, j3, seconds;
        SceneKind kind;
    } CASES[] = {{" anchors=1", 0, 1.787, 0.0294, 1.49, 36, SCENE_IMPACT},
                 {" anchors=inf", 0.5, 1.083, 0.0300, 1.31, 36, SCENE_IMPACT},
                 {" anchors=1", 0, 1.140, 0.0200, 0.44, 36, SCENE_LINKS},
                 {" anchors=5", 0, 0.665, 0.0213, 1.31, 80, SCENE_IMPACT},
                 {" anchors=inf", 0, 0.655, 0.0212, 1.25, 80, SCENE_IMPACT},
                 {"", 0, 0.655, 0.0212, 1.25, 80, SCENE_IMPACT},
                 {" anchors=5", 0, 0.525, 0.0098, 0.45, 80, SCENE_LINKS},
                 {" anchors=inf", 0, 0.524, 0.0098, 0.45, 80, SCENE_LINKS},
                 {" anchors=inf", 0.5, 0.818, 0.0142, 0.57, 80, SCENE_LINKS}};
    need_file(KOBE);
    for (size_t i = 0; i < N_OF(CASES); i++)
        for (Engine engine = ENGINE_FAST; engine <= (CASES[i].seconds < 80 ? ENGINE_CVODE : ENGINE_FAST); engine++) {
            const SimResult r = known_design(CASES[i].anchors, CASES[i].wall, engine, CASES[i].kind, CASES[i].seconds);
            print_message("%s, wall %g, scene %d, engine %d: J1 %.4g m, drift %.4g, J3 %.4g g\n", CASES[i].anchors,
                          CASES[i].wall, CASES[i].kind, engine, r.j1_m, r.drift_ratio_max, r.j3_g);
            assert_close(r.j1_m, CASES[i].j1, 1e-2);
            assert_close(r.drift_ratio_max, CASES[i].drift, 1e-2);
            assert_close(r.j3_g, CASES[i].j3, 3e-2);
        }
}

/* What a user writes; what a stored run says means what it meant. */
TEST(weight_alone_holds_a_mat_of_which_nothing_else_is_said)
{
    static const struct {
        const char *given, *meant;
    } CASES[] = {{"soil=C radius=10", "soil=C radius=10 anchors=1"},
                 {"rotation=1e11 radius=10", "rotation=1e11 radius=10 anchors=1"},
                 {"soil=C radius=10 anchors=inf", "soil=C radius=10 anchors=inf"},
                 {"soil=C radius=10 anchors=7", "soil=C radius=10 anchors=7"},
                 {"translation=1e9 radius=10", "translation=1e9 radius=10"},
                 {"rotation=1e11", "rotation=1e11"},
                 {"fixed", "fixed"}};
    for (size_t i = 0; i < N_OF(CASES); i++) {
        Settings put, stored;
        settings_defaults(&put);
        settings_defaults(&stored);
        CHECK_OK(settings_put(&put, "core.foundation", CASES[i].given, &err), &err);
        assert_string_equal(put.core.foundation, CASES[i].meant);
        CHECK_OK(settings_put(&put, "core.width_m", "10", &err), &err);
        assert_string_equal(put.core.foundation, CASES[i].meant);
        CHECK_OK(settings_parse(&stored, "run.sqlite", brief("[core]\nfoundation = %s\n", CASES[i].given), &err), &err);
        assert_string_equal(stored.core.foundation, CASES[i].given);
    }
    assert_same_number(parsed("soil=C radius=10").anchors, 0);
    assert_same_number(parsed("soil=C radius=10 anchors=inf").anchors, 0);
}

TEST(what_is_no_foundation_is_refused_in_words)
{
    static const struct {
        const char *text, *words;
    } BAD[] = {{"", "nothing gives way"},
               {"radius=10", "nothing gives way"},
               {"soil=E radius=10", "no capital letter from A to D"},
               {"soil=C, radius=5,5", "'5' is none of soil=A..D g="},
               {"soil=C", "needs radius="},
               {"soil=C g=1e8 radius=10", "leave one out"},
               {"soil=C radius=10 nu=0.6", "'nu=0.6' is no number from 0.001 to 0.5"},
               {"rotation=-1", "is no number from 10000 to"},
               {"rotation=1e9 rotation=2e9", "stands twice"},
               {"rotation=1e9 translation_dashpot=1e6", "needs the spring beside it"},
               {"soil=C radius=10 anchors=0.5", "'anchors=0.5' is no number from 1 to"},
               {"rotation=1e9 anchors=1", "anchors= needs radius="},
               {"translation=1e9 radius=10 anchors=1", "a spring against rotation"},
               {"depth=3", "'depth=3' is none of soil=A..D g="}};
    for (size_t i = 0; i < sizeof BAD / sizeof BAD[0]; i++) {
        Foundation f;
        err = (Err){0};
        assert_int_equal(foundation_parse(BAD[i].text, 1, &f, &err), STATUS_BAD_DATA);
        assert_words(err.text, "core.foundation: ", BAD[i].words);
    }
}

SUITE(NULL, NULL)
