/* The scene against printed numbers and closed forms: buildings, core beam, modes, contact laws, modal flow. */
#include "scene/core_beam.h"
#include "sim/contact.h"
#include "sim/flow.h"
#include "scene_options.h"

static void make_core(CoreBeam *core, CoreSection section, double t_base, double t_top)
{
    SceneOptions s = paper_scene();
    s.core.section = section;
    CHECK_OK(make_core_of(core, &s, 20, t_base, t_top, &err), &err);
}

static void assert_hz(const double hz[], const double wanted[], int n, double tolerance_hz)
{
    for (int i = 0; i < n; i++)
        if (!(fabs(hz[i] - wanted[i]) <= tolerance_hz))
            fail_msg("mode %d: %.5f Hz, wanted %.5f", i + 1, hz[i], wanted[i]);
}

static SceneModes modes_of(const char *model, CoreSection section)
{
    SceneModes modes;
    SceneOptions s = paper_scene();
    Scene *scene;
    double x[22] = {[20] = 0.012, [21] = 0.0064};
    snprintf(s.building.model, sizeof s.building.model, "%s", model);
    s.core.section = section;
    CHECK_OK(scene_create(&scene, &s, NULL, &err), &err);
    CHECK_OK(scene_frequencies(scene, x, &modes, &err), &err);
    scene_free(scene);
    return modes;
}

TEST(the_effective_core_has_the_frequencies_of_table_1)
{
    const double core_wanted[] = {2.29, 13.22, 36.19, 70.49, 116.25, 173.48, 242.24, 322.65, 414.91, 519.39};
    const double zero_gap_wanted[] = {0.75, 4.29, 11.82, 23.08, 38.12, 56.95, 79.55, 105.94, 136.07, 169.91};
    const SceneModes modes = modes_of("appendix", CORE_EFFECTIVE);
    assert_hz(modes.core_hz, core_wanted, 10, 0.006);
    assert_hz(modes.joined_hz, zero_gap_wanted, 10, 0.006);
    assert_close(modes.core_mass_kg, 7.584e5, 1e-3);
}

/* Twenty numbers from the first to the last. */
static NumberList list_of(double first, double last)
{
    NumberList list = {.n = 20};
    for (int j = 0; j < 20; j++)
        list.at[j] = first + (last - first) * j / 19;
    return list;
}

TEST(an_effective_core_may_be_given_storey_by_storey)
{
    CoreBeam linear, listed;
    SceneOptions s = paper_scene();
    s.core.section = CORE_EFFECTIVE;
    CHECK_OK(make_core_of(&linear, &s, 20, 1, 1, &err), &err);
    s.core.areas_m2 = list_of(s.core.areas_m2.at[0], s.core.areas_m2.at[1]);
    s.core.inertias_m4 = list_of(s.core.inertias_m4.at[0], s.core.inertias_m4.at[1]);
    CHECK_OK(make_core_of(&listed, &s, 20, 1, 1, &err), &err);
    assert_close(listed.mass_kg, linear.mass_kg, 1e-8);
    for (int i = 0; i < 20; i++)
        assert_close(listed.omega[i], linear.omega[i], 1e-8);
    s.core.masses_kg = LIST_OF(2000, 1000);
    CHECK_OK(make_core_of(&listed, &s, 20, 1, 1, &err), &err);
    assert_close(listed.mass_kg, 20 * 1500, 1e-9);
    assert_true(make_core_of(&listed, &s, 19, 1, 1, &err) != STATUS_OK);
    assert_non_null(strstr(err.text, "core.areas_m2: has 20 values; the building has 19 storeys"));
}

TEST(both_buildings_have_their_known_frequencies)
{
    const double guyan[] = {0.2643, 0.7599, 1.3113, 1.8448, 2.4209};
    const double appendix[] = {0.2729, 0.7800, 1.3388, 1.8946, 2.4977};
    const SceneModes modes = modes_of("guyan", CORE_BOX), others = modes_of("appendix", CORE_BOX);
    for (int i = 0; i < 5; i++) {
        assert_close(modes.building_hz[i], guyan[i], 1e-3);
        assert_close(others.building_hz[i], appendix[i], 1e-3);
    }
}

