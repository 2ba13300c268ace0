/* What is done to a ground motion on request: base line, filters, scaling, code spectra; in numbers and as printed. */
#include "program.h"

#include <sys/resource.h>

#include "motion/motion_scale.h"
#include "motion/motion.h"
#include "motion/spectrum.h"

static MotionOptions options(void)
{
    return default_settings().motion;
}

static Motion motion_of(size_t n, double dt, double (*a)(double t))
{
    Motion m = {.n = n, .dt_s = dt, .name = "test"};
    m.accel = malloc(n * sizeof *m.accel);
    assert_non_null(m.accel);
    for (size_t i = 0; i < n; i++)
        m.accel[i] = a((double)i * dt);
    return m;
}

/* ---- base line --------------------------------------------------------------------------------------------------- */

static double noise(double t)
{
    return sin(7 * t) + 0.5 * sin(23.7 * t + 1) + 0.3 * cos(1.3 * t * t);
}

static double constant(double t)
{
    return noise(t) + 0.25;
}

static double ramp(double t)
{
    return noise(t) + 0.25 - 0.03 * t;
}

static double parabola(double t)
{
    return noise(t) + 0.25 - 0.03 * t + 0.004 * t * t;
}

static double (*const DRIFTING[])(double t) = {noise, constant, ramp, parabola};

/* Least squares: what a polynomial of its degree adds to a record changes nothing of the result, and a record that is
 * nothing but such a polynomial disappears. */
TEST(a_base_line_of_its_degree_leaves_no_trace)
{
    for (int degree = 0; degree <= 2; degree++) {
        MotionOptions o = options();
        OWNED(motion_free) Motion a = motion_of(1501, 0.01, noise), b = motion_of(1501, 0.01, DRIFTING[degree + 1]);
        o.baseline = (MotionBaseline)(BASELINE_MEAN + degree);
        double sums[3] = {0};
        CHECK_OK(motion_process(&a, &o, &err), &err);
        CHECK_OK(motion_process(&b, &o, &err), &err);
        for (size_t i = 0; i < a.n; i++) {
            assert_less(fabs(a.accel[i] - b.accel[i]), 1e-12);
            for (int k = 0; k <= degree; k++)
                sums[k] += a.accel[i] * pow((double)i / 1500, k);
        }
        for (int k = 0; k <= degree; k++)
            assert_less(fabs(sums[k]), 1e-9); /* nothing of that degree is left */
        assert_non_null(strstr(b.processed, (const char *[]){"mean", "straight line", "parabola"}[degree]));
    }
}

TEST(a_motion_is_as_recorded_unless_it_is_asked_to_be_processed)
{
    OWNED(motion_free) Motion m = motion_of(200, 0.01, parabola);
    const MotionOptions o = options();
    CHECK_OK(motion_process(&m, &o, &err), &err);
    assert_int_equal(m.n, 200);
    for (size_t i = 0; i < m.n; i++)
        assert_same_number(m.accel[i], parabola((double)i * 0.01));
    assert_string_equal(m.processed, "");
    assert_false(motion_is_corrected(&o));
}

TEST(too_few_samples_for_a_base_line_are_refused)
{
    MotionOptions o = options();
    o.baseline = BASELINE_QUADRATIC;
    OWNED(motion_free) Motion m = motion_of(3, 0.01, noise);
    assert_refused(motion_process(&m, &o, &err), STATUS_BAD_DATA, "too few");
}

/* ---- filters ----------------------------------------------------------------------------------------------------- */

/* A quake of some seconds on a base line that is off: after the high-pass the ground comes to rest where it was. */
static double offset_quake(double t)
{
    return 0.02 + 3 * exp(-pow((t - 12) / 4, 2)) * sin(2 * M_PI * 2 * t);
}

