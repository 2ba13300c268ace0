/* Readers of ground motions, their scaling, response spectra and intensity figures. */
#include "check.h"

#include "motion/motion_scale.h"
#include "motion/motion_read.h"
#include "motion/spectrum.h"

static const double PI = 3.14159265358979323846;
static const double G = 9.81;

/* ---- readers -------------------------------------------------------------------------------------------------- */

static Status parse(Motion *m, const char *text, MotionUnit unit, Err *why)
{
    return motion_parse(m, "text", text, strlen(text), &(MotionHow){.unit = unit}, why);
}

/* Text that must be read as a[0..3] = 1 2 -3 0 m/s2 with a step of 0.02 s. */
static void must_read(const char *text, MotionUnit unit, const char *format)
{
    static const double want[] = {1, 2, -3, 0};
    OWNED(motion_free) Motion m;
    CHECK_OK(parse(&m, text, unit, &err), &err);
    assert_int_equal(m.n, 4);
    assert_close(m.dt_s, 0.02, 0);
    assert_string_equal(m.format, format);
    for (int i = 0; i < 4; i++)
        if (fabs(m.accel[i] - want[i]) > 1e-12)
            fail_msg("sample %d of '%s' is %.17g, wanted %g", i, text, m.accel[i], want[i]);
}

TEST(units_are_found_in_names_and_comments)
{
    must_read("time_s,accel_m_s2\n0.00,1\n0.02,2\n0.04,-3\n0.06,0\n", UNIT_FROM_FILE, "csv");
    must_read("# made by hand, units: m/s^2\r\n0.00,1\r\n0.02,2\r\n\r\n0.04,-3\r\n0.06,0", UNIT_FROM_FILE, "csv");
    must_read("t [s], a [cm/s2]\n0,100\n0.02,200\n0.04,-300\n0.06,0\n", UNIT_FROM_FILE, "csv");
    must_read("# Gal\n0,100\n0.02,200\n0.04,-300\n0.06,0\n", UNIT_CM_S2, "csv");
    must_read("# units: g; peak 3 m/s2\n0,.101936799184505606524\n.02,.20387359836901121305\n"
              ".04,-0.30581039755351681957\n6e-2,0\n",
              UNIT_FROM_FILE, "csv");
    must_read("\"time\" ; \"acceleration\"\n0 ; 1\n0.02 ; 2\n0.04 ; -3\n0.06 ; 0\n", UNIT_M_S2, "csv");
    must_read("\xef\xbb\xbf# units: s, m/s2\ntime_s,accel_m_s2\n0.00,1\n0.02,2\n0.04,-3\n0.06,0\n", UNIT_FROM_FILE,
              "csv");
}

TEST(both_forms_of_a_peer_header_are_read)
{
    static const char *const npts[] = {"NPTS=     4, DT=   .0200 SEC", "    4    0.0200    NPTS, DT"};
    for (int i = 0; i < 2; i++)
        for (int crlf = 0; crlf < 2; crlf++) {
            const char *end = crlf ? "\r\n" : "\n";
            must_read(brief("PEER NGA STRONG MOTION DATABASE RECORD%sAnywhere, 1/1/1970, Station G%s"
                            "ACCELERATION TIME SERIES IN UNITS OF G%s%s%s"
                            "  .1019367991845056E+00  .2038735983690112E+00 -.3058103975535168E+00%s  .0000000E+00%s",
                            end, end, end, npts[i], end, end, end),
                      UNIT_FROM_FILE, "at2");
        }
}

TEST(a_setting_may_not_contradict_the_file)
{
    Motion m;
    assert_refused(parse(&m, "time_s,accel_m_s2\n0,1\n1,2\n", UNIT_G, &err), STATUS_BAD_DATA,
                   "motion.unit is g, but the file says m_s2");
    assert_null(m.accel);
}