TEST(the_box_core_has_its_known_mass_and_frequencies)
{
    const double wanted[] = {2.492, 13.64, 36.69, 71.11, 117.0};
    const SceneModes modes = modes_of("guyan", CORE_BOX);
    assert_close(modes.core_mass_kg, 2.650e5, 1e-3);
    for (int i = 0; i < 5; i++)
        assert_close(modes.core_hz[i], wanted[i], 1e-3);
}

TEST(a_uniform_core_is_a_textbook_cantilever)
{
    CoreBeam core;
    SceneOptions s = paper_scene();
    s.core.section = CORE_PLATE;
    s.building.heights_m = LIST_OF(4);
    CHECK_OK(make_core_of(&core, &s, 20, 0.5, 0.5, &err), &err);
    const double L = 80, EI = s.core.youngs_modulus_pa * s.core.width_m * pow(0.5, 3) / 12;
    const double m = s.core.density_kg_m3 * s.core.width_m * 0.5;
    const double beta_l[] = {1.875104069, 4.694091133, 7.854757438}; /* cos x cosh x = -1 */
    for (int i = 0; i < 3; i++)
        assert_close(core.omega[i], pow(beta_l[i] / L, 2) * sqrt(EI / m), 1e-4);
    assert_close(core.mass_kg, m * L, 1e-12);
}

TEST(stiffness_of_the_plate_goes_with_thickness_cubed)
{
    CoreBeam thin, thick;
    make_core(&thin, CORE_PLATE, 0.01, 0.005);
    make_core(&thick, CORE_PLATE, 0.02, 0.01);
    for (int i = 0; i < 400; i++)
        assert_close(thick.K[i], 8 * thin.K[i], 1e-6);
    assert_close(thick.mass_kg, 2 * thin.mass_kg, 1e-12);
}

/* ---- the core's shear deformation ------------------------------------------------------------------------------ */

/* n storeys of 4 m, the same tube throughout. */
static SceneOptions uniform_storeys(double side, CoreTheory theory)
{
    SceneOptions s = scene_defaults();
    s.core.theory = theory;
    s.core.width_m = side;
    s.building.heights_m = LIST_OF(4);
    return s;
}

typedef struct {
    double EI, kGA, mass_per_m, A, I; /* of a tube, shear area by Cowper */
} Tube;

static Tube tube(const CoreOptions *o, double t)
{
    const double B = o->width_m, A = B * B - (B - 2 * t) * (B - 2 * t), I = (pow(B, 4) - pow(B - 2 * t, 4)) / 12;
    const double k = 20 * (1 + o->poisson) / (48 + 39 * o->poisson), E = o->youngs_modulus_pa;
    return (Tube){E * I, k * E / (2 * (1 + o->poisson)) * A, o->density_kg_m3 * A, A, I};
}

TEST(a_force_at_any_node_bends_and_shears_the_cantilever_as_the_closed_form)
{
    enum { N = 7 };
    SceneOptions s = uniform_storeys(6, CORE_TIMOSHENKO);
    CoreBeam core;
    CHECK_OK(make_core_of(&core, &s, N, 0.02, 0.02, &err), &err);
    const Tube a = tube(&s.core, 0.02);
    for (int node = 0; node < N; node++) {
        double K[N * N], u[N] = {0};
        u[node] = 1e6;
        memcpy(K, core.K, sizeof K);
        CHECK_OK(linalg_solve_spd(N, 1, K, u, &err), &err);
        const double at = 4.0 * (node + 1), L = 4.0 * N;
        assert_close(u[node], 1e6 * (at * at * at / (3 * a.EI) + at / a.kGA), 1e-9);
        assert_close(u[N - 1], 1e6 * (at * at / (6 * a.EI) * (3 * L - at) + at / a.kGA), 1e-9);
    }
}