TEST(a_high_pass_brings_the_ground_to_rest_where_it_was)
{
    for (double hz = 0.05; hz < 0.3; hz *= 2) {
        MotionFigures before, after;
        MotionOptions o = options();
        o.highpass_hz = hz;
        OWNED(motion_free) Motion m = motion_of(3001, 0.01, offset_quake);
        motion_figures(&m, &before);
        CHECK_OK(motion_process(&m, &o, &err), &err);
        motion_figures(&m, &after);
        FREED double *v = malloc(3 * m.n * sizeof *v);
        double *d = v + m.n, *husid = d + m.n;
        motion_histories(&m, v, d, husid);
        const size_t pad = (size_t)ceil(3 / hz / 0.01);
        assert_int_equal(m.n, 3001 + 2 * pad);
        assert_less(8, before.pgd_m);
        assert_less(after.pgd_m, 0.6);
        assert_less(fabs(v[m.n - 1]), 1e-3 * after.pgv_m_s);
        assert_less(fabs(d[m.n - 1]), 3e-4 * before.pgd_m);
        assert_close(after.pga_m_s2, before.pga_m_s2, 0.02); /* 2 Hz is let pass */
        assert_words(m.processed, "zeros added at both ends");
    }
}

static double two_tones(double t)
{
    return exp(-pow((t - 15) / 5, 2)) * (sin(2 * M_PI * 2 * (t - 15)) + sin(2 * M_PI * 20 * (t - 15)));
}

static double slow_tone(double t)
{
    return exp(-pow((t - 15) / 5, 2)) * sin(2 * M_PI * 2 * (t - 15));
}

TEST(a_low_pass_takes_the_high_tone_and_leaves_the_low_one_in_place)
{
    MotionOptions o = options();
    o.lowpass_hz = 8;
    OWNED(motion_free) Motion m = motion_of(6001, 0.005, two_tones);
    CHECK_OK(motion_process(&m, &o, &err), &err);
    assert_int_equal(m.n, 6001);
    for (size_t i = 0; i < m.n; i++)
        assert_less(fabs(m.accel[i] - slow_tone((double)i * 0.005)), 1.5e-3); /* (8/20)^8 = 7e-4 is left of it */
}

TEST(a_cutoff_that_the_record_cannot_have_is_refused_by_its_key)
{
    MotionOptions o = options();
    OWNED(motion_free) Motion m = motion_of(100, 0.01, noise);
    o.lowpass_hz = 50;
    assert_refused(motion_process(&m, &o, &err), STATUS_BAD_DATA, "motion.lowpass_hz");
    o.lowpass_hz = 0;
    o.highpass_hz = 1e-9;
    assert_refused(motion_process(&m, &o, &err), STATUS_BAD_DATA, "padding");
}

/* ---- scaling ----------------------------------------------------------------------------------------------------- */

static double psa_at(const Motion *m, double T)
{
    double psa;
    spectrum_psa(m, 0.05, 1, &T, &psa);
    return psa;
}

static Motion scaled(const MotionOptions *o)
{
    Motion m = motion_of(3001, 0.01, offset_quake);
    CHECK_OK(motion_scale(&m, o, &err), &err);
    return m;
}

TEST(a_factor_multiplies_what_was_recorded)
{
    MotionOptions o = options();
    o.factor = 1.75;
    OWNED(motion_free) Motion m = scaled(&o);
    for (size_t i = 0; i < m.n; i++)
        assert_same_number(m.accel[i], 1.75 * offset_quake((double)i * 0.01));
    assert_close(m.scale, 1.75, 0);
}

TEST(a_spectral_value_is_reached_at_its_period_after_stretching)
{
    for (double stretch = 1; stretch < 4; stretch += 2.1)
        for (double T = 0.3; T < 5; T *= 2) {
            MotionOptions o = options();
            o.sa_g = 0.42;
            o.sa_period_s = T;
            o.stretch = stretch;
            OWNED(motion_free) Motion m = scaled(&o);
            assert_close(psa_at(&m, T), 0.42 * GRAVITY, 1e-12);
            assert_close(m.dt_s, 0.01 * stretch, 1e-15);
        }
}

static CodeSpectrum target_of(const char *text)
{
    CodeSpectrum c;
    CHECK_OK(target_parse(text, &c, &err), &err);
    return c;
}