TEST(times_printed_with_few_digits_are_uniform)
{
    enum { N = 4001 };
    static const struct {
        double dt;
        const char *format;
    } CASES[] = {{1.0 / 256, "%.4f"}, {0.005, "%.3f"},       {0.02, "%.2f"}, {0.02, "%g"},
                 {0.0078125, "%g"},   {60.0 / 2999, "%.6f"}, {0.01, "%.3e"}, {0.005, "%.17g"}};
    FREED char *text = malloc(N * 40);
    assert_non_null(text);
    for (size_t c = 0; c < sizeof CASES / sizeof *CASES; c++) {
        char *p = text + sprintf(text, "t,a_m_s2\n");
        const int n = strchr(CASES[c].format, 'e') ? 900 : N; /* four digits tell 0.01 s apart below 10 s */
        for (int i = 0; i < n; i++) {
            p += sprintf(p, CASES[c].format, i * CASES[c].dt);
            p += sprintf(p, ",%d\n", i % 3);
        }
        OWNED(motion_free) Motion m;
        CHECK_OK(parse(&m, text, UNIT_FROM_FILE, &err), &err);
        assert_int_equal(m.n, n);
        assert_close(m.dt_s, CASES[c].dt, 1e-5);
    }
}

TEST(a_sample_missing_anywhere_is_noticed)
{
    enum { N = 500 };
    char text[N * 20];
    for (int gone = 1; gone < N - 1; gone += 7) {
        char *p = text + sprintf(text, "# units: m/s2\n");
        for (int i = 0; i < N; i++)
            if (i != gone)
                p += sprintf(p, "%.2f,1\n", i * 0.01);
        Motion m;
        FREED char *where = formatted(":%d: time ", gone + 2); /* one line of header, one sample less before it */
        assert_refused(parse(&m, text, UNIT_FROM_FILE, &err), STATUS_BAD_DATA, where);
        assert_words(err.text, "breaks the uniform step of 0.01 s");
    }
}

TEST(every_bad_file_is_refused_with_its_reason)
{
    static const struct {
        const char *file, *says;
    } BAD[] = {{"empty.csv", "is empty"},
               {"only_comments.csv", "holds 0 samples"},
               {"one_sample.csv", "holds 1 sample; at least two"},
               {"no_unit.csv", "set motion.unit"},
               {"time_ms.csv", "times must be in seconds"},
               {"two_units.csv", ":2: states another unit than a line above"},
               {"nan.csv", ":3: found nan"},
               {"infinite.csv", ":4: found inf"},
               {"word.csv", ":3: 'oops' is not a number"},
               {"half_number.csv", ":3: '2.0x' is not a number"},
               {"second_header.csv", ":3: 'time_s' is not a number"},
               {"one_column.csv", ":2: has one column and does not say its step; set motion.dt_s"},
               {"three_columns.csv", "holds 2 channels: 1 'north', 2 'east'; choose one by motion.channel"},
               {"missing_sample.csv", ":6: time 0.1 s breaks the uniform step of 0.02 s: it comes 0.04 s after"},
               {"doubled_time.csv", ":4: time 0.02 s does not come after 0.02 s"},
               {"backward.csv", ":4: time 0.02 s does not come after 0.04 s"},
               {"wrong_unit.csv", ":3: an acceleration of 341.7 m_s2 is beyond 20 g"},
               {"binary.csv", ":3: holds bytes that no text has"},
               {"too_few.at2", ":6: ends after 10 samples, but its header announces 12"},
               {"too_many.at2", ":6: more samples than the 6"},
               {"no_step.at2", ":4: no usable time step (above 0, at most 1 s) above this line"},
               {"no_count.at2", ":4: no usable number of points"},
               {"nan.at2", ":5: found nan"},
               {"stars.at2", ":5: '********' is not a number"},
               {"velocity.at2", ":3: not an acceleration: 'VELOCITY TIME SERIES"},
               {"velocity_only.csv", ": none of its channels is an acceleration: 1 'velocity_m_s'"},
               {"spectrum_commented.csv", ": none of its channels is an acceleration: 1 'PSa [m/s^2]'"},
               {"no_unit.at2", "set motion.unit"}};
    for (size_t i = 0; i < sizeof BAD / sizeof *BAD; i++) {
        Motion m;
        FREED char *path = formatted("tests/bad/motion/%s", BAD[i].file);
        assert_refused(motion_load(&m, path, UNIT_FROM_FILE, &err), STATUS_BAD_DATA, BAD[i].says);
        assert_null(m.accel);
        assert_ptr_equal(strstr(err.text, path), err.text); /* how it begins */
    }
}