TEST(a_slender_core_vibrates_alike_by_both_theories)
{
    CoreBeam with, without;
    const double sides[] = {1.6, 0.4};
    double before = 1;
    for (int i = 0; i < 2; i++) {
        SceneOptions s = uniform_storeys(sides[i], CORE_TIMOSHENKO);
        CHECK_OK(make_core_of(&with, &s, 20, 0.002, 0.002, &err), &err);
        s.core.theory = CORE_EULER_BERNOULLI;
        CHECK_OK(make_core_of(&without, &s, 20, 0.002, 0.002, &err), &err);
        const double softer = 1 - with.omega[0] / without.omega[0];
        assert_true(softer > 0 && softer < before / 15.9); /* goes with the square of the side */
        before = softer;
    }
    assert_less(before, 1e-4);
}

/* Frequency equation of the clamped-free Timoshenko beam: Huang, J. Appl. Mech. 28 (1961) 579-584, b2 below the shear
 * cut-off. r, s: radius of gyration and its like for shear, over the length. */
static double clamped_free(double b, double r, double s)
{
    const double r2 = r * r, s2 = s * s, b2 = b * b, root = sqrt((r2 - s2) * (r2 - s2) + 4 / b2);
    const double alpha = sqrt((root - r2 - s2) / 2), beta = sqrt((root + r2 + s2) / 2);
    return 2 + (b2 * (r2 - s2) * (r2 - s2) + 2) * cosh(b * alpha) * cos(b * beta) -
           b * (r2 + s2) / sqrt(1 - b2 * r2 * s2) * sinh(b * alpha) * sin(b * beta);
}

/* Its first n roots, by steps and bisection. */
static void clamped_free_roots(double r, double s, int n, double roots[])
{
    const double step = 0.01;
    for (double b = step; n > 0; b += step) {
        double lo = b, hi = b + step;
        if (clamped_free(lo, r, s) * clamped_free(hi, r, s) > 0)
            continue;
        for (int k = 0; k < 60; k++) {
            const double middle = 0.5 * (lo + hi);
            *(clamped_free(lo, r, s) * clamped_free(middle, r, s) > 0 ? &lo : &hi) = middle;
        }
        *roots++ = lo;
        n--;
    }
}

enum { BEAM_MODES = 4, ELEMENTS_MAX = 32 };

static double relative_error(double omega, double b, const Tube *a, double L)
{
    return omega / (b / (L * L) * sqrt(a->EI / a->mass_per_m)) - 1;
}

/* Frequencies of a clamped chain of elements with all its rotations. */
static void chain_frequencies(const Beam *beam, int n, double omega[])
{
    enum { SIZE = 2 * ELEMENTS_MAX };
    static double K[SIZE * SIZE], M[SIZE * SIZE], phi[SIZE * SIZE];
    double k[4][4], m[4][4];
    const int size = 2 * n;
    memset(K, 0, sizeof K);
    memset(M, 0, sizeof M);
    beam_element(beam, k, m);
    for (int e = 0; e < n; e++)
        for (int i = e == 0 ? 2 : 0; i < 4; i++)
            for (int j = e == 0 ? 2 : 0; j < 4; j++) {
                K[(2 * e - 2 + i) * size + 2 * e - 2 + j] += k[i][j];
                M[(2 * e - 2 + i) * size + 2 * e - 2 + j] += m[i][j];
            }
    CHECK_OK(linalg_modes(size, K, M, omega, phi, &err), &err);
}

TEST(frequencies_converge_to_those_of_timoshenkos_beam)
{
    const double L = 80;
    const SceneOptions s = uniform_storeys(11.3, CORE_TIMOSHENKO);
    const Tube a = tube(&s.core, 0.01);
    double b[BEAM_MODES], omega[2 * ELEMENTS_MAX], before[BEAM_MODES] = {1, 1, 1, 1};
    clamped_free_roots(sqrt(a.I / a.A) / L, sqrt(a.EI / a.kGA) / L, BEAM_MODES, b);
    for (int n = 4; n <= ELEMENTS_MAX; n *= 2) {
        const Beam beam = {a.EI, a.kGA, a.mass_per_m, s.core.density_kg_m3 * a.I, L / n};
        chain_frequencies(&beam, n, omega);
        for (int i = 0; i < BEAM_MODES; i++) {
            const double error = relative_error(omega[i], b[i], &a, L);
            assert_true(error > 0 && error < before[i] / (n > 8 ? 3.5 : 1.5)); /* order 2, from above */
            before[i] = error;
        }
    }
    assert_true(before[0] < 1e-5 && before[BEAM_MODES - 1] < 3e-3);
}