/* Of EN 1998-1 and ASCE 7 at corners and in between, by hand; ground type C has S = 1.15, TB = 0.2, TC = 0.6, TD = 2 s. */
TEST(code_spectra_are_those_of_their_formulas)
{
    CodeSpectrum c = target_of("none");
    assert_same_number(target_psa(&c, 1), 0);
    for (int in_numbers = 0; in_numbers < 2; in_numbers++) {
        c = target_of(in_numbers ? "eurocode8 s=1.15 tb=0.2 tc=0.6 td=2 ag=0.2" : "eurocode8 ag=0.2 soil=C");
        assert_close(target_psa(&c, 0) / GRAVITY, 0.2 * 1.15, 1e-14);
        assert_close(target_psa(&c, 0.1) / GRAVITY, 0.2 * 1.15 * 1.75, 1e-14);
        assert_close(target_psa(&c, 0.4) / GRAVITY, 0.2 * 1.15 * 2.5, 1e-14);
        assert_close(target_psa(&c, 1.2) / GRAVITY, 0.2 * 1.15 * 2.5 / 2, 1e-14);
        assert_close(target_psa(&c, 4) / GRAVITY, 0.2 * 1.15 * 2.5 * 1.2 / 16, 1e-14);
    }
    c = target_of("asce7 sds=1.2 sd1=0.6 tl=6  from=0.3 to=3");
    assert_close(target_psa(&c, 0) / GRAVITY, 0.48, 1e-14);
    assert_close(target_psa(&c, 0.05) / GRAVITY, 1.2 * 0.7, 1e-14);
    assert_close(target_psa(&c, 0.3) / GRAVITY, 1.2, 1e-14);
    assert_close(target_psa(&c, 3) / GRAVITY, 0.2, 1e-14);
    assert_close(target_psa(&c, 12) / GRAVITY, 0.6 * 6 / 144, 1e-14);
    assert_same_number(c.from_s, 0.3);
    assert_same_number(c.to_s, 3);
}

TEST(the_scale_to_a_code_spectrum_makes_the_mean_square_least)
{
    for (int k = 0; k < 2; k++) {
        MotionOptions o = options();
        strcpy(o.target, k ? "asce7 sds=1 sd1=0.6" : "eurocode8 ag=0.3 soil=B");
        const CodeSpectrum target = target_of(o.target);
        OWNED(motion_free) Motion m = scaled(&o);
        const double least = target_misfit(&m, &target);
        for (int side = 0; side < 2; side++) {
            MotionOptions other = options();
            other.factor = m.scale * (side ? 1.05 : 0.95);
            OWNED(motion_free) Motion off = motion_of(3001, 0.01, offset_quake);
            CHECK_OK(motion_scale(&off, &other, &err), &err);
            const double misfit = target_misfit(&off, &target), shift = log(side ? 1.05 : 0.95);
            assert_close(misfit * misfit, least * least + shift * shift, 1e-9);
        }
    }
}

TEST(scalings_that_contradict_each_other_are_refused_and_named)
{
    static const char *const KEYS[] = {"motion.pga_g", "motion.factor", "motion.sa_g", "motion.target"};
    static const char *const SET[] = {"motion.pga_g=0.3", "motion.factor=2", "motion.sa_g=0.5",
                                      "motion.target=asce7 sds=1 sd1=0.6"};
    for (int i = 0; i < 4; i++)
        for (int k = 0; k < 4; k++) {
            Settings s = default_settings();
            CHECK_OK(settings_set(&s, SET[i], &err), &err);
            CHECK_OK(settings_set(&s, SET[k], &err), &err);
            const Status status = settings_check(&s, &err);
            assert_int_equal(status, i == k ? STATUS_OK : STATUS_BAD_DATA);
            if (i != k) {
                assert_non_null(strstr(err.text, KEYS[i]));
                assert_non_null(strstr(err.text, KEYS[k]));
            }
        }
}

TEST(settings_of_a_motion_that_make_no_sense_together_are_refused)
{
    FOR_EACH (const char *, set, "motion.target=eurocode8 ag=0.3 soil=A from=3",
              "motion.target=eurocode8 ag=0.3 soil=A tb=1", "motion.target=eurocode8 ag=0.3 soil=A td=0.3",
              "motion.target=asce7 sds=1 sd1=50", "motion.target=eurocode8 ag=0.3", "motion.target=eurocode8 soil=A",
              "motion.target=eurocode8 ag=0.3 soil=F", "motion.target=eurocode8 ag=0.3 soil=A sds=1",
              "motion.target=asce7 sds=1", "motion.target=asce7 sds=1 sd1=0.6 sds=2",
              "motion.target=eurocode8 ag=0.3 soil=A ag=0.3", "motion.target=eurocode9 ag=1",
              "motion.target=asce7 sds=1x sd1=1", "motion.target=none ag=1", "motion.unit=counts",
              "motion.unit=counts=0", "motion.unit=g=2", "motion.unit=feet") {
        Settings s = default_settings();
        CHECK_OK(settings_set(&s, *set, &err), &err);
        assert_int_equal(settings_check(&s, &err), STATUS_BAD_DATA);
    }
    expect(65, "motion.highpass_hz: 5 must be below motion.lowpass_hz = 2",
           "spectrum builtin:kobe-like --set motion.highpass_hz=5 --set motion.lowpass_hz=2");
}