/* A unit that is given makes no motion of a spectrum; a comment of other words above the columns names none. */
TEST(a_comment_heads_columns_where_it_begins_with_times_or_periods)
{
    static const struct {
        const char *head, *says; /* NULL: a motion */
    } CASES[] = {{"# T [s], PSa [m/s^2]", "none of its channels is an acceleration"},
                 {"% T [s]  PSa [m/s^2]\n# 5 % damped", "none of its channels is an acceleration"},
                 {"// Period (s)\tSa (g)", "heads a spectrum"},
                 {"# time [s], velocity [m/s]", "none of its channels is an acceleration"},
                 {"# time_s, acc_m_s2", NULL},
                 {"# time series, of something", NULL},
                 {"# Kobe, 1995", NULL},
                 {"# period: 3 s, damping: 5 %", NULL}};
    for (size_t i = 0; i < sizeof CASES / sizeof *CASES; i++) {
        OWNED(motion_free) Motion m;
        err = (Err){0};
        const Status s = parse(&m, brief("%s\n0.02,0.5\n0.04,-0.5\n0.06,0.25\n", CASES[i].head), UNIT_M_S2, &err);
        if ((s == STATUS_OK) != !CASES[i].says || (CASES[i].says && !strstr(err.text, CASES[i].says)))
            fail_msg("%s: %s", CASES[i].head, err.text);
    }
}

TEST(a_file_that_is_not_there_is_missing)
{
    OWNED(motion_free) Motion m;
    assert_refused(motion_load(&m, "tests/bad/motion/nowhere.csv", UNIT_FROM_FILE, &err), STATUS_MISSING,
                   "nowhere.csv");
    assert_int_equal(motion_load(&m, "tests/bad/motion", UNIT_FROM_FILE, &err), STATUS_MISSING);
}

TEST(the_benchmark_records_are_read)
{
    static const struct {
        const char *file;
        size_t n;
        double dt, peak;
    } RECORDS[] = {{"elcentro_ns.csv", 2501, 0.02, 3.417},
                   {"hachinohe_ns.csv", 3601, 0.01, 2.25},
                   {"kobe_jma_ns.csv", 7500, 0.02, 8.1782},
                   {"northridge_sylmar_ns.csv", 3000, 0.02, 8.2676}};
    int n_read = 0;
    for (size_t i = 0; i < sizeof RECORDS / sizeof *RECORDS; i++) {
        OWNED(motion_free) Motion m;
        const Status s = motion_load(&m, brief("../shared/records/%s", RECORDS[i].file), UNIT_FROM_FILE, &err);
        if (s == STATUS_MISSING)
            continue;
        CHECK_OK(s, &err);
        assert_int_equal(m.n, RECORDS[i].n);
        assert_close(m.dt_s, RECORDS[i].dt, 0);
        assert_close(motion_peak(&m), RECORDS[i].peak, 1e-6);
        n_read++;
    }
    if (n_read == 0)
        need_file("../shared/records");
}

/* ---- scaling -------------------------------------------------------------------------------------------------- */

static void says(double pga_g, double stretch, const char *wanted)
{
    OWNED(motion_free) Motion m;
    char text[MOTION_PEAK_TEXT_MAX];
    CHECK_OK(parse(&m, "t,a_m_s2\n0,1\n0.5,-4.905\n1,2\n", UNIT_FROM_FILE, &err), &err);
    CHECK_OK(motion_prepare(&m, pga_g, stretch, &err), &err);
    motion_peak_text(&m, text);
    assert_string_equal(text, wanted);
}

TEST(the_peak_of_a_motion_is_shown_with_its_scaling)
{
    says(0, 1, "peak 0.5 g");
    says(0.3, 1, "peak 0.3 g (0.5 g x 0.6, time x 1)");
    says(0, 3.1, "peak 0.5 g (0.5 g x 1, time x 3.1)");
    says(0.43, 3.1, "peak 0.43 g (0.5 g x 0.86, time x 3.1)");
}

