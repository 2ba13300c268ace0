/* Suites of records: what builtin:suite promises, and how folders, lists and sources are read. */
#include "program.h"

#include "motion/motion_scale.h"
#include "motion/spectrum.h"
#include "motion/suite.h"
#include "motion/synthetic.h"

/* More periods than are fitted, between them too. */
enum { PERIODS = 97 };

static double period(int i)
{
    return SUITE_SHORTEST_S * pow(SUITE_LONGEST_S / SUITE_SHORTEST_S, (double)i / (PERIODS - 1));
}

static Motion motion[SUITE_MOTIONS]; /* made once for all tests */

static int make_suite(void **state)
{
    for (int i = 0; i < SUITE_MOTIONS; i++)
        CHECK_OK(motion_load(&motion[i], brief("builtin:suite-%02d", i + 1), UNIT_FROM_FILE, &err), &err);
    return make_place(state);
}

static int end_suite(void **state)
{
    for (int i = 0; i < SUITE_MOTIONS; i++)
        motion_free(&motion[i]);
    return clear_place(state);
}

TEST(the_mean_spectrum_of_the_suite_is_within_a_tenth_of_the_code_spectrum_and_its_records_differ)
{
    double T[PERIODS], psa[PERIODS], mean[PERIODS] = {0}, log_sum[PERIODS] = {0}, log_squares[PERIODS] = {0};
    CodeSpectrum code;
    CHECK_OK(target_parse("asce7 sds=1 sd1=0.6", &code, &err), &err);
    for (int k = 0; k < PERIODS; k++)
        T[k] = period(k);
    for (int i = 0; i < SUITE_MOTIONS; i++) {
        spectrum_psa(&motion[i], 0.05, PERIODS, T, psa);
        for (int k = 0; k < PERIODS; k++) {
            mean[k] += psa[k] / SUITE_MOTIONS;
            log_sum[k] += log(psa[k]) / SUITE_MOTIONS;
            log_squares[k] += log(psa[k]) * log(psa[k]) / SUITE_MOTIONS;
        }
    }
    for (int k = 0; k < PERIODS; k++) {
        assert_close(mean[k], target_psa(&code, T[k]), 0.1);
        const double spread = sqrt(log_squares[k] - log_sum[k] * log_sum[k]);
        assert_less(0.2, spread);
        assert_less(spread, 0.5);
    }
}

TEST(the_ground_of_the_suite_ends_at_rest_where_it_began_and_no_two_motions_are_alike)
{
    uint64_t hash[SUITE_MOTIONS];
    for (int i = 0; i < SUITE_MOTIONS; i++) {
        const Motion *m = &motion[i];
        MotionFigures f;
        FREED double *v = calloc(3 * m->n, sizeof *v);
        motion_figures(m, &f);
        motion_histories(m, v, v + m->n, v + 2 * m->n);
        assert_less(fabs(v[m->n - 1]), 1e-6 * f.pgv_m_s);
        assert_less(fabs(v[2 * m->n - 1]), 1e-4 * f.pgd_m); /* samples are whole millionths */
        hash[i] = m->file_hash;
        for (int j = 0; j < i; j++)
            assert_true(hash[j] != hash[i]);
    }
}

typedef struct {
    int n;
    char source[40][OPTION_TEXT_MAX];
} Seen;

static Status see(const char *source, void *user, Err *why)
{
    Seen *s = user;
    (void)why;
    snprintf(s->source[s->n++], OPTION_TEXT_MAX, "%s", source);
    return STATUS_OK;
}

static Seen seen_of(const char *record, const char *records)
{
    static MotionOptions o;
    Seen s = {0};
    snprintf(o.record, sizeof o.record, "%s", record);
    snprintf(o.records, sizeof o.records, "%s", records);
    CHECK_OK(suite_of_study(&o, see, &s, &err), &err);
    assert_int_equal(suite_count(&o), s.n);
    return s;
}

