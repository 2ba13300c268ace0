#include <stdio.h>
#include <string.h>

#include "check.h"
#include "simulator/trial.h"
#include "scene_options.h"

enum { DESIGNS = 3, N_VAR = 22 };

static Settings short_scene(const char *records, long members, const char *tolerance)
{
    Settings s;
    Err err = {0};
    char text[120];
    paper_defaults(&s);
    s.sim.duration_s = 25.0; /* tiny changes have not grown yet, wide ones tell */
    s.sim.accuracy = ACCURACY_COARSE;
    s.sim.replicates = members;
    snprintf(text, sizeof text, "motion.records=%s", records);
    CHECK_OK(settings_set(&s, text, &err), &err);
    snprintf(text, sizeof text, "sim.gap_tolerance_m=%s", tolerance);
    CHECK_OK(settings_set(&s, text, &err), &err);
    return s;
}

static void run_designs(const Settings *s, int threads, Trial out[DESIGNS])
{
    double X[DESIGNS * N_VAR];
    Trials *t;
    Err err = {0};
    for (int i = 0; i < DESIGNS; i++)
        for (int j = 0; j < N_VAR; j++)
            X[i * N_VAR + j] = j < 20 ? 0.02 + 0.03 * i + 0.002 * j : j == 20 ? 0.03 : 0.01;
    memset(out, 0, DESIGNS * sizeof *out);
    CHECK_OK(trials_open(&t, s, threads, &err), &err);
    CHECK_OK(trials_run(t, DESIGNS, X, NULL, out, NULL, &err), &err);
    trials_close(t);
}

static void test_one_member_under_one_record_is_the_simulation_itself(void **state)
{
    (void)state;
    const Settings s = short_scene("none", 1, "0");
    Trial out[DESIGNS];
    run_designs(&s, 1, out);
    for (int i = 0; i < DESIGNS; i++)
        for (int k = 0; k < N_MEASURES; k++) {
            assert_true(out[i].value[k] == measure_value(&out[i].result, k));
            assert_true(isnan(out[i].spread[k]));
        }
}

static void test_of_several_records_the_worst_or_the_mean_counts(void **state)
{
    (void)state;
    Settings one = short_scene("none", 1, "0"), other = one, both = short_scene("builtin:sylmar-like", 1, "0");
    Trial a[DESIGNS], b[DESIGNS], worst[DESIGNS], mean[DESIGNS];
    snprintf(other.motion.record, sizeof other.motion.record, "builtin:sylmar-like");
    run_designs(&one, 1, a);
    run_designs(&other, 1, b);
    run_designs(&both, 2, worst);
    both.sim.robust = ROBUST_MEAN;
    run_designs(&both, 1, mean);
    for (int i = 0; i < DESIGNS; i++)
        for (int k = 0; k < N_OBJECTIVES; k++) {
            const double x = a[i].value[k], y = b[i].value[k];
            assert_true(worst[i].value[k] == (measure(k)->sense > 0.0 ? fmax(x, y) : fmin(x, y)));
            assert_close(mean[i].value[k], 0.5 * (x + y), 1e-12);
        }
}

/* Wide gap errors spread the answers; tiny changes hardly do within a short time where gaps are wide, as in the last
 * design; the core's mass never. */
static void test_members_with_gap_errors_tell_mean_and_spread(void **state)
{
    (void)state;
    const Settings tiny = short_scene("none", 4, "0"), wide = short_scene("none", 4, "0.01");
    Trial a[DESIGNS], b[DESIGNS], again[DESIGNS];
    run_designs(&tiny, 1, a);
    run_designs(&wide, 1, b);
    run_designs(&wide, 3, again);
    for (int i = 0; i < DESIGNS; i++) {
        assert_true(a[i].spread[0] >= 0.0 && b[i].spread[0] > 0.0);
        assert_true(i < DESIGNS - 1 || b[i].spread[0] > 100.0 * a[i].spread[0]);
        assert_true(fabs(b[i].value[0] - a[i].value[0]) < 4.0 * b[i].spread[0]);
        assert_true(b[i].spread[6] <= 1e-9 * b[i].value[6]);
        assert_true(memcmp(b[i].value, again[i].value, sizeof b[i].value) == 0);
        assert_true(memcmp(b[i].spread, again[i].spread, sizeof b[i].spread) == 0);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_one_member_under_one_record_is_the_simulation_itself),
        cmocka_unit_test(test_of_several_records_the_worst_or_the_mean_counts),
        cmocka_unit_test(test_members_with_gap_errors_tell_mean_and_spread),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