/* Rotations that follow the deflections statically leave out what rotary inertia does to the shape. */
TEST(condensed_rotations_raise_the_first_frequencies_by_less_than_a_percent)
{
    const double L = 80, allowed[BEAM_MODES] = {1e-5, 6e-4, 3e-3, 7e-3};
    SceneOptions s = uniform_storeys(11.3, CORE_TIMOSHENKO);
    const Tube a = tube(&s.core, 0.01);
    CoreBeam core;
    double b[BEAM_MODES];
    s.building.heights_m = LIST_OF(L / 64);
    clamped_free_roots(sqrt(a.I / a.A) / L, sqrt(a.EI / a.kGA) / L, BEAM_MODES, b);
    CHECK_OK(make_core_of(&core, &s, 64, 0.01, 0.01, &err), &err);
    for (int i = 0; i < BEAM_MODES; i++) {
        const double error = relative_error(core.omega[i], b[i], &a, L);
        assert_true(error > 0 && error < allowed[i]);
    }
}

static double shear_effect_on_first_mode(CoreSection section, int n)
{
    CoreBeam with, without;
    SceneOptions s = scene_defaults();
    s.core.section = section;
    CHECK_OK(make_core_of(&with, &s, n, 0.012, 0.0064, &err), &err);
    s.core.theory = CORE_EULER_BERNOULLI;
    CHECK_OK(make_core_of(&without, &s, n, 0.012, 0.0064, &err), &err);
    assert_same_number(with.mass_kg, without.mass_kg);
    return 1 - with.omega[0] / without.omega[0];
}

TEST(shear_softens_a_squat_core_much_more_than_a_tall_one)
{
    const double tall = shear_effect_on_first_mode(CORE_BOX, 20), squat = shear_effect_on_first_mode(CORE_BOX, 6);
    print_message("first mode of the 11.3 m tube by shear and rotary inertia: -%.1f %% (20 storeys), -%.1f %% (6)\n",
                  100 * tall, 100 * squat);
    assert_true(tall > 0.03 && tall < 0.07);
    assert_true(squat > 0.25 && squat < 0.40);
    assert_less(shear_effect_on_first_mode(CORE_PLATE, 20), 1e-6);
}

TEST(an_effective_section_shears_by_the_area_that_is_given)
{
    SceneOptions s = uniform_storeys(6, CORE_TIMOSHENKO);
    CoreBeam box, effective;
    const Tube a = tube(&s.core, 0.02);
    CHECK_OK(make_core_of(&box, &s, 8, 0.02, 0.02, &err), &err);
    s.core.section = CORE_EFFECTIVE;
    s.core.areas_m2 = LIST_OF(a.A);
    s.core.inertias_m4 = LIST_OF(a.I);
    s.core.shear_areas_m2 = LIST_OF(a.kGA * 2 * (1 + s.core.poisson) / s.core.youngs_modulus_pa);
    CHECK_OK(make_core_of(&effective, &s, 8, 1, 1, &err), &err);
    for (int i = 0; i < 8; i++)
        assert_close(effective.omega[i], box.omega[i], 1e-10);
    s.core.shear_areas_m2 = LIST_OF(1, 0);
    assert_refused(make_core_of(&effective, &s, 8, 1, 1, &err), STATUS_BAD_DATA, "core.shear_area");
}

