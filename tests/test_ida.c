/* Incremental dynamic analysis: intensities, fractiles, and `imtet evaluate` over a range of peaks. */
#include "program.h"

#include "analysis/evaluations.h"

TEST(a_range_of_intensities_ends_at_its_end_in_round_numbers)
{
    double levels[IDA_LEVELS_MAX];
    size_t n;
    CHECK_OK(ida_levels("--pga", "0.05:0.05:0.6", levels, &n, &err), &err);
    assert_int_equal(n, 12);
    for (size_t i = 0; i < n; i++)
        assert_same_number(levels[i], strtod(brief("%.2f", 0.05 * (double)(i + 1)), NULL));
    CHECK_OK(ida_levels("--pga", "0.1:0.25:0.7", levels, &n, &err), &err);
    assert_int_equal(n, 3); /* 0.1, 0.35, 0.6 */
    CHECK_OK(ida_levels("--pga", "0.3:1:0.3", levels, &n, &err), &err);
    assert_int_equal(n, 1);
    FOR_EACH (const char *, bad, "0:0.1:1", "0.1:0:1", "0.5:0.1:0.4", "0.1:0.1", "0.1:0.1:1g", "a:b:c", "nan:1:2",
              "0.1:0.1:inf", "0.001:0.001:2", "1e-9:1e-18:1")
        assert_int_equal(ida_levels("--pga", *bad, levels, &n, &err), STATUS_USAGE);
}

/* n records of which J1 is as given (INFINITY: failed), one intensity. */
static double fractile_of(size_t n, const double j1[], double p)
{
    EvaluatedRecord record[8] = {0};
    FREED EvaluatedRun *run = calloc(8, sizeof *run);
    const double level = 0.3;
    for (size_t i = 0; i < n; i++) {
        run[i].record = &record[i];
        run[i].result[SCENE_IMPACT].j1_m = isfinite(j1[i]) ? j1[i] : 99;
        run[i].result[SCENE_IMPACT].outcome = isfinite(j1[i]) ? RUN_OK : RUN_NOT_FINITE;
    }
    const Evaluations e = {.n_records = n, .n_levels = 1, .record = record, .level = &level, .run = run, .n_read = n};
    return ida_fractile(&e, 0, SCENE_IMPACT, 0, p);
}

TEST(fractiles_are_straight_lines_between_the_sorted_values)
{
    const double five[] = {5, 1, 4, 2, 3};
    assert_close(fractile_of(5, five, 0.5), 3, 1e-15);
    assert_close(fractile_of(5, five, 0.16), 1.64, 1e-14);
    assert_close(fractile_of(5, five, 0.84), 4.36, 1e-14);
    assert_close(fractile_of(4, five, 0.5), 3, 1e-15);
    assert_close(fractile_of(1, five, 0.84), 5, 1e-15);
    assert_close(fractile_of(5, five, 1), 5, 1e-15);
}

TEST(a_failed_simulation_counts_as_infinite)
{
    const double values[] = {3, INFINITY, 1, 2, INFINITY};
    assert_close(fractile_of(5, values, 0.5), 3, 1e-15);
    assert_true(isinf(fractile_of(5, values, 0.84)));
    assert_true(isinf(fractile_of(5, values, 0.51)));
    assert_close(fractile_of(5, values, 0.25), 2, 1e-15);
}

/* ---- as a command ------------------------------------------------------------------------------------------------ */
#define RANGE                                                                                                          \
    "evaluate @/run --design knee --record builtin:elcentro-like --record builtin:sylmar-like --pga 0.1:0.1:0.3 "

static void make_run(void)
{
    free(output_of("optimize configs/quick.ini " SIX_FLOORS "--out @/run --max-evals 8 --set search.initial=8 --set "
                   "search.population=8 --set search.polish=0 --record builtin:elcentro-like --set sim.duration_s=4"));
}

static const json_t *record_at(const json_t *o, size_t i)
{
    return json_array_get(json_object_get(o, "records"), i);
}

static double value_at(const json_t *o, size_t i, const char *scene, const char *key)
{
    return number(json_object_get(record_at(o, i), scene), key);
}

TEST(every_record_is_simulated_at_every_intensity)
{
    json_auto_t *all = as_json(RANGE "--json");
    assert_int_equal(json_array_size(json_object_get(all, "records")), 6);
    for (size_t i = 0; i < 6; i++) {
        json_auto_t *one = as_json("evaluate @/run --design knee --record builtin:%s --pga 0.%zu --json",
                                   i < 3 ? "elcentro-like" : "sylmar-like", i % 3 + 1);
        assert_close(number(record_at(all, i), "pga_g"), 0.1 * (double)(i % 3 + 1), 1e-12);
        static const char *const KEYS[] = {"with_core", "rigid", "no_core"};
        for (int c = 0; c < 3; c++)
            assert_same_number(value_at(all, i, KEYS[c], "j3_g"), value_at(one, 0, KEYS[c], "j3_g"));
    }
}