TEST(prepare_scales_the_peak_and_stretches_time)
{
    OWNED(motion_free) Motion m;
    CHECK_OK(parse(&m, "t,a_m_s2\n0,1\n0.5,-4\n1,2\n", UNIT_FROM_FILE, &err), &err);
    CHECK_OK(motion_prepare(&m, 0, 2, &err), &err);
    assert_close(m.accel[1], -4, 0);
    assert_close(m.dt_s, 1, 0);
    CHECK_OK(motion_prepare(&m, 0.3, 3.1, &err), &err);
    assert_close(m.accel[1], -0.3 * G, 1e-15);
    assert_close(m.accel[2], 0.15 * G, 1e-15);
    assert_close(m.dt_s, 3.1, 0);
    assert_int_equal(motion_prepare(&m, 0.3, 0, &err), STATUS_BAD_DATA);
    assert_int_equal(motion_prepare(&m, NAN, 1, &err), STATUS_BAD_DATA);
}

TEST(a_motion_of_zeros_is_none)
{
    OWNED(motion_free) Motion m;
    CHECK_OK(parse(&m, "t,a_m_s2\n0,0\n0.5,0\n1,0\n", UNIT_FROM_FILE, &err), &err);
    for (int scaled = 0; scaled < 2; scaled++)
        assert_refused(motion_prepare(&m, 0.3 * scaled, 1, &err), STATUS_BAD_DATA, "zero throughout");
}

/* ---- spectrum ------------------------------------------------------------------------------------------------- */

/* A step of acceleration a overshoots its static answer by exp(-zeta pi / sqrt(1 - zeta^2)). */
TEST(a_constant_acceleration_overshoots_as_the_closed_form_says)
{
    double a[2] = {1.7, 1.7};
    const Motion m = {.accel = a, .n = 2, .dt_s = 100};
    static const double T[] = {0.03, 0.7, 3, 40, 199};
    static const double ZETA[] = {0, 0.02, 0.05, 0.5};
    for (int z = 0; z < 4; z++) {
        double psa[5];
        spectrum_psa(&m, ZETA[z], 5, T, psa);
        for (int i = 0; i < 4; i++)
            assert_close(psa[i], 1.7 * (1 + exp(-ZETA[z] * PI / sqrt(1 - ZETA[z] * ZETA[z]))), 1e-9);
    }
}

/* A rectangular pulse shorter than half a period: the undamped peak comes afterwards, 2 a sin(pi t_d / T). */
TEST(the_peak_after_the_end_of_the_motion_counts)
{
    double a[2] = {2, 2}, psa;
    const Motion m = {.accel = a, .n = 2, .dt_s = 0.1};
    const double T = 0.9;
    spectrum_psa(&m, 0, 1, &T, &psa);
    assert_close(psa, 2 * 2 * sin(PI * 0.1 / T), 1e-12);
}

/* u = -a / (w^2 - q^2) (sin qt - q/w sin wt) for a ground acceleration a sin qt, undamped, from rest. */
TEST(a_harmonic_motion_gives_the_textbook_response)
{
    enum { N = 8001 };
    static double a[N];
    const double q = 2 * PI, dt = 1e-3;
    for (int i = 0; i < N; i++)
        a[i] = sin(q * i * dt);
    const Motion m = {.accel = a, .n = N, .dt_s = dt};
    static const double T[] = {0.21, 0.63, 1.37, 3.3};
    double psa[4];
    spectrum_psa(&m, 0, 4, T, psa);
    for (int k = 0; k < 4; k++) {
        const double w = 2 * PI / T[k], scale = w * w / fabs(w * w - q * q), end = (N - 1) * dt;
        double largest = 0;
        for (double t = 0; t < end; t += 1e-5)
            largest = fmax(largest, scale * fabs(sin(q * t) - q / w * sin(w * t)));
        /* after the end it swings freely: amplitude from u and u'/w */
        const double u = sin(q * end) - q / w * sin(w * end), v = q * cos(q * end) - q * cos(w * end);
        largest = fmax(largest, scale * hypot(u, v / w));
        assert_close(psa[k], largest, 1e-5);
    }
}

