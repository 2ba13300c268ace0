/* The scene against printed numbers and closed forms: buildings, core beam, modes, contact laws, modal flow. */
#include "check.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/linalg.h"
#include "scene/building.h"
#include "scene/core_beam.h"
#include "sim/contact.h"
#include "sim/flow.h"
#include "sim/sim.h"
#include "scene_options.h"

static void make_core(CoreBeam *core, CoreSection section, double t_base, double t_top)
{
    SceneOptions s = scene_defaults();
    Err err = {0};
    s.core.section = section;
    CHECK_OK(core_beam_make(core, &s.core, &s.building, 20, t_base, t_top, &err), &err);
}

static void assert_hz(const double hz[], const double wanted[], int n, double tolerance_hz)
{
    for (int i = 0; i < n; i++)
        if (!(fabs(hz[i] - wanted[i]) <= tolerance_hz)) {
            print_error("mode %d: %.5f Hz, wanted %.5f\n", i + 1, hz[i], wanted[i]);
            fail();
        }
}

static void scene_hz(const char *model, CoreSection section, double building[], double core[], double zero_gap[],
                     double *mass)
{
    SceneOptions s = scene_defaults();
    Scene *scene;
    Err err = {0};
    double x[22] = {[20] = 0.012, [21] = 0.0064};
    snprintf(s.building.model, sizeof s.building.model, "%s", model);
    s.core.section = section;
    CHECK_OK(scene_create(&scene, &s, NULL, &err), &err);
    CHECK_OK(scene_frequencies(scene, x, building, core, zero_gap, mass, &err), &err);
    scene_free(scene);
}

static void test_the_effective_core_has_the_frequencies_of_table_1(void **state)
{
    (void)state;
    const double core_wanted[] = {2.29, 13.22, 36.19, 70.49, 116.25, 173.48, 242.24, 322.65, 414.91, 519.39};
    const double zero_gap_wanted[] = {0.75, 4.29, 11.82, 23.08, 38.12, 56.95, 79.55, 105.94, 136.07, 169.91};
    double building[FLOORS_MAX], core[FLOORS_MAX], zero_gap[FLOORS_MAX], mass;
    scene_hz("appendix", CORE_EFFECTIVE, building, core, zero_gap, &mass);
    assert_hz(core, core_wanted, 10, 0.006);
    assert_hz(zero_gap, zero_gap_wanted, 10, 0.006);
    assert_close(mass, 7.584e5, 1e-3);
}

static void test_both_buildings_have_their_known_frequencies(void **state)
{
    (void)state;
    const double guyan[] = {0.2643, 0.7599, 1.3113, 1.8448, 2.4209};
    const double appendix[] = {0.2729, 0.7800, 1.3388, 1.8946, 2.4977};
    double building[FLOORS_MAX], core[FLOORS_MAX], zero_gap[FLOORS_MAX], mass;
    scene_hz("guyan", CORE_BOX, building, core, zero_gap, &mass);
    for (int i = 0; i < 5; i++)
        assert_close(building[i], guyan[i], 1e-3);
    scene_hz("appendix", CORE_BOX, building, core, zero_gap, &mass);
    for (int i = 0; i < 5; i++)
        assert_close(building[i], appendix[i], 1e-3);
}

static void test_the_box_core_has_its_known_mass_and_frequencies(void **state)
{
    (void)state;
    const double wanted[] = {2.492, 13.64, 36.69, 71.11, 117.0};
    double building[FLOORS_MAX], core[FLOORS_MAX], zero_gap[FLOORS_MAX], mass;
    scene_hz("guyan", CORE_BOX, building, core, zero_gap, &mass);
    assert_close(mass, 2.650e5, 1e-3);
    for (int i = 0; i < 5; i++)
        assert_close(core[i], wanted[i], 1e-3);
}