TEST(mode_shapes_are_mass_normalised_and_diagonalise_the_stiffness)
{
    OWNED(building_free) Building b;
    CHECK_OK(load_model(&b, "guyan", &err), &err);
    for (int i = 0; i < b.n; i++)
        for (int j = 0; j < b.n; j++) {
            double m = 0, k = 0;
            for (int r = 0; r < b.n; r++)
                for (int c = 0; c < b.n; c++) {
                    m += b.phi[r * b.n + i] * b.M[r * b.n + c] * b.phi[c * b.n + j];
                    k += b.phi[r * b.n + i] * b.K[r * b.n + c] * b.phi[c * b.n + j];
                }
            assert_less(fabs(m - (i == j)), 1e-9);
            assert_less(fabs(k - (i == j) * b.omega[i] * b.omega[i]), 1e-7 * b.omega[b.n - 1] * b.omega[b.n - 1]);
        }
}

TEST(participation_factors_add_up_to_the_whole_mass)
{
    OWNED(building_free) Building b;
    CHECK_OK(load_model(&b, "appendix", &err), &err);
    double from_modes = 0, from_matrix = 0;
    for (int i = 0; i < b.n; i++)
        from_modes += b.gamma[i] * b.gamma[i];
    for (int i = 0; i < b.n * b.n; i++)
        from_matrix += b.M[i];
    assert_close(from_modes, from_matrix, 1e-10);
}

TEST(bad_buildings_are_refused_with_file_and_fault)
{
    static const char *const BAD[][2] = {{"not_square", "square"},
                                         {"not_symmetric", "not symmetric: row 2 column 1"},
                                         {"indefinite", "not positive definite"},
                                         {"nan", "K.csv:2"},
                                         {"words", "not a number"},
                                         {"two_sizes", "M.csv: 2 floors, but K.csv has 3"},
                                         {"no_mass", "M.csv"},
                                         {"ragged", "K.csv:2"}};
    for (size_t i = 0; i < sizeof BAD / sizeof BAD[0]; i++) {
        Building b;
        err = (Err){0};
        FREED char *path = formatted("tests/bad/building/%s", BAD[i][0]);
        assert_int_not_equal(load_model(&b, path, &err), STATUS_OK);
        if (!strstr(err.text, BAD[i][1]) || !strstr(err.text, path)) {
            print_error("%s: message '%s' does not hold '%s'\n", path, err.text, BAD[i][1]);
            fail();
        }
    }
}

TEST(walls_that_do_not_fit_are_refused)
{
    CoreBeam core;
    SceneOptions s = paper_scene();
    s.core.width_m = 0.05;
    assert_int_equal(make_core_of(&core, &s, 20, 0.03, 0.02, &err), STATUS_BAD_DATA);
    assert_int_equal(make_core_of(&core, &s, 20, -0.01, 0.02, &err), STATUS_BAD_DATA);
}

TEST(contact_stiffness_and_damping_are_those_of_the_paper)
{
    SceneOptions s = paper_scene();
    Contact c;
    CHECK_OK(contact_make(&c, &s.contact, &err), &err);
    assert_close(c.k, 4.8650e10, 2e-5);
    assert_close(c.a, 0.45, 1e-12);
    s.contact.law = LAW_EXACT;
    CHECK_OK(contact_make(&c, &s.contact, &err), &err);
    assert_close(c.a, 0.63482828, 1e-7);
    s.contact.restitution = 0;
    assert_int_equal(contact_make(&c, &s.contact, &err), STATUS_BAD_DATA);
}

TEST(rebound_formula_matches_its_table_and_its_inverse)
{
    const double table[][2] = {{.3, .58128804}, {.5, .66296220}, {.7, .76799979}, {.9, .90901574}};
    for (int i = 0; i < 4; i++)
        assert_close(contact_rebound(1.5 * (1 - table[i][0])), table[i][1], 1e-7);
    assert_less(fabs(contact_rebound(1.5) - .4877), 5e-5);
    assert_close(contact_rebound(0), 1, 1e-15);
    for (double e = 0.02; e < 1; e += 0.02)
        assert_close(contact_rebound(contact_damping(e)), e, 1e-12);
}