/* An irregular signal with content from 0.2 to 20 Hz. */
static void irregular(double *a, int n, double dt)
{
    for (int i = 0; i < n; i++) {
        const double t = i * dt;
        a[i] = exp(-0.3 * t) * t *
               (sin(2 * PI * 0.23 * t) + sin(7.1 * t + 1) + 0.7 * sin(31 * t * (1 + 0.02 * t)) + cos(120 * t));
    }
}

/* Largest |u| by classical Runge-Kutta steps, `sub` to a sample; the motion is followed by half a period of rest. */
static double runge_kutta_peak(const Motion *m, double w, double zeta, int sub)
{
    const double h = m->dt_s / sub, end = (double)(m->n - 1) * m->dt_s;
    double u = 0, v = 0, largest = 0;
    for (int i = 0; i * h < end + PI / w; i++) {
        const size_t k = (size_t)(i / sub);
        const int over = k + 1 >= m->n;
        const double a0 = over ? 0 : m->accel[k], slope = over ? 0 : (m->accel[k + 1] - m->accel[k]) / m->dt_s;
        const double s = (double)(i % sub) * h;
        double ku[4], kv[4], x = u, y = v;
        for (int j = 0; j < 4; j++) {
            const double part = j == 0 ? 0 : j == 3 ? h : h / 2;
            if (j) {
                x = u + part * ku[j - 1];
                y = v + part * kv[j - 1];
            }
            ku[j] = y;
            kv[j] = -(a0 + slope * (s + part)) - 2 * zeta * w * y - w * w * x;
        }
        u += h / 6 * (ku[0] + 2 * ku[1] + 2 * ku[2] + ku[3]);
        v += h / 6 * (kv[0] + 2 * kv[1] + 2 * kv[2] + kv[3]);
        largest = fmax(largest, fabs(u));
    }
    return largest;
}

TEST(an_irregular_motion_agrees_with_fine_runge_kutta)
{
    enum { N = 400 };
    double a[N];
    irregular(a, N, 0.02);
    const Motion m = {.accel = a, .n = N, .dt_s = 0.02};
    static const double T[] = {0.008, 0.03, 0.11, 0.5, 1.9, 6, 15};
    static const double ZETA[] = {0, 0.05, 0.6};
    for (int z = 0; z < 3; z++) {
        double psa[7];
        spectrum_psa(&m, ZETA[z], 7, T, psa);
        for (int i = 0; i < 7; i++) {
            const double w = 2 * PI / T[i];
            /* sampling misses a peak by (w h)^2 / 8 at most */
            assert_close(psa[i] / (w * w), runge_kutta_peak(&m, w, ZETA[z], T[i] < 0.1 ? 2000 : 200), 2e-6);
        }
    }
}

/* Many half cycles inside one interval: u = -(b (t - sin(wt) / w)) / w^2 on a ramp, and its like after a jump. */
TEST(a_stiff_undamped_oscillator_is_followed_between_samples)
{
    for (int k = 1; k < 60; k++) {
        double a[3] = {1, 0.2 + 0.05 * k, -0.7}, psa;
        const Motion m = {.accel = a, .n = 3, .dt_s = 1};
        const double T = 1 / (k + 0.37), w = 2 * PI / T;
        spectrum_psa(&m, 0, 1, &T, &psa);
        assert_close(psa / (w * w), runge_kutta_peak(&m, w, 0, 400 * (k + 1)), 1e-4);
    }
}

/* Oscillators are advanced four at a time. */
TEST(the_answer_of_a_period_does_not_depend_on_those_beside_it)
{
    enum { N = 11 };
    double T[N], psa[N], alone;
    OWNED(motion_free) Motion m = {.n = 4000, .dt_s = 0.01, .accel = malloc(4000 * sizeof(double))};
    for (size_t i = 0; i < m.n; i++)
        m.accel[i] = sin(0.11 * (double)i) * cos(0.0003 * (double)(i * i));
    for (int i = 0; i < N; i++)
        T[i] = i == 5 ? 0 : 0.015 * pow(2.1, i);
    for (size_t n = 1; n <= N; n++) {
        spectrum_psa(&m, 0.05, n, T, psa);
        for (size_t i = 0; i < n; i++) {
            spectrum_psa(&m, 0.05, 1, &T[i], &alone);
            assert_same_number(psa[i], alone);
        }
    }
}

