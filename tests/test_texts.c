/* Plain texts as people have them: what is read as it stands, what is refused, and what motion.text reads of the rest. */
#include "program.h"

#include "motion/motion_read.h"
#include "motion/motion_scale.h"

enum { N = 120 };
static const double STEP = 0.02, PEAK_G = 0.25;

/* A quake of N samples [g] that begins and ends near rest and peaks at PEAK_G. */
static double sample(int k)
{
    const double t = k / (N - 1.0);
    return k == 47 ? PEAK_G : 0.9 * PEAK_G * sin(M_PI * t) * sin(40 * t);
}

/* Lines of so many numbers, each behind its time where they are pairs, below a head. */
static char *lines_of(const char *head, int per_line, int with_times, double scale, double zero)
{
    char *text = NULL;
    size_t length;
    FILE *f = open_memstream(&text, &length);
    fputs(head, f);
    for (int k = 0; k < N; k++) {
        if (with_times)
            fprintf(f, "%.2f ", STEP * k);
        fprintf(f, "%.6e%c", scale * sample(k) + zero, (k + 1) % per_line && k + 1 < N ? ' ' : '\n');
    }
    fclose(f);
    return text;
}

typedef struct {
    const char *head;
    int per_line, with_times;
    double scale, zero;
    const char *form; /* motion.text */
    MotionHow how;
    const char *says; /* of the refusal; NULL: read to its samples */
} Case;

static void try_case(const Case *c)
{
    OWNED(motion_free) Motion m;
    MotionHow how = c->how;
    FREED char *text = lines_of(c->head, c->per_line, c->with_times, c->scale, c->zero);
    CHECK_OK(text_form_parse(c->form ? c->form : "auto", &how.text, &err), &err);
    const Status s = motion_parse(&m, "text", text, strlen(text), &how, &err);
    if (c->says ? s != STATUS_BAD_DATA || !strstr(err.text, c->says) : s != STATUS_OK)
        fail_msg("%s %s\n  said: %s\n  wanted: %s", c->head, c->form ? c->form : "", err.text, c->says ? c->says : "");
    if (s == STATUS_OK) {
        assert_int_equal(m.n, N);
        assert_close(m.dt_s, STEP, 1e-12);
        for (int k = 0; k < N; k++)
            assert_less(fabs(m.accel[k] / 9.81 - sample(k)), 2e-6);
    }
}

#define G                                                                                                              \
    {                                                                                                                  \
        .unit = UNIT_G, .dt_s = STEP                                                                                   \
    }

TEST(rules_counts_and_words_before_numbers_are_a_header)
{
    static const Case CASES[] = {
        {"Project: made up\n=========\nTime(s) Acc(g)\n", 1, 1, 1, 0, NULL, {0}, NULL},
        {"type: accelerogram\nsampling frequency: 50.0 Hz\nunits: g\n--------------\n", 1, 0, 1, 0, NULL, {0}, NULL},
        {"A record, acceleration in g\n120 points, 0.02 s, 8 values per line\n", 8, 0, 1, 0, NULL, {0}, NULL},
        {"A record, acceleration in g\n120 samples, 0.02 sec\n", 7, 0, 1, 0, NULL, {0}, NULL},
        {"*** Site: somewhere\n***\nunits: g\n", 1, 1, 1, 0, NULL, {0}, NULL},
        {"16628 LOST CANYON RD\nunits: g, dt: 0.02\n", 1, 0, 1, 0, NULL, {0}, NULL},
        {"A record, acceleration in g\n121 points, 0.02 s\n", 1, 0, 1, 0, NULL, {0}, "announces 121 samples"},
        {"units: g, dt: 0.02\n********\n", 1, 0, 1, 0, NULL, {0}, "then '********'"}};
    for (size_t i = 0; i < sizeof CASES / sizeof CASES[0]; i++)
        try_case(&CASES[i]);
}

TEST(what_would_be_another_motion_is_refused_and_read_as_motion_text_says)
{
    static const Case CASES[] = {
        {"", 4, 1, 1, 0, NULL, {.unit = UNIT_G, .channel = "1"}, NULL}, /* its own row: one time a sample */
        {"1\n0.02\n", 1, 0, 1, 0, NULL, G, "begins with 1 and 0.02"},
        {"1\n0.02\n", 1, 0, 1, 0, "skip=2", G, NULL},
        {"0.5\n0.02\n", 1, 0, 2, 0, "skip=2,factor=0.5", G, NULL},
        {"0.1\n0.005\n", 1, 0, 1, 0, NULL, G, "look like a factor"},
        {"a title\nof two lines\n", 6, 0, 1, 0, "skip=2,per_line=6", G, NULL},
        {"a title\nof two lines\n", 6, 0, 1, 0, "skip=2,per_line=5", G,
         "has 6 numbers where motion.text says per_line=5"},
        {"", 1, 1, 1, 0, "columns=time:1,value:2", {.unit = UNIT_G}, NULL},
        {"", 1, 1, 1, 0, "columns=time:1,value:3", {.unit = UNIT_G}, "120 lines of 2 numbers; it has not what"},
        {"", 1, 1, 1.0 / 9.81, 0, "columns=time:1,value:2,factor=9.81", {.unit = UNIT_G}, NULL}};
    for (size_t i = 1; i < sizeof CASES / sizeof CASES[0]; i++)
        try_case(&CASES[i]);
}