/* ---- as printed -------------------------------------------------------------------------------------------------- */

TEST(the_figures_beside_processed_ones_are_those_of_the_record_at_the_same_scale)
{
    json_auto_t *a = as_json("spectrum builtin:sylmar-like --json --set motion.baseline=linear --pga 0.3");
    const json_t *r = json_object_get(a, "recorded");
    json_auto_t *b = as_json("spectrum builtin:sylmar-like --json --set motion.factor=%.17g", number(a, "scale"));
    assert_true(json_is_true(json_object_get(a, "corrected")));
    assert_true(json_is_false(json_object_get(b, "corrected")));
    assert_close(number(r, "pgd_m"), number(b, "pgd_m"), 1e-12);
    assert_close(number(r, "pgv_m_s"), number(b, "pgv_m_s"), 1e-12);
    assert_true(json_equal(json_object_get(r, "psa_m_s2"), json_object_get(b, "psa_m_s2")));
}

/* A million samples: 8 MB each for five histories, 24 and 10 for the rows and the text of the file. */
TEST(the_histories_of_a_long_record_are_written_without_a_second_copy)
{
    struct rusage used;
    FILE *f = opened(there("long.csv"), "w");
    fprintf(f, "# dt = 0.01 s, units: m/s2\n");
    for (int i = 0; i < 1000000; i++)
        fprintf(f, "%.6f\n", sin(i));
    assert_int_equal(fclose(f), 0);
    expect(0, "", "spectrum @/long.csv --history @/long_history.csv >/dev/null");
    assert_int_equal(getrusage(RUSAGE_CHILDREN, &used), 0);
    assert_at_most((double)used.ru_maxrss, 100e3); /* kB */
}

TEST(several_motions_are_shown_with_their_mean_and_the_target)
{
    static const char ALL[] = "builtin:kobe-like builtin:elcentro-like builtin:sylmar-like";
    free(output_of("spectrum %s --set 'motion.target=eurocode8 ag=0.3 soil=B' --csv @/all.csv", ALL));
    OWNED(table_free) Table t = table_of("all.csv");
    assert_int_equal(t.n_cols, 6);
    for (size_t i = 0; i < t.n_rows; i++) {
        const double *row = t.values + i * t.n_cols;
        assert_close(row[1], (row[3] + row[4] + row[5]) / 3, 1e-12);
        assert_less(0, row[2]);
    }
    if (has_browser()) {
        free(output_of("spectrum %s --set 'motion.target=eurocode8 ag=0.3 soil=B' --svg @/all.svg", ALL));
        FREED char *svg = read_in_place("all.svg");
        FOR_EACH (const char *, word, "kobe-like", "elcentro-like", "sylmar-like", "mean", "target", "</svg>")
            assert_non_null(strstr(svg, *word));
    }
    expect(2, "--history takes one motion", "spectrum builtin:kobe-like builtin:sylmar-like --history -");
}

TEST(a_study_keeps_in_its_provenance_what_was_done_to_the_record)
{
    free(output_of("optimize configs/quick.ini --out @/run --max-evals 48 --set search.initial=48 --set "
                   "sim.duration_s=8 --set motion.highpass_hz=0.2 --set motion.baseline=mean"));
    FREED char *text = read_in_place("run/provenance.json");
    json_auto_t *o = json_loads(text, 0, NULL);
    const char *said = json_string_value(json_object_get(json_object_get(o, "inputs"), "record_processed"));
    assert_non_null(said);
    assert_words(said, "base line: mean subtracted", "high-pass 0.2 Hz");
}

SUITE(make_place, clear_place)