TEST(the_spectrum_of_a_long_motion_takes_seconds)
{
    enum { N = 121 };
    double T[N], psa[N];
    uint32_t random = 7;
    OWNED(motion_free) Motion m = {.n = 400000, .dt_s = 0.005, .accel = malloc(400000 * sizeof(double))};
    for (size_t i = 0; i < m.n; i++)
        m.accel[i] = (double)(random = random * 1664525u + 1013904223u) / 4294967296.0 - 0.5;
    for (int i = 0; i < N; i++)
        T[i] = 0.02 * pow(1000, i / 120.0);
    const clock_t began = clock();
    spectrum_psa(&m, 0.05, N, T, psa);
    assert_less((double)(clock() - began) / CLOCKS_PER_SEC, 4); /* 0.4 s; one oscillator after the other 7 s */
}

TEST(short_and_long_periods_reach_their_limits)
{
    enum { N = 1200 };
    double a[N];
    irregular(a, N, 0.02);
    a[N - 1] = 0;
    Motion m = {.accel = a, .n = N, .dt_s = 0.02};
    static const double SHORT[] = {0, 1e-3, 1e-6};
    double psa[3];
    spectrum_psa(&m, 0.05, 3, SHORT, psa);
    assert_close(psa[0], motion_peak(&m), 0);
    assert_close(psa[1], motion_peak(&m), 5e-3);
    assert_close(psa[2], motion_peak(&m), 1e-5);

    /* Two opposite pairs of pulses leave the ground at rest: a very soft oscillator stays where it was in space. */
    double pulses[] = {0, 1, 0, -1, 0, 0, -1, 0, 1, 0};
    m = (Motion){.accel = pulses, .n = 10, .dt_s = 0.01};
    MotionFigures f;
    motion_figures(&m, &f);
    const double T = 1e5, w = 2 * PI / T;
    spectrum_psa(&m, 0, 1, &T, psa);
    assert_close(psa[0] / (w * w), f.pgd_m, 1e-6);
}

/* ---- figures -------------------------------------------------------------------------------------------------- */

TEST(figures_of_a_triangle_pulse)
{
    double a[] = {0, -3, 0};
    const double dt = 0.25;
    const Motion m = {.accel = a, .n = 3, .dt_s = dt};
    MotionFigures f;
    motion_figures(&m, &f);
    assert_close(f.pga_m_s2, 3, 0);
    assert_close(f.pgv_m_s, 3 * dt, 1e-14);
    assert_close(f.pgd_m, 3 * dt * dt, 1e-14);
    assert_close(f.cav_m_s, 3 * dt, 1e-14);
    assert_close(f.arias_m_s, PI / (2 * G) * 9 * dt * 2 / 3, 1e-14);
    assert_close(f.duration_s, 2 * dt, 0);
}

TEST(figures_of_a_constant)
{
    double a[] = {2, 2, 2, 2, 2};
    const Motion m = {.accel = a, .n = 5, .dt_s = 1};
    MotionFigures f;
    motion_figures(&m, &f);
    assert_close(f.arias_m_s, PI / (2 * G) * 16, 1e-14);
    assert_close(f.cav_m_s, 8, 1e-14);
    assert_close(f.d5_95_s, 3.6, 1e-12);
    assert_close(f.pgv_m_s, 8, 1e-14);
    assert_close(f.pgd_m, 16, 1e-14);
}

/* a = 1 - 4t: v = t - 2t^2 peaks at 1/8 with t = 1/4; d = t^2/2 - 2t^3/3 peaks at 1/24 with t = 1/2. */
TEST(figures_see_peaks_between_samples)
{
    double a[] = {1, -1.4};
    const Motion m = {.accel = a, .n = 2, .dt_s = 0.6};
    MotionFigures f;
    motion_figures(&m, &f);
    assert_close(f.pgv_m_s, 0.125, 1e-14);
    assert_close(f.pgd_m, 1 / 24.0, 1e-14);
    assert_close(f.cav_m_s, 0.25 * 1 / 2 + 0.35 * 1.4 / 2, 1e-14);
}

SUITE(NULL, NULL)