static void test_a_uniform_core_is_a_textbook_cantilever(void **state)
{
    (void)state;
    CoreBeam core;
    SceneOptions s = scene_defaults();
    Err err = {0};
    s.core.section = CORE_PLATE;
    s.building.first_storey_m = s.building.storey_m = 4;
    CHECK_OK(core_beam_make(&core, &s.core, &s.building, 20, 0.5, 0.5, &err), &err);
    const double L = 80, EI = s.core.youngs_modulus_pa * s.core.width_m * pow(0.5, 3) / 12;
    const double m = s.core.density_kg_m3 * s.core.width_m * 0.5;
    const double beta_l[] = {1.875104069, 4.694091133, 7.854757438}; /* cos x cosh x = -1 */
    for (int i = 0; i < 3; i++)
        assert_close(core.omega[i], pow(beta_l[i] / L, 2) * sqrt(EI / m), 1e-4);
    assert_close(core.mass_kg, m * L, 1e-12);
}

static void test_stiffness_of_the_plate_goes_with_thickness_cubed(void **state)
{
    (void)state;
    CoreBeam thin, thick;
    make_core(&thin, CORE_PLATE, 0.01, 0.005);
    make_core(&thick, CORE_PLATE, 0.02, 0.01);
    for (int i = 0; i < 400; i++)
        assert_close(thick.K[i], 8 * thin.K[i], 1e-6);
    assert_close(thick.mass_kg, 2 * thin.mass_kg, 1e-12);
}

static void test_mode_shapes_are_mass_normalised_and_diagonalise_the_stiffness(void **state)
{
    (void)state;
    Building b;
    Err err = {0};
    CHECK_OK(building_load(&b, "guyan", &err), &err);
    for (int i = 0; i < b.n; i++)
        for (int j = 0; j < b.n; j++) {
            double m = 0, k = 0;
            for (int r = 0; r < b.n; r++)
                for (int c = 0; c < b.n; c++) {
                    m += b.phi[r * b.n + i] * b.M[r * b.n + c] * b.phi[c * b.n + j];
                    k += b.phi[r * b.n + i] * b.K[r * b.n + c] * b.phi[c * b.n + j];
                }
            assert_true(fabs(m - (i == j)) < 1e-9);
            assert_true(fabs(k - (i == j) * b.omega[i] * b.omega[i]) < 1e-7 * b.omega[b.n - 1] * b.omega[b.n - 1]);
        }
    building_free(&b);
}

static void test_participation_factors_add_up_to_the_whole_mass(void **state)
{
    (void)state;
    Building b;
    Err err = {0};
    CHECK_OK(building_load(&b, "appendix", &err), &err);
    double from_modes = 0, from_matrix = 0;
    for (int i = 0; i < b.n; i++)
        from_modes += b.gamma[i] * b.gamma[i];
    for (int i = 0; i < b.n * b.n; i++)
        from_matrix += b.M[i];
    assert_close(from_modes, from_matrix, 1e-10);
    building_free(&b);
}

static void test_bad_buildings_are_refused_with_file_and_fault(void **state)
{
    (void)state;
    static const char *const BAD[][2] = {
        {"not_square", "square"},
        {"not_symmetric", "not symmetric: row 2 column 1"},
        {"indefinite", "not positive definite"},
        {"nan", "K.csv:2"},
        {"words", "not a number"},
        {"two_sizes", "M.csv: 2 floors, but K.csv has 3"},
        {"no_mass", "M.csv"},
        {"ragged", "K.csv:2"},
    };
    for (size_t i = 0; i < sizeof BAD / sizeof BAD[0]; i++) {
        char path[200];
        Building b;
        Err err = {0};
        snprintf(path, sizeof path, "tests/bad/building/%s", BAD[i][0]);
        assert_int_not_equal(building_load(&b, path, &err), STATUS_OK);
        if (!strstr(err.text, BAD[i][1]) || !strstr(err.text, path)) {
            print_error("%s: message '%s' does not hold '%s'\n", path, err.text, BAD[i][1]);
            fail();
        }
    }
}

static void test_walls_that_do_not_fit_are_refused(void **state)
{
    (void)state;
    CoreBeam core;
    SceneOptions s = scene_defaults();
    Err err = {0};
    s.core.side_m = 0.05;
    assert_int_equal(core_beam_make(&core, &s.core, &s.building, 20, 0.03, 0.02, &err), STATUS_BAD_DATA);
    assert_int_equal(core_beam_make(&core, &s.core, &s.building, 20, -0.01, 0.02, &err), STATUS_BAD_DATA);
}