TEST(hertz_impact_of_two_steel_balls)
{
    const double E = 2.1e11, nu = 0.3, R = 0.01; /* two balls: E' = E/(2 (1-nu^2)), R' = R/2, m' = m/2 */
    const double k = 4.0 / 3 * E / (2 * (1 - nu * nu)) * sqrt(R / 2);
    const double m = 7850 * 4.0 / 3 * M_PI * R * R * R / 2, v = 1, p = contact_hertz_indentation(k, m, v);
    assert_close(p, 2.04412126e-5, 1e-8);
    assert_close(contact_hertz_duration(k, m, v), 6.016411378e-5, 1e-9);
    assert_close(k * pow(p, 1.5), 1005.383, 1e-6);
    assert_close(0.4 * k * pow(p, 2.5), 0.5 * m * v * v, 1e-12);
}

/* A mode over one step by 20,000 Runge-Kutta steps: q, q', (1/h) int q, (1/h) int x q. */
static void march(double w, double zeta, const double P[3], double q, double v, double out[4])
{
    const int n = 20000;
    const double d = 1.0 / n;
    double mean = 0, first = 0;
    for (int i = 0; i < n; i++) {
        double kq[4], kv[4];
        const double at[4] = {0, d / 2, d / 2, d};
        for (int s = 0; s < 4; s++) {
            const double qs = s ? q + at[s] * kq[s - 1] : q, vs = s ? v + at[s] * kv[s - 1] : v, x = i * d + at[s];
            kq[s] = vs;
            kv[s] = P[0] + x * (P[1] + x * P[2]) - 2 * zeta * w * vs - w * w * qs;
        }
        const double middle = q + d / 2 * kq[1], x = i * d;
        const double q1 = q + d / 6 * (kq[0] + 2 * kq[1] + 2 * kq[2] + kq[3]);
        mean += d / 6 * (q + 4 * middle + q1);
        first += d / 6 * (q * x + 4 * middle * (x + d / 2) + q1 * (x + d));
        v += d / 6 * (kv[0] + 2 * kv[1] + 2 * kv[2] + kv[3]);
        q = q1;
    }
    const double all[4] = {q, v, mean, first};
    memcpy(out, all, sizeof all);
}

TEST(modal_flow_is_exact_at_every_damping_and_stiffness)
{
    const double W[] = {0, 1e-3, 0.7, 1.99, 2.01, 9, 60}, Z[] = {0, 0.03, 0.5, 0.999, 1, 1.0001, 3};
    const double P[3] = {0.5, -1.1, 0.8}, q = 0.3, v = -0.7;
    for (size_t i = 0; i < 7; i++)
        for (size_t j = 0; j < 7; j++) {
            double c[FLOW_ROWS], wanted[4];
            flow_coefficients(1, &W[i], &Z[j], 1.0, c, 1);
            march(W[i], Z[j], P, q, v, wanted);
            for (int r = 0; r < 4; r++) {
                const double *a = c + 5 * r;
                const double actual = a[0] * q + a[1] * v + a[2] * P[0] + a[3] * P[1] + a[4] * P[2];
                if (!(fabs(actual - wanted[r]) < 1e-8)) {
                    print_error("w %g zeta %g row %d: %.15g, wanted %.15g\n", W[i], Z[j], r, actual, wanted[r]);
                    fail();
                }
            }
        }
}

TEST(two_half_steps_of_flow_make_a_whole_one)
{
    for (double w = 1e-4; w < 1e5; w *= 3.3) {
        const double zeta = 0.03, h = 0.01;
        double whole[FLOW_ROWS], half[FLOW_ROWS];
        flow_coefficients(1, &w, &zeta, h, whole, 1);
        flow_coefficients(1, &w, &zeta, h / 2, half, 1);
        const double q = half[0] * 1 + half[1] * 2 * w, v = half[5] * 1 + half[6] * 2 * w;
        const double q2 = half[0] * q + half[1] * v, v2 = half[5] * q + half[6] * v;
        const double scale = fabs(whole[0]) + 2 * w * fabs(whole[1]) + 1e-300;
        assert_less(fabs(q2 - whole[0] - whole[1] * 2 * w), 1e-11 * scale);
        assert_less(fabs(v2 - whole[5] - whole[6] * 2 * w), 1e-11 * w * scale * 3);
    }
}

SUITE(NULL, NULL)
