/* The core on the ground (scene/foundation.h): closed forms of rigid bodies on springs, the uncondensed beam with its
 * dashpots, the reference run of the rocking core, and every command that knows of it. */
#include "check.h"

#include <lapacke.h>

#include "base/linalg.h"
#include "base/units.h"
#include "scene/foundation.h"
#include "scene_options.h"
#include "settings/settings.h"
#include "sim/engine.h"
#include "sim/sim.h"

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
    Scenario w = {0};
    SimWorker *worker;
    SimResult r;
    Settings s;
    SceneOptions options = *o;
    double x[N + 2] = {[N] = 0.03, [N + 1] = 0.0216};
    for (int j = 0; j < N; j++)
        x[j] = gap * (j + 1);
    settings_defaults(&s);
    snprintf(s.motion.record, sizeof s.motion.record, "%s", record);
    s.motion.pga_g = 0.3;
    s.motion.stretch = 3;
    options.sim.duration_s = duration_s;
    options.sim.forces = FORCES_YES;
    CHECK_OK(scenario_of(&w, &options, &s.motion, &err), &err);
    CHECK_OK(sim_worker_create(&worker, w.scene, &err), &err);
    CHECK_OK(sim_run(worker, kind, x, &r, &err), &err);
    assert_int_equal(r.outcome, RUN_OK);
    sim_worker_free(worker);
    scenario_close(&w);
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
    if (access(record, R_OK) != 0) {
        print_message("skipped: there are no records in ../shared/records\n");
        return;
    }
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
        Err err = {0};
        SceneOptions s = on_ground(CASES[i].foundation);
        s.design.thickness_m.at[1] = 0.03;
        const Status status = scene_create(&scene, &s, NULL, &err);
        assert_int_equal(status, CASES[i].is_refused ? STATUS_BAD_DATA : STATUS_OK);
        assert_true(!CASES[i].is_refused || strstr(err.text, "core.foundation: omega C / K of its dashpots is "));
        if (status == STATUS_OK)
            scene_free(scene);
    }
}

TEST(what_is_no_foundation_is_refused_in_words)
{
    static const struct {
        const char *text, *words;
    } BAD[] = {{"", "nothing gives way"},
               {"radius=10", "nothing gives way"},
               {"soil=E radius=10", "no capital letter from A to D"},
               {"soil=c radius=10", "no capital letter from A to D"},
               {"soil=C", "needs radius="},
               {"soil=C g=1e8 radius=10", "leave one out"},
               {"soil=C radius=10 nu=0.6", "'nu=0.6' is no number from 0.001 to 0.5"},
               {"rotation=-1", "is no number from 10000 to"},
               {"rotation=1e9 rotation=2e9", "stands twice"},
               {"rotation=1e9 translation_dashpot=1e6", "needs the spring beside it"},
               {"depth=3", "'depth=3' is none of soil=A..D g="}};
    for (size_t i = 0; i < sizeof BAD / sizeof BAD[0]; i++) {
        Foundation f;
        Err err = {0};
        assert_int_equal(foundation_parse(BAD[i].text, 1, &f, &err), STATUS_BAD_DATA);
        if (strncmp(err.text, "core.foundation: ", 17) != 0 || !strstr(err.text, BAD[i].words))
            print_error("%s: %s\n", BAD[i].text, err.text);
        assert_non_null(strstr(err.text, BAD[i].words));
    }
}

SUITE(NULL, NULL)