static void test_contact_stiffness_and_damping_are_those_of_the_paper(void **state)
{
    (void)state;
    SceneOptions s = scene_defaults();
    Contact c;
    Err err = {0};
    CHECK_OK(contact_make(&c, &s.contact, &err), &err);
    assert_close(c.k, 4.8650e10, 2e-5);
    assert_close(c.a, 0.45, 1e-12);
    s.contact.law = LAW_EXACT;
    CHECK_OK(contact_make(&c, &s.contact, &err), &err);
    assert_close(c.a, 0.63482828, 1e-7);
    s.contact.restitution = 0;
    assert_int_equal(contact_make(&c, &s.contact, &err), STATUS_BAD_DATA);
}

static void test_rebound_formula_matches_its_table_and_its_inverse(void **state)
{
    (void)state;
    const double table[][2] = {{.3, .58128804}, {.5, .66296220}, {.7, .76799979}, {.9, .90901574}};
    for (int i = 0; i < 4; i++)
        assert_close(contact_rebound(1.5 * (1 - table[i][0])), table[i][1], 1e-7);
    assert_true(fabs(contact_rebound(1.5) - .4877) < 5e-5);
    assert_close(contact_rebound(0), 1, 1e-15);
    for (double e = 0.02; e < 1; e += 0.02)
        assert_close(contact_rebound(contact_damping(e)), e, 1e-12);
}

static void test_hertz_impact_of_two_steel_balls(void **state)
{
    (void)state;
    const double E = 2.1e11, nu = 0.3, R = 0.01; /* two balls: E' = E/(2 (1-nu^2)), R' = R/2, m' = m/2 */
    const double k = 4.0 / 3 * E / (2 * (1 - nu * nu)) * sqrt(R / 2);
    const double m = 7850 * 4.0 / 3 * M_PI * R * R * R / 2, v = 1;
    const double p = contact_hertz_penetration(k, m, v);
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

static void test_modal_flow_is_exact_at_every_damping_and_stiffness(void **state)
{
    (void)state;
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

static void test_two_half_steps_of_flow_make_a_whole_one(void **state)
{
    (void)state;
    for (double w = 1e-4; w < 1e5; w *= 3.3) {
        const double zeta = 0.03, h = 0.01;
        double whole[FLOW_ROWS], half[FLOW_ROWS];
        flow_coefficients(1, &w, &zeta, h, whole, 1);
        flow_coefficients(1, &w, &zeta, h / 2, half, 1);
        const double q = half[0] * 1 + half[1] * 2 * w, v = half[5] * 1 + half[6] * 2 * w;
        const double q2 = half[0] * q + half[1] * v, v2 = half[5] * q + half[6] * v;
        const double scale = fabs(whole[0]) + 2 * w * fabs(whole[1]) + 1e-300;
        assert_true(fabs(q2 - whole[0] - whole[1] * 2 * w) < 1e-11 * scale);
        assert_true(fabs(v2 - whole[5] - whole[6] * 2 * w) < 1e-11 * w * scale * 3);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_the_effective_core_has_the_frequencies_of_table_1),
        cmocka_unit_test(test_both_buildings_have_their_known_frequencies),
        cmocka_unit_test(test_the_box_core_has_its_known_mass_and_frequencies),
        cmocka_unit_test(test_a_uniform_core_is_a_textbook_cantilever),
        cmocka_unit_test(test_stiffness_of_the_plate_goes_with_thickness_cubed),
        cmocka_unit_test(test_mode_shapes_are_mass_normalised_and_diagonalise_the_stiffness),
        cmocka_unit_test(test_participation_factors_add_up_to_the_whole_mass),
        cmocka_unit_test(test_bad_buildings_are_refused_with_file_and_fault),
        cmocka_unit_test(test_walls_that_do_not_fit_are_refused),
        cmocka_unit_test(test_contact_stiffness_and_damping_are_those_of_the_paper),
        cmocka_unit_test(test_rebound_formula_matches_its_table_and_its_inverse),
        cmocka_unit_test(test_hertz_impact_of_two_steel_balls),
        cmocka_unit_test(test_modal_flow_is_exact_at_every_damping_and_stiffness),
        cmocka_unit_test(test_two_half_steps_of_flow_make_a_whole_one),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
