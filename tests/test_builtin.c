/* Generated motions: what they promise by themselves, and how near they are to the records that they stand in for. */
#include "scene_options.h"

enum { N_MOTIONS = 3, N_BUILDINGS = 2, N_PERIODS = 60 };

static const struct {
    const char *source, *record;
    double stretch, pga_m_s2, duration_s;
    double J[N_BUILDINGS][3]; /* of the record: [m], [m], [g], see below */
} MOTIONS[N_MOTIONS] = {
    {"builtin:kobe-like", "kobe_jma_ns.csv", 3.1, 8.18, 32, {{1.648, 0.1475, 0.901}, {1.652, 0.1573, 0.864}}},
    {"builtin:elcentro-like", "elcentro_ns.csv", 3.0, 3.42, 40, {{1.356, 0.1094, 0.779}, {1.500, 0.1211, 0.815}}},
    {"builtin:sylmar-like",
     "northridge_sylmar_ns.csv",
     3.0,
     8.27,
     24,
     {{1.749, 0.1589, 0.815}, {1.615, 0.1660, 0.809}}}};

static const char *const BUILDINGS[N_BUILDINGS] = {"guyan", "appendix"};

/* J1 [m], J2 [m], J3 [g] of the building without a core. */
static void building_alone(const Motion *m, const char *model, double J[3])
{
    const double none[FLOORS_MAX + 2] = {0};
    SceneOptions s = paper_scene();
    snprintf(s.building.model, sizeof s.building.model, "%s", model);
    const SimResult r = run_once(&s, m, SCENE_NO_CORE, none);
    J[0] = r.j1_m;
    J[1] = r.j2_m;
    J[2] = r.j3_g;
}

static Motion prepared(int k)
{
    return motion_of(MOTIONS[k].source, 0.3, MOTIONS[k].stretch);
}

/* 0 where there is no such record */
static int prepared_record(int k, Motion *m)
{
    const Status s = motion_load(m, brief("../shared/records/%s", MOTIONS[k].record), UNIT_FROM_FILE, &err);
    if (s == STATUS_MISSING)
        return 0;
    CHECK_OK(s, &err);
    CHECK_OK(motion_prepare(m, 0.3, MOTIONS[k].stretch, &err), &err);
    return 1;
}

/* ---- tests ----------------------------------------------------------------------------------------------------- */

TEST(generated_motions_have_the_stated_peak_and_duration)
{
    for (int k = 0; k < N_MOTIONS; k++) {
        OWNED(motion_free) Motion m;
        MotionFigures f;
        CHECK_OK(motion_load(&m, MOTIONS[k].source, UNIT_G, &err), &err); /* the unit of files does not matter */
        motion_figures(&m, &f);
        for (size_t i = 0; i < m.n; i++)
            assert_true(isfinite(m.accel[i]));
        assert_close(f.pga_m_s2, MOTIONS[k].pga_m_s2, 1e-15);
        assert_close(f.duration_s, MOTIONS[k].duration_s, 1e-12);
        assert_string_equal(m.name, MOTIONS[k].source);
        assert_string_equal(m.format, "builtin");
    }
}

TEST(generated_motions_leave_the_ground_at_rest)
{
    for (int k = 0; k < N_MOTIONS; k++) {
        OWNED(motion_free) Motion m;
        MotionFigures f;
        CHECK_OK(motion_load(&m, MOTIONS[k].source, UNIT_FROM_FILE, &err), &err);
        motion_figures(&m, &f);
        double v = 0;
        for (size_t i = 0; i + 1 < m.n; i++)
            v += m.dt_s * (m.accel[i] + m.accel[i + 1]) / 2;
        assert_true(m.accel[0] == 0 && m.accel[m.n - 1] == 0);
        assert_less(fabs(v), 0.01 * f.pgv_m_s);
        assert_less(f.pgd_m, 0.6);
    }
}

TEST(a_generated_motion_is_the_same_every_time)
{
    uint64_t hash[N_MOTIONS];
    for (int k = 0; k < N_MOTIONS; k++) {
        Motion m[2];
        for (int i = 0; i < 2; i++)
            CHECK_OK(motion_load(&m[i], MOTIONS[k].source, UNIT_FROM_FILE, &err), &err);
        assert_memory_equal(m[0].accel, m[1].accel, m[0].n * sizeof(double));
        assert_same_number(m[0].file_hash, m[1].file_hash);
        hash[k] = m[0].file_hash;
        motion_free(&m[0]);
        motion_free(&m[1]);
    }
    assert_true(hash[0] != hash[1] && hash[1] != hash[2] && hash[0] != hash[2]);
}

TEST(an_unknown_name_is_refused_with_the_known_ones)
{
    OWNED(motion_free) Motion m;
    assert_refused(motion_load(&m, "builtin:kobe", UNIT_FROM_FILE, &err), STATUS_BAD_DATA,
                   "builtin:kobe is no built-in motion; did you mean builtin:kobe-like?");
}

TEST(the_building_alone_answers_as_it_does_to_the_records)
{
    for (int k = 0; k < N_MOTIONS; k++) {
        OWNED(motion_free) Motion m = prepared(k);
        for (int b = 0; b < N_BUILDINGS; b++) {
            double J[3];
            building_alone(&m, BUILDINGS[b], J);
            print_message("%-21s %-22s J1 %.4f m (%.4f)  J2 %.5f m (%.4f)  J3 %.4f g (%.3f)\n", MOTIONS[k].source,
                          BUILDINGS[b], J[0], MOTIONS[k].J[b][0], J[1], MOTIONS[k].J[b][1], J[2], MOTIONS[k].J[b][2]);
            for (int i = 0; i < 3; i++)
                assert_close(J[i], MOTIONS[k].J[b][i], 0.005);
        }
    }
}

TEST(the_answers_listed_above_are_those_of_the_records)
{
    int n_read = 0;
    for (int k = 0; k < N_MOTIONS; k++) {
        OWNED(motion_free) Motion m;
        if (!prepared_record(k, &m))
            continue;
        n_read++;
        for (int b = 0; b < N_BUILDINGS; b++) {
            double J[3];
            building_alone(&m, BUILDINGS[b], J);
            for (int i = 0; i < 3; i++)
                assert_close(J[i], MOTIONS[k].J[b][i], 2e-3);
        }
    }
    if (n_read == 0)
        need_file("../shared/records");
}

TEST(spectra_are_near_those_of_the_records)
{
    double T[N_PERIODS], psa[2][N_PERIODS];
    int n_read = 0;
    for (int i = 0; i < N_PERIODS; i++)
        T[i] = 0.3 * pow(6 / 0.3, i / (N_PERIODS - 1.0));
    for (int k = 0; k < N_MOTIONS; k++) {
        Motion record, m;
        if (!prepared_record(k, &record))
            continue;
        n_read++;
        m = prepared(k);
        spectrum_psa(&m, 0.05, N_PERIODS, T, psa[0]);
        spectrum_psa(&record, 0.05, N_PERIODS, T, psa[1]);
        double mean = 0, worst = 0;
        for (int i = 0; i < N_PERIODS; i++) {
            const double off = fabs(psa[0][i] / psa[1][i] - 1);
            mean += off / N_PERIODS;
            worst = fmax(worst, off);
        }
        print_message("%-21s spectrum off by %.2f %% on average, %.1f %% at most\n", MOTIONS[k].source, 100 * mean,
                      100 * worst);
        assert_less(mean, 0.03);
        motion_free(&m);
        motion_free(&record);
    }
    if (n_read == 0)
        need_file("../shared/records");
}

SUITE(NULL, NULL)