/* t a t a ...: two to five pairs a line, the last one shorter. */
TEST(rows_of_pairs_are_refused_with_the_option_and_read_by_it)
{
    for (int pairs = 2; pairs <= 7; pairs++) {
        FREED char *text = NULL;
        size_t length;
        Motion m;
        FILE *f = open_memstream(&text, &length);
        for (int k = 0; k < N; k++)
            fprintf(f, "%.2f, %.6e%s", STEP * k, sample(k), (k + 1) % pairs && k + 1 < N ? ", " : "\n");
        fclose(f);
        for (int with_count = 0; with_count < 2; with_count++) {
            FREED char *whole = formatted("%s%s", with_count ? "# npts = 240\n# dt = 0.02 s\n" : "", text);
            MotionHow how = {.unit = UNIT_G, .channel = pairs == 2 ? "1" : NULL};
            assert_refused(motion_parse(&m, "pairs", whole, strlen(whole), &how, &err), STATUS_BAD_DATA,
                           "--text pairs=yes");
            how = (MotionHow){.unit = UNIT_G};
            CHECK_OK(text_form_parse("pairs=yes", &how.text, &err), &err);
            CHECK_OK(motion_parse(&m, "pairs", whole, strlen(whole), &how, &err), &err);
            assert_int_equal(m.n, N);
            assert_close(m.dt_s, STEP, 1e-12);
            assert_close(motion_peak(&m), PEAK_G * 9.81, 1e-6);
            motion_free(&m);
        }
    }
}

TEST(a_table_without_names_and_without_a_negative_value_is_a_spectrum)
{
    char text[4096] = "", *p = text;
    OWNED(motion_free) Motion m;
    MotionHow how = {.unit = UNIT_G};
    for (int k = 0; k < 100; k++)
        p += sprintf(p, "%.3f\t%.4f\n", 0.02 * k, 0.4 + 0.8 * exp(-0.1 * k));
    assert_refused(motion_parse(&m, "bare", text, strlen(text), &how, &err), STATUS_BAD_DATA,
                   "no value is negative, as in a spectrum");
    CHECK_OK(text_form_parse("columns=time:1,value:2", &how.text, &err), &err);
    CHECK_OK(motion_parse(&m, "bare", text, strlen(text), &how, &err), &err);
    assert_int_equal(m.n, 100);
}

TEST(the_zero_of_a_recorder_is_removed_from_counts_and_said_of_other_units)
{
    for (int with_counts = 0; with_counts < 2; with_counts++) {
        OWNED(motion_free) Motion m;
        FREED char *text = lines_of("", 1, 0, with_counts ? 4000 : 1, with_counts ? -20900 : 0.5);
        double mean = 0;
        for (int k = 0; k < N; k++)
            mean += sample(k) / N;
        const MotionHow counts = {.unit = UNIT_COUNTS, .counts_per_m_s2 = 4000 / 9.81, .dt_s = STEP}, in_g = G;
        CHECK_OK(motion_parse(&m, "zero", text, strlen(text), with_counts ? &counts : &in_g, &err), &err);
        if (with_counts) {
            assert_words(m.processed, "counts subtracted");
            assert_close(m.accel[47], 9.81 * (PEAK_G - mean), 1e-5);
        } else {
            assert_string_equal(m.processed, "");
            assert_words(m.warning, "of its peak: if that is the zero of the recorder, motion.baseline");
            assert_close(m.accel[47], 9.81 * (PEAK_G + 0.5), 1e-5);
        }
    }
}