TEST(scenes_without_impacts_grow_in_proportion)
{
    json_auto_t *o = as_json(RANGE "--json");
    for (size_t i = 1; i < 3; i++) {
        assert_close(value_at(o, i, "no_core", "j1_m"), (double)(i + 1) * value_at(o, 0, "no_core", "j1_m"), 1e-9);
        assert_close(value_at(o, i, "rigid", "j2_m"), (double)(i + 1) * value_at(o, 0, "rigid", "j2_m"), 1e-6);
    }
}

TEST(the_csv_has_every_run_and_the_fractiles_at_any_number_of_threads)
{
    free(output_of(RANGE "--csv @/one.csv --threads 1"));
    free(output_of(RANGE "--csv @/three.csv --threads 3"));
    static const char *const FILES[][2] = {{"one.csv", "three.csv"}, {"one-fractiles.csv", "three-fractiles.csv"}};
    for (int i = 0; i < 2; i++) {
        FREED char *one = read_in_place(FILES[i][0]), *three = read_in_place(FILES[i][1]);
        assert_string_equal(one, three);
        assert_int_equal(count(one, "\n"), i ? 1 + 3 * 3 * 3 : 1 + 2 * 3 * 3);
        assert_int_equal(count(one, "\nmedian,"), i ? 9 : 0);
        assert_true((strstr(one, "\nbuiltin:sylmar-like,rigid,ok,0.2,") != NULL) == (i == 0));
    }
}

TEST(the_table_and_the_picture_show_the_three_scenes)
{
    assert_words_in(output_of(RANGE), "with core, 2 records: median", "rigidly connected, 2 records", "no core, 2");
    if (has_browser()) {
        free(output_of(RANGE "--svg @/ida.svg"));
        FREED char *svg = read_in_place("ida.svg");
        assert_words(svg, "rigidly connected: median, 16 and 84 %", "</svg>");
    }
}

TEST(a_range_does_not_go_with_another_scaling)
{
    expect(2, "motion.sa_g does not go with it", RANGE "--set motion.sa_g=0.5");
    expect(2, "a range is FROM:STEP:TO", "evaluate @/run --design knee --pga 0.1:0.1");
    expect(2, "--svg draws an incremental dynamic analysis", "evaluate @/run --design knee --svg @/no.svg");
    expect(65, "motion.pga_g", "evaluate @/run --design knee --pga 0.3 --set motion.factor=2");
}

TEST(names_of_records_are_whole_and_rows_go_to_csv)
{
    static const char NAME[] = "a_record_with_a_name_that_is_much_longer_than_forty_characters.csv";
    write_in_place(brief("many/%s", NAME), "t,a_m_s2\n0,0\n0.02,1\n0.04,-2\n0.06,1\n0.08,0.5\n");
    write_in_place("many/b.csv", "t,a_m_s2\n0,0\n0.02,1\n0.04,oops\n");
    assert_words_in(output_of("evaluate @/run --design knee --record @/many"),
                    "a_record_with_a_name_that_is_much_longer_than_forty_characters.csv  no core", "not read: ");
    free(output_of("evaluate @/run --design knee --record @/many --csv @/rows.csv"));
    assert_words_in(read_in_place("rows.csv"), NAME, ",no_core,ok,");
}

/* Of the only record, in the row of the design; the other scenes have none. */
TEST(the_csv_has_mean_and_deviation_of_the_replicates_as_the_json_has)
{
#define REPLICATED "evaluate @/run --design knee --set sim.gap_tolerance_m=0.01 "
    json_auto_t *o = as_json(REPLICATED "--replicates 3 --json");
    const json_t *r = json_object_get(record_at(o, 0), "replicates");
    free(output_of(REPLICATED "--set sim.replicates=3 --csv @/replicates.csv"));
    FREED char *text = read_in_place("replicates.csv");
    char *rest = text, *header = strsep(&rest, "\n"), *row = strsep(&rest, "\n"), *rigid = strsep(&rest, "\n");
    char *name, *cell;
    int n = 0;
    assert_non_null(strstr(row, ",1,3,mean,as built,"));
    assert_non_null(strstr(rigid, ",,,,,,,,"));
    while ((name = strsep(&header, ",")) && (cell = strsep(&row, ","))) {
        const char *end = strrchr(name, '_');
        const int is_mean = end && strcmp(end, "_mean") == 0, is_sd = end && strcmp(end, "_sd") == 0;
        if (!is_mean && !is_sd)
            continue;
        FREED char *key = formatted("%.*s", (int)(end - name), name);
        const json_t *wanted = json_object_get(json_object_get(r, is_mean ? "mean" : "sd"), key);
        n += json_is_number(wanted);
        assert_true(json_is_number(wanted) ? strtod(cell, NULL) == json_number_value(wanted) : !*cell);
    }
    assert_less(20, n);
    expect_output("  mean of 3, sd as built", REPLICATED "--replicates 3 --record @/many");
    expect(2, "every intensity is simulated once", RANGE "--set sim.replicates=3");
}

SUITE_FILLED(make_place, make_run, clear_place)