static const char SAMPLES[] = "# dt = 0.02\naccel_m_s2\n0\n1\n-2\n1\n0\n";

TEST(a_study_has_its_first_record_once_then_those_of_its_suites_in_order)
{
    FREED char *folder = in_place("records"), *first = in_place("records/../records/b.csv");
    write_in_place("records/b.csv", SAMPLES);
    mkdir(there("records/inside"), 0777);
    write_in_place("records/a.csv", SAMPLES);
    write_in_place("records/.hidden", SAMPLES);
    Seen s = seen_of(first, folder);
    assert_int_equal(s.n, 2);
    assert_string_equal(s.source[0], first);
    assert_string_equal(s.source[1] + strlen(s.source[1]) - 6, "/a.csv");

    write_in_place("list.txt", "# two\nrecords/a.csv channel=1 factor=2.5\n\nbuiltin:kobe-like # known\n");
    s = seen_of("builtin:kobe-like", there("list.txt,builtin:elcentro-like"));
    assert_int_equal(s.n, 3);
    assert_non_null(strstr(s.source[1], "/records/a.csv channel=1 factor=2.5"));
    assert_string_equal(s.source[2], "builtin:elcentro-like");
    assert_int_equal(seen_of("builtin:suite-07", "builtin:suite").n, SUITE_MOTIONS);
    assert_int_equal(seen_of("builtin:kobe-like", "builtin:suite").n, SUITE_MOTIONS + 1);
}

TEST(a_factor_and_a_component_belong_to_their_record_alone)
{
    MotionOptions o = {.factor = 2, .stretch = 1, .unit = "from_file", .channel = "auto"};
    Motion plain = {0}, scaled = {0};
    write_in_place("two.csv", "# dt = 0.02, units: m/s2\nns,ew\n0,0\n1,3\n-2,5\n0,0\n");
    FREED char *path = in_place("two.csv");
    snprintf(o.record, sizeof o.record, "%s channel=ew factor=1.5", path);
    CHECK_OK(motion_open(&scaled, &o, &err), &err);
    CHECK_OK(motion_scale(&scaled, &o, &err), &err);
    assert_close(motion_peak(&scaled), 5 * 1.5 * 2, 1e-12);
    snprintf(o.record, sizeof o.record, "%s channel=ew", path);
    CHECK_OK(motion_open(&plain, &o, &err), &err);
    assert_true(plain.file_hash != scaled.file_hash);
    motion_free(&plain);
    motion_free(&scaled);
    o.factor = 1;
    o.pga_g = 0.3;
    snprintf(o.record, sizeof o.record, "%s channel=ew factor=1.5", path);
    CHECK_OK(motion_open(&scaled, &o, &err), &err);
    assert_refused(motion_scale(&scaled, &o, &err), STATUS_BAD_DATA, "has a factor of its own");
    motion_free(&scaled);
}

TEST(a_study_under_a_suite_is_simulated_under_all_of_it_and_notices_a_changed_list)
{
    write_in_place("study_list.txt", "builtin:sylmar-like\nbuiltin:suite-03 factor=1.5\n");
    free(output_of("optimize configs/quick.ini " SIX_FLOORS
                   "--set motion.record=builtin:elcentro-like --set sim.duration_s=4 --set motion.pga_g=0 --set "
                   "motion.records=@/study_list.txt --set sim.accuracy=coarse --set search.max_evals=4 --set "
                   "search.initial=4 --set search.population=4 --set search.polish=0 --out @/run"));
    json_auto_t *o = as_json("evaluate @/run --design knee --json");
    assert_int_equal(json_array_size(json_object_get(o, "records")), 3);
    write_in_place("study_list.txt", "builtin:sylmar-like\nbuiltin:suite-03 factor=1.6\n");
    expect(65, "does not hold what it held for the run", "evaluate @/run --design knee --json");
}

SUITE(make_suite, end_suite)