TEST(a_text_that_is_not_understood_shows_its_first_lines_and_what_to_try)
{
    static const char HEAD[] = "37.5N 140.2E\n1995/01/17 05:46\n";
    static const Case CASES[] = {
        {HEAD, 8, 0, 1, 0, NULL, G, "'37.5N 140.2E', then '1995/01/17 05:46'; perhaps --text skip=2,per_line=8"},
        {HEAD, 1, 1, 1, 0, NULL, G, "perhaps --text skip=2,columns=time:1,value:2"},
        {HEAD, 1, 0, 1, 0, NULL, G, "perhaps --text skip=2"},
        {HEAD, 8, 0, 1, 0, "skip=2,per_line=8", G, NULL},
        {HEAD, 1, 1, 1, 0, "skip=2,columns=time:1,value:2", G, NULL},
        {HEAD, 1, 0, 1, 0, "skip=2", G, NULL}};
    for (size_t i = 0; i < sizeof CASES / sizeof CASES[0]; i++)
        try_case(&CASES[i]);
}

TEST(a_form_that_is_not_understood_is_refused_as_a_setting_and_an_option)
{
    TextForm form;
    FOR_EACH (const char *, bad, "skip", "skip=-1", "skip=1.5", "columns=2", "value:0", "factor=0", "pairs=perhaps",
              "per_line=x", "foo=1", "factor=nan", "time:1,value:1", "pairs=yes,value:2", "per_line=8,time:1")
        if (text_form_parse(*bad, &form, &err) != STATUS_BAD_DATA || !strstr(err.text, "motion.text"))
            fail_msg("%s: %s", *bad, err.text);
    expect(65, "motion.text: 'skip=x' is not understood", "spectrum builtin:kobe-like --text skip=x");
    FREED char *text = lines_of("1\n0.02\n", 1, 0, 1, 0);
    write_in_place("factor.txt", text);
    expect_output("0.25", "spectrum @/factor.txt --unit g --set motion.dt_s=0.02 --text skip=2 --json");
}

/* Inputs that were read wrongly once, where the folder that holds them is there. */
TEST(the_records_of_the_shared_cases_are_read_or_refused)
{
    static const struct {
        const char *file, *unit, *form, *channel;
        double dt_s, peak_g; /* 0: refused */
        size_t n;
        const char *says;
    } CASES[] = {{"counts_offset.txt", "counts=4000", NULL, NULL, 0.01, 392 / 4000.0 / 9.81, 300, NULL},
                 {"factor_dt_header.txt", "g", NULL, NULL, 0.01, 0, 0, "--text skip=2"},
                 {"factor_dt_header.txt", "g", "skip=2", NULL, 0.01, 0.19989, 300, NULL},
                 {"bare_spectrum.txt", "g", NULL, NULL, 0, 0, 0, "as in a spectrum"},
                 {"four_pairs.txt", "g", NULL, "1", 0, 0, 0, "--text pairs=yes"},
                 {"four_pairs.txt", "g", "pairs=yes", NULL, 0, 0.19989, 300, NULL},
                 {"sap2000_three_pairs.txt", "g", NULL, NULL, 0, 0, 0, "--text pairs=yes"},
                 {"sap2000_as_advised.txt", "g", NULL, NULL, 0, 0, 0, "--text pairs=yes"},
                 {"sap2000_three_pairs.txt", "g", "pairs=yes", NULL, 0, 0.19989, 301, NULL},
                 {"sap2000_as_advised.txt", "g", "pairs=yes", NULL, 0, 0.19989, 301, NULL},
                 {"rule_line.txt", "from_file", NULL, "E", 0, 0.19989, 300, NULL},
                 {"equal_signs.csv", "from_file", NULL, NULL, 0, 0.19989, 300, NULL},
                 {"count_line.txt", "from_file", NULL, NULL, 0, 0.19989, 300, NULL}};
    const char *folder = access("../shared/cases", F_OK) == 0 ? "../shared/cases" : "../../shared/cases";
    if (access(folder, F_OK) != 0)
        skip();
    for (size_t i = 0; i < sizeof CASES / sizeof CASES[0]; i++) {
        OWNED(motion_free) Motion m;
        MotionHow how = {.channel = CASES[i].channel, .dt_s = CASES[i].dt_s};
        FREED char *path = formatted("%s/%s", folder, CASES[i].file);
        CHECK_OK(motion_unit_parse(CASES[i].unit, &how.unit, &how.counts_per_m_s2, &err), &err);
        CHECK_OK(text_form_parse(CASES[i].form ? CASES[i].form : "auto", &how.text, &err), &err);
        const Status s = motion_read(&m, path, &how, &err);
        if (CASES[i].says ? s != STATUS_BAD_DATA || !strstr(err.text, CASES[i].says) : s != STATUS_OK)
            fail_msg("%s: %s", path, err.text);
        if (s == STATUS_OK) {
            assert_int_equal(m.n, CASES[i].n);
            assert_close(motion_peak(&m) / 9.81, CASES[i].peak_g, 1e-3);
        }
    }
}

SUITE(make_place, clear_place)
