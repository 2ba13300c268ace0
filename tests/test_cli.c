/* The program as a person meets it: runs $IMTET in the repository's root and reads what it prints. */
#include "check.h"

#include <jansson.h>
#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include "program.h"

/* A design file of 20 floors: gap_j = gap * j. */
static void write_designs(const char *name, int n, const double gap[], const double t_base[], const double t_top[])
{
    char *text = NULL;
    size_t length = 0;
    FILE *f = open_memstream(&text, &length);
    for (int j = 1; j <= 20; j++)
        fprintf(f, "gap_%02d_m,", j);
    fprintf(f, "t_base_m,t_top_m\n");
    for (int i = 0; i < n; i++) {
        for (int j = 1; j <= 20; j++)
            fprintf(f, "%.17g,", gap[i] * j);
        fprintf(f, "%.17g,%.17g\n", t_base[i], t_top[i]);
    }
    fclose(f);
    write_in_place(name, text);
    free(text);
}

/* ---------------------------------------------------------------------------------------------- help and usage --- */

static void test_every_command_explains_itself_with_an_example_first(void **state)
{
    (void)state;
    static const char *const COMMANDS[] = {"",      "optimize", "simulate", "evaluate", "export",
                                           "modes", "spectrum", "check",    "settings"};
    for (size_t i = 0; i < sizeof COMMANDS / sizeof COMMANDS[0]; i++) {
        char arguments[64];
        snprintf(arguments, sizeof arguments, "%s --help", COMMANDS[i]);
        char *help = output_of(arguments);
        assert_int_equal(strncmp(help, "example: imtet ", 15), 0);
        assert_non_null(strstr(help, "usage: imtet"));
        free(help);
    }
    char *version = output_of("--version");
    assert_int_equal(strncmp(version, "imtet ", 6), 0);
    free(version);
}

static void test_a_misunderstood_command_line_ends_with_2_and_a_suggestion(void **state)
{
    (void)state;
    expect(2, "no command", "");
    expect(2, "did you mean optimize?", "optimise configs/quick.ini");
    expect(2, "did you mean --design?", "simulate configs/quick.ini --desing none");
    expect(2, "did you mean --json?", "modes configs/quick.ini --jsno");
    expect(2, "--help", "modes configs/quick.ini --qqqqqqqqqqqqqqqqqqqqqqqq");
    expect(2, "needs a CONFIG", "modes");
    expect(2, "takes one CONFIG", "modes configs/quick.ini configs/kobe.ini");
    expect(2, "takes no operand", "settings configs/quick.ini");
    expect(2, "--record needs a value", "simulate configs/quick.ini --record");
    expect(2, "--record needs a value", "simulate configs/quick.ini --record --json");
    expect(2, "--json takes no value", "modes configs/quick.ini --json=yes");
    expect(2, "given twice", "simulate configs/quick.ini --pga 1 --pga 2");
    expect(2, "--design FILE is missing", "simulate configs/quick.ini");
    expect(2, "--tied needs a core", "simulate configs/quick.ini --design none --tied");
    expect(2, "--set nonsense: write --set section.key=value", "modes configs/quick.ini --set nonsense");
    expect(2, "--csv FILE is missing", "export results");
    expect(2, "--record FILE is missing", "evaluate results --design 1");
}

static void test_bad_settings_and_data_end_with_65(void **state)
{
    (void)state;
    expect(65, "did you mean motion.stretch?", "modes configs/quick.ini --set motion.strech=2");
    expect(65, "--pga: motion.pga_g: -1 is outside", "simulate configs/quick.ini --design none --pga -1");
    expect(65, "not one of fast|cvode|", "simulate configs/quick.ini --design none --engine magic");
    expect(65, "tests/bad/config/nan.ini:3: building.damping", "modes tests/bad/config/nan.ini");
    expect(65, "tests/bad/motion/nan.csv",
           "simulate configs/quick.ini --design none --record tests/bad/motion/nan.csv");
    expect(65, "tests/bad/motion/nan.csv", "spectrum tests/bad/motion/nan.csv");
    expect(65, "a design of 20 floors has gap_03_m there",
           "simulate configs/quick.ini --design tests/bad/design/negative_gap.csv");
}

static void test_missing_inputs_end_with_66(void **state)
{
    (void)state;
    expect(66, "nowhere.ini", "modes nowhere.ini");
    expect(66, "nowhere.csv", "simulate configs/quick.ini --design nowhere.csv");
    expect(66, "nowhere.csv", "simulate configs/quick.ini --design none --record nowhere.csv");
    expect(66, "nowhere.csv", "spectrum nowhere.csv");
    expect(66, "nowhere", "export nowhere --csv @/front.csv");
    expect(66, "nowhere", "evaluate nowhere --design 1 --record builtin:kobe-like");
}

static void test_output_that_cannot_be_written_ends_with_74(void **state)
{
    (void)state;
    expect(74, "/dev/full", "spectrum builtin:kobe-like --csv /dev/full");
    expect(74, "/no/such/folder/a.csv", "spectrum builtin:kobe-like --csv @/no/such/folder/a.csv");
    expect(74, "standard output", "settings >/dev/full");
    expect(74, "standard output", "spectrum builtin:kobe-like --json >/dev/full");
    expect(74, "configs/quick.ini/run", "optimize configs/quick.ini --out configs/quick.ini/run");
}

/* -------------------------------------------------------------------------------------------- settings and check ---
 */

static void test_the_printed_settings_are_the_default_file_and_in_order(void **state)
{
    (void)state;
    char *printed = output_of("settings"), *kept = text_of("configs/default.ini");
    if (strcmp(printed, kept) != 0)
        fail_msg("they differ; if the settings were meant to change: imtet settings > configs/default.ini");
    write_in_place("printed.ini", printed);
    free(output_of("check @/printed.ini"));
    free(output_of("check configs/quick.ini"));
    free(printed);
    free(kept);
}

static void test_check_names_every_fault_at_once(void **state)
{
    (void)state;
    write_in_place("many.ini", "[motion]\nrecord = not-there.csv\npga_g = nan\nstretc = 3\n[core]\nsection = tube\n"
                               "[building]\nmodel = /not/there\n");
    Said s;
    run(&s, "check @/many.ini --set search.sead=3");
    assert_int_equal(s.code, 65);
    static const char *const WANTED[] = {"many.ini:3: motion.pga_g",
                                         "many.ini:4: motion.stretc",
                                         "many.ini:6: core.section",
                                         "did you mean search.seed?",
                                         "not-there.csv",
                                         "/not/there",
                                         "6 faults"};
    for (size_t i = 0; i < sizeof WANTED / sizeof WANTED[0]; i++)
        if (!strstr(s.err, WANTED[i]))
            fail_msg("'%s' is not in: %s", WANTED[i], s.err);
    forget(&s);
}

/* ------------------------------------------------------------------------------------------------- one-shot answers
 * --- */

static void check_hz(const json_t *o, const char *key, size_t n, const double want[], double tolerance)
{
    const json_t *list = json_object_get(o, key);
    assert_true(json_array_size(list) == 20);
    for (size_t i = 0; i < n; i++)
        assert_close(json_real_value(json_array_get(list, i)), want[i], tolerance);
}

/* Frequencies of the condensed frame and of the 12 to 6.4 mm box, computed independently. */
static void test_modes_of_tower_and_box_core_are_known(void **state)
{
    (void)state;
    json_t *o = json_of("modes configs/default.ini --json");
    check_hz(o, "building_hz", 5, (const double[]){0.2643, 0.7599, 1.3113, 1.8448, 2.4209}, 1e-3);
    check_hz(o, "core_hz", 5, (const double[]){2.492, 13.64, 36.69, 71.11, 117.0}, 1e-3);
    assert_close(number(o, "core_mass_kg"), 2.650e5, 1e-3);
    json_decref(o);
}

/* Table 1 of the paper, printed to 0.01 Hz. */
static void test_modes_of_the_effective_core_are_those_of_the_paper(void **state)
{
    (void)state;
    json_t *o = json_of("modes configs/default.ini --json --set building.model=appendix --set core.section=effective");
    const json_t *core = json_object_get(o, "core_hz"), *tied = json_object_get(o, "zero_gap_hz");
    static const double CORE[] = {2.29, 13.22, 36.19, 70.49, 116.25}, TIED[] = {0.75, 4.29, 11.82, 23.08, 38.12};
    for (size_t i = 0; i < 5; i++) {
        assert_true(fabs(json_real_value(json_array_get(core, i)) - CORE[i]) < 0.006);
        assert_true(fabs(json_real_value(json_array_get(tied, i)) - TIED[i]) < 0.006);
    }
    json_decref(o);
}

static void test_modes_take_the_wall_from_a_design(void **state)
{
    (void)state;
    write_designs("wall.csv", 1, (double[]){0.01}, (double[]){0.012}, (double[]){0.0064});
    char *plain = output_of("modes configs/quick.ini"),
         *given = output_of("modes configs/quick.ini --design @/wall.csv");
    assert_string_equal(plain, given);
    free(plain);
    free(given);
}

static void test_the_spectrum_is_the_same_as_json_and_as_csv(void **state)
{
    (void)state;
    Err err = {0};
    Table t;
    json_t *o = json_of("spectrum builtin:kobe-like --pga 0.3 --stretch 3.1 --json --csv @/spectrum.csv");
    char *path = in_place("spectrum.csv");
    CHECK_OK(table_read(&t, path, 1, &err), &err);
    assert_close(number(o, "pga_g"), 0.3, 1e-12);
    const json_t *psa = json_object_get(o, "psa_m_s2");
    assert_int_equal(json_array_size(psa), t.n_rows);
    for (size_t i = 0; i < t.n_rows; i++)
        assert_true(json_real_value(json_array_get(psa, i)) == t.values[i * t.n_cols + 1]);
    table_free(&t);
    free(path);
    json_decref(o);
}

/* Husid's curve ends at 1, velocity and displacement reach the peaks of the table. */
static void test_the_histories_reach_the_figures_of_the_motion(void **state)
{
    (void)state;
    Err err = {0};
    Table t;
    json_t *o = json_of("spectrum tests/motion/jma.csv --channel EW --json --history @/history.csv");
    char *path = in_place("history.csv");
    CHECK_OK(table_read(&t, path, 1, &err), &err);
    assert_int_equal(t.n_rows, 43);
    assert_int_equal(t.n_cols, 5);
    assert_string_equal(json_string_value(json_object_get(o, "format")), "jma");
    assert_string_equal(json_string_value(json_object_get(o, "channel")), "EW");
    assert_close(number(o, "pga_m_s2"), 0.987, 1e-12);
    double largest[5] = {0};
    for (size_t i = 0; i < t.n_rows; i++)
        for (size_t j = 0; j < t.n_cols; j++)
            largest[j] = fmax(largest[j], fabs(t.values[i * t.n_cols + j]));
    assert_close(largest[0], number(o, "duration_s"), 1e-12);
    assert_close(largest[1], number(o, "pga_m_s2"), 1e-12);
    assert_close(largest[2], number(o, "pgv_m_s"), 0.05); /* its peak lies between samples */
    assert_close(largest[3], number(o, "pgd_m"), 0.05);
    assert_close(t.values[t.n_rows * t.n_cols - 1], 1, 1e-12);
    table_free(&t);
    free(path);
    json_decref(o);
}

static void test_the_picture_of_a_motion_is_whole_or_not_there(void **state)
{
    (void)state;
    if (system("command -v gnuplot >/dev/null") == 0) {
        free(output_of("spectrum tests/motion/one.esm --svg @/motion.svg"));
        char *svg = read_in_place("motion.svg");
        assert_non_null(strstr(svg, "tests/motion/one.esm, HNE: 0.126 g"));
        assert_non_null(strstr(svg, "</svg>"));
        free(svg);
    }
    assert_int_equal(setenv("IMTET_PATH", getenv("PATH"), 1), 0);
    setenv("PATH", "/nowhere", 1);
    expect(66, "gnuplot, which draws it, cannot be started; install it", "spectrum builtin:kobe-like --svg @/none.svg");
    setenv("PATH", getenv("IMTET_PATH"), 1);
    char *path = in_place("none.svg");
    assert_int_equal(access(path, F_OK), -1);
    free(path);
}

/* A short stretch of shaking: enough for some hundred impacts, short enough for a test. */
#define SHORT " --set motion.stretch=1 --set sim.duration_s=8 "

static void test_simulate_gives_the_same_numbers_as_json_and_as_csv(void **state)
{
    (void)state;
    static const char *const KEYS[] = {"j1_m",     "j2_m",     "j3_g",           "ed1_pct",         "ed5_10_pct",
                                       "edcs_pct", "mcore_kg", "input_energy_j", "energy_residual", "impacts"};
    write_designs("two.csv", 2, (double[]){0.001, 0.004}, (double[]){0.012, 0.03}, (double[]){0.0064, 0.01});
    json_t *list = json_of("simulate configs/quick.ini" SHORT "--design @/two.csv --json");
    free(output_of("simulate configs/quick.ini" SHORT "--design @/two.csv --csv @/results.csv"));
    char *csv = read_in_place("results.csv"), *line = csv, *rest = csv;
    char *streamed = output_of("simulate configs/quick.ini" SHORT "--design @/two.csv --csv -");
    assert_string_equal(streamed, csv);
    free(streamed);
    assert_int_equal(json_array_size(list), 2);
    line = strsep(&rest, "\n");
    assert_string_equal(line,
                        "design,j1_m,j2_m,j3_g,ed1_pct,ed5_10_pct,edcs_pct,mcore_kg,input_energy_j,energy_residual,"
                        "impacts,outcome");
    for (size_t i = 0; i < 2; i++) {
        const json_t *o = json_array_get(list, i);
        assert_string_equal(json_string_value(json_object_get(o, "outcome")), "ok");
        assert_int_equal(json_array_size(json_object_get(o, "peak_drift_m")), 20);
        line = strsep(&rest, "\n");
        assert_int_equal(strtol(strsep(&line, ","), NULL, 10), (long)i + 1);
        for (size_t k = 0; k < 10; k++)
            assert_true(strtod(strsep(&line, ","), NULL) == number(o, KEYS[k]));
        assert_string_equal(line, "ok");
        assert_true(number(o, "impacts") > 0);
    }
    free(csv);
    json_decref(list);
}

static void test_the_building_alone_and_the_tied_one_have_no_impacts(void **state)
{
    (void)state;
    write_designs("one.csv", 1, (double[]){0.002}, (double[]){0.012}, (double[]){0.0064});
    json_t *alone = json_of("simulate configs/quick.ini" SHORT "--design none --json");
    json_t *tied = json_of("simulate configs/quick.ini" SHORT "--design @/one.csv --tied --json");
    assert_true(number(alone, "impacts") == 0 && number(tied, "impacts") == 0);
    assert_true(number(alone, "mcore_kg") == 0);
    assert_close(number(tied, "mcore_kg"), 2.650e5, 1e-3);
    json_decref(alone);
    json_decref(tied);
}

static void test_a_top_heavy_design_is_simulated_with_a_warning(void **state)
{
    (void)state;
    write_designs("top.csv", 1, (double[]){0.002}, (double[]){0.006}, (double[]){0.012});
    Said s;
    run(&s, "simulate configs/quick.ini" SHORT "--design @/top.csv");
    assert_int_equal(s.code, 0);
    assert_non_null(strstr(s.err, "top.csv:2: t_top_m 0.012 is thicker than t_base_m 0.006"));
    forget(&s);
}

/* ------------------------------------------------------------------------------------------------------- the study ---
 */

#define SMALL_STUDY_OF(max_evals)                                                                                      \
    "optimize configs/quick.ini --set motion.stretch=1 --set sim.duration_s=4 --set search.initial=28 "                \
    "--set search.population=16 --max-evals " #max_evals " "
#define SMALL_STUDY SMALL_STUDY_OF(40)

static void test_the_front_has_the_same_bytes_at_any_number_of_threads(void **state)
{
    (void)state;
    static const int THREADS[] = {1, 2, 5};
    char arguments[512], name[64], *front[3], *all[3];
    for (int i = 0; i < 3; i++) {
        snprintf(arguments, sizeof arguments, SMALL_STUDY "--threads %d --out @/threads-%d", THREADS[i], THREADS[i]);
        free(output_of(arguments));
        snprintf(name, sizeof name, "threads-%d/front.csv", THREADS[i]);
        front[i] = read_in_place(name);
        snprintf(name, sizeof name, "threads-%d/evaluations.csv", THREADS[i]);
        all[i] = read_in_place(name);
    }
    for (int i = 1; i < 3; i++) {
        assert_string_equal(front[0], front[i]);
        assert_string_equal(all[0], all[i]);
        free(front[i]);
        free(all[i]);
    }
    free(front[0]);
    free(all[0]);
}

static void test_a_run_is_repeated_from_its_own_folder(void **state)
{
    (void)state;
    free(output_of("optimize @/threads-2/settings.ini --out @/again"));
    char *first = read_in_place("threads-2/front.csv"), *second = read_in_place("again/front.csv");
    assert_string_equal(first, second);
    free(first);
    free(second);
    char *path = in_place("again/provenance.json");
    json_t *o = json_load_file(path, 0, NULL);
    assert_non_null(o);
    assert_true(json_integer_value(json_object_get(o, "seed")) == 1);
    assert_non_null(json_object_get(json_object_get(o, "libraries"), "sundials"));
    assert_int_equal(json_string_length(json_object_get(json_object_get(o, "inputs"), "record_fnv1a")), 16);
    json_decref(o);
    free(path);
}

static int dominates(const double a[7], const double b[7])
{
    static const double SENSE[] = {1, 1, 1, 1, -1, -1, 1};
    int better = 0;
    for (int k = 0; k < 7; k++) {
        if (SENSE[k] * a[k] > SENSE[k] * b[k])
            return 0;
        better = better || a[k] != b[k];
    }
    return better;
}

static void test_the_front_holds_nondominated_designs_in_the_search_box(void **state)
{
    (void)state;
    Err err = {0};
    Table t;
    char *path = in_place("threads-1/front.csv");
    CHECK_OK(table_read(&t, path, 1, &err), &err);
    assert_int_equal(t.n_cols, 1 + 22 + 7);
    for (size_t i = 0; i < t.n_rows; i++) {
        const double *a = t.values + i * t.n_cols;
        for (int j = 1; j <= 20; j++)
            assert_true(a[j] >= 0.001 && a[j] <= 0.5);
        assert_true(a[22] <= a[21] && a[22] >= 0.004 && a[21] <= 0.04);
        for (size_t l = 0; l < t.n_rows; l++)
            assert_false(dominates(t.values + l * t.n_cols + 23, a + 23));
    }
    table_free(&t);
    free(path);
}

static void test_a_run_that_is_finished_is_shown_again_and_a_new_one_gets_a_number(void **state)
{
    (void)state;
    Said s;
    char *before = read_in_place("threads-1/front.csv");
    run(&s, SMALL_STUDY "--threads 2 --out @/threads-1");
    assert_int_equal(s.code, 0);
    assert_non_null(strstr(s.out, "finished before"));
    forget(&s);
    char *after = read_in_place("threads-1/front.csv");
    assert_string_equal(before, after);
    run(&s, SMALL_STUDY "--new --set run.out=@/threads-1");
    assert_int_equal(s.code, 0);
    assert_non_null(strstr(s.out, "threads-1-2/front.csv"));
    forget(&s);
    free(before);
    free(after);
}

static void test_the_export_is_the_front(void **state)
{
    (void)state;
    free(output_of("export @/threads-1 --csv @/exported.csv"));
    char *front = read_in_place("threads-1/front.csv"), *exported = read_in_place("exported.csv");
    assert_string_equal(front, exported);
    free(front);
    free(exported);
}

static long first_id(const char *front)
{
    return strtol(strchr(front, '\n') + 1, NULL, 10);
}

static void test_a_design_of_the_front_is_evaluated_on_other_motions(void **state)
{
    (void)state;
    char *front = read_in_place("threads-1/front.csv"), arguments[256];
    snprintf(arguments, sizeof arguments,
             "evaluate @/threads-1 --design %ld --record builtin:kobe-like --record builtin:elcentro-like --json",
             first_id(front));
    json_t *o = json_of(arguments);
    const json_t *records = json_object_get(o, "records");
    assert_int_equal(json_array_size(records), 2);
    assert_string_equal(json_string_value(json_object_get(json_array_get(records, 1), "record")),
                        "builtin:elcentro-like");

    /* on the motion of the run itself: the numbers of the front, in its first objective's column */
    const char *row = strchr(front, '\n') + 1;
    for (int i = 0; i < 23; i++)
        row = strchr(row, ',') + 1;
    const json_t *own = json_array_get(records, 0);
    assert_true(number(json_object_get(own, "with_core"), "j1_m") == strtod(row, NULL));
    assert_true(number(json_object_get(own, "no_core"), "impacts") == 0);
    json_decref(o);
    free(front);
    expect(65, "no such id on the front", "evaluate @/threads-1 --design 123456 --record builtin:kobe-like");
    char *table = output_of("evaluate @/threads-1 --design knee --record builtin:sylmar-like");
    assert_non_null(strstr(table, "no core"));
    free(table);
}

static void test_a_design_is_evaluated_on_every_motion_of_a_folder(void **state)
{
    (void)state;
    json_t *o = json_of("evaluate @/threads-1 --design knee --records tests/motion --channel 1 --pga 0.3 --json");
    const json_t *records = json_object_get(o, "records"), *unreadable = json_object_get(o, "unreadable");
    assert_int_equal(json_array_size(records), 20);
    assert_int_equal(json_array_size(unreadable), 1);
    for (size_t i = 0; i + 1 < json_array_size(records); i++)
        assert_true(strcmp(json_string_value(json_object_get(json_array_get(records, i), "record")),
                           json_string_value(json_object_get(json_array_get(records, i + 1), "record"))) < 0);
    const json_t *one = json_array_get(unreadable, 0);
    assert_string_equal(json_string_value(json_object_get(one, "record")), "tests/motion/irregular.csv");
    assert_non_null(strstr(json_string_value(json_object_get(one, "reason")), "irregular.csv:26: time 0.24 s breaks"));
    json_decref(o);
    char *table = output_of("evaluate @/threads-1 --design knee --records tests/motion --channel 1");
    assert_non_null(strstr(table, "one.knet          no core"));
    assert_non_null(strstr(table, "not read: tests/motion/irregular.csv:26"));
    free(table);
    expect(65, "holds no ground motion that can be read", "evaluate @/threads-1 --design knee --records configs/sac20");
    expect(66, "nowhere", "evaluate @/threads-1 --design knee --records nowhere");
}

/* kill -9 as soon as there is a front; most of the 4000 simulations are still to come. */
static void test_a_run_that_is_killed_leaves_its_last_finished_generation(void **state)
{
    (void)state;
    Said s;
    run(&s, "%s",
        SMALL_STUDY_OF(4000) "--threads 1 --out @/killed & n=0; "
                             "while [ ! -s @/killed/front.csv ] && [ $n -lt 1200 ]; do n=$((n+1)); sleep 0.05; done; "
                             "kill -9 $! && ! wait $!");
    if (s.code != 0)
        fail_msg("exit %d, said: %s", s.code, s.err);
    forget(&s);
    free(output_of("export @/killed --csv @/rescued.csv"));
    char *front = read_in_place("rescued.csv"), *all = read_in_place("killed/evaluations.csv"), *row = front;
    assert_int_equal(front[strlen(front) - 1], '\n');
    while ((row = strchr(row, '\n')) && row[1]) { /* each design of the front is among the simulations */
        char start[96];
        snprintf(start, sizeof start, "\n%ld,", strtol(++row, NULL, 10));
        assert_non_null(strstr(all, start));
    }
    free(front);
    free(all);
    free(output_of("evaluate @/killed --design knee --record builtin:elcentro-like --duration 4"));
}

/* ------------------------------------------------------------------------------------------- another building --- */

/* A shear building of five floors, all alike: its circular frequencies are 2 sqrt(k/m) sin((2i - 1) pi / 22). */
static void write_five_floors(double k, double m)
{
    char stiffness[512] = "", mass[512] = "";
    size_t nk = 0, nm = 0;
    for (int i = 0; i < 5; i++)
        for (int j = 0; j < 5; j++) {
            const double v = i == j ? (i < 4 ? 2 * k : k) : abs(i - j) == 1 ? -k : 0;
            nk += (size_t)snprintf(stiffness + nk, sizeof stiffness - nk, "%g%s", v, j < 4 ? "," : "\n");
            nm += (size_t)snprintf(mass + nm, sizeof mass - nm, "%g%s", i == j ? m : 0, j < 4 ? "," : "\n");
        }
    char *folder = in_place("five");
    assert_int_equal(mkdir(folder, 0777), 0);
    free(folder);
    write_in_place("five/K.csv", stiffness);
    write_in_place("five/M.csv", mass);
    write_in_place("five.ini", "[building]\nmodel = five\nfirst_storey_m = 4\nstorey_m = 3\n[core]\nside_m = 5\n"
                               "[motion]\nstretch = 1\n[sim]\nduration_s = 15\n"
                               "[search]\ninitial = 20\npopulation = 12\nmax_evals = 30\n");
    write_in_place("five.csv", "gap_01_m,gap_02_m,gap_03_m,gap_04_m,gap_05_m,t_base_m,t_top_m\n"
                               "0.01,0.02,0.03,0.04,0.05,0.012,0.0064\n");
}

static void test_a_building_of_five_floors_goes_all_the_way(void **state)
{
    (void)state;
    const double k = 4e8, m = 6e5;
    write_five_floors(k, m);
    free(output_of("check @/five.ini"));
    json_t *o = json_of("modes @/five.ini --json");
    for (int i = 0; i < 5; i++)
        assert_close(json_real_value(json_array_get(json_object_get(o, "building_hz"), (size_t)i)),
                     sqrt(k / m) * sin((2 * i + 1) * M_PI / 22) / M_PI, 1e-9);
    json_decref(o);

    json_t *fast = json_of("simulate @/five.ini --design @/five.csv --set sim.accuracy=fine --json");
    json_t *slow = json_of("simulate @/five.ini --design @/five.csv --engine cvode --json");
    assert_int_equal(json_array_size(json_object_get(fast, "peak_drift_m")), 5);
    assert_true(number(fast, "impacts") > 10);
    assert_close(number(fast, "j1_m"), number(slow, "j1_m"), 1e-3);
    json_decref(fast);
    json_decref(slow);

    free(output_of("optimize @/five.ini --out @/five.run"));
    char *front = read_in_place("five.run/front.csv");
    assert_int_equal(strncmp(front, "id,gap_01_m,gap_02_m,gap_03_m,gap_04_m,gap_05_m,t_base_m,", 57), 0);
    free(front);
    free(output_of("evaluate @/five.run --design knee --record builtin:elcentro-like"));
    expect(65, "a design of 20 floors has gap_06_m there", "simulate configs/quick.ini --design @/five.csv");
}

/* ------------------------------------------------------------------------------------------- problems of others ---
 */

static const char EXTERNAL_INI[] = "[problem]\nkind = external\ncommand = sh tests/worker.sh dies\nvariables = 3\n"
                                   "objectives = 2\nsenses = min,max\n[search]\nmax_evals = 45\ninitial = 30\n"
                                   "population = 12\n";

static void test_an_external_simulator_is_searched_and_every_design_exported(void **state)
{
    (void)state;
    Table t;
    Err err = {0};
    write_in_place("external.ini", EXTERNAL_INI);
    free(output_of("check @/external.ini"));
    char *said = output_of("optimize @/external.ini --out @/external --threads 2");
    assert_non_null(strstr(said, "best f2"));
    free(said);
    free(output_of("export @/external --csv @/front.csv"));
    free(output_of("export @/external --all --csv @/all.csv"));
    char *path = in_place("front.csv"), *all = read_in_place("all.csv");
    CHECK_OK(table_read(&t, path, 1, &err), &err);
    for (size_t i = 0; i < t.n_rows; i++) {
        const double *row = t.values + i * t.n_cols;
        assert_true(row[1] == row[4] && row[2] == row[5]); /* f = (x1, x2) */
    }
    int lines = 0, dead = 0;
    for (char *line = all; *line; line = strchr(line, '\n') + 1)
        lines++;
    for (char *at = all; (at = strstr(at, ",dead,the worker ended")); at++)
        dead++;
    assert_int_equal(lines, 46);
    assert_int_equal(dead, 15); /* every third of 45 */
    table_free(&t);
    free(path);
    free(all);
    expect(65, "another problem", "evaluate @/external --design knee --record builtin:kobe-like");
    expect(65, "no-such-program", "optimize @/external.ini --out @/none --set problem.command=no-such-program");
    expect(65, "problem.command", "optimize @/external.ini --out @/none --set problem.command=none");
}

/* The external run of the test before: f = (x1 min, x2 max). */
static void test_designs_are_chosen_by_limits_weights_and_wishes_and_polished(void **state)
{
    (void)state;
    free(output_of("optimize @/external.ini --out @/kind --set 'problem.command=sh tests/worker.sh good'"));
    char *said = output_of("choose @/kind --max f1=0.9 --min f2=0.1 --weights f1=1 --wish f1=0,f2=1");
    assert_non_null(strstr(said, "knee"));
    assert_non_null(strstr(said, "weighted"));
    assert_non_null(strstr(said, "nearest wish"));
    free(said);
    expect(65, "no design of the front is within the limits", "choose @/kind --max f1=-5");
    expect(2, "speed is no objective", "choose @/kind --max speed=5");
    expect(2, "is not NAME=NUMBER", "choose @/kind --weights f1");

    /* With nothing kept x1 = 0 is the best there is; with all kept nothing may change on this front. */
    free(output_of("polish @/kind --design knee --improve f1 --keep f1 --evals 120 --csv @/polished.csv"));
    Table t;
    Err err = {0};
    char *path = in_place("polished.csv");
    CHECK_OK(table_read(&t, path, 1, &err), &err);
    assert_true(t.values[4] < 0.01 && t.values[4] == t.values[1]);
    table_free(&t);
    free(path);
    expect(65, "no such id", "polish @/kind --design 999999");
    expect(2, "no algorithm is called", "polish @/kind --design knee --algorithm magic");
}

/* The first simulations of the second run are the front of the first one; a choice of three begins with the knee. */
static void test_a_search_begins_with_given_designs_and_a_front_is_thinned(void **state)
{
    (void)state;
    write_in_place("sphere.ini", "[problem]\nkind = dtlz2\nvariables = 4\nobjectives = 3\n"
                                 "[search]\nmax_evals = 45\ninitial = 30\npopulation = 12\n");
    free(output_of("optimize @/sphere.ini --out @/earlier"));
    free(output_of("optimize @/sphere.ini --out @/later --set search.start=@/earlier"));
    free(output_of("export @/later --all --csv @/all.csv"));
    free(output_of("export @/earlier --select 3 --csv @/three.csv"));
    char *front_path = in_place("earlier/front.csv"), *all_path = in_place("all.csv"),
         *three_path = in_place("three.csv");
    char *all, *line;
    size_t length;
    Table front, three;
    Err err = {0};
    CHECK_OK(table_read(&front, front_path, 1, &err), &err);
    CHECK_OK(table_read(&three, three_path, 1, &err), &err);
    CHECK_OK(file_read(all_path, &all, &length, &err), &err);
    line = strchr(all, '\n') + 1;
    for (size_t i = 0; i < front.n_rows; i++, line = strchr(line, '\n') + 1) {
        double x = 0.0;
        assert_int_equal(sscanf(line, "%*d,%*d,%*[a-z],ok,,%lf", &x), 1);
        assert_true(x == front.values[i * front.n_cols + 1]);
    }
    assert_int_equal(three.n_rows, 3);
    char *said = output_of("choose @/earlier"), knee[40];
    snprintf(knee, sizeof knee, " %.0f ", three.values[0]);
    assert_non_null(strstr(said, knee));
    free(output_of("polish @/earlier --design knee --improve f1 --keep f1 --evals 60")); /* a gain enters the archive */
    free(output_of("export @/earlier --all --csv @/polished-too.csv"));
    char *with_polished = read_in_place("polished-too.csv");
    assert_non_null(strstr(with_polished, ",polished,ok,"));
    free(with_polished);
    expect(66, "search.start", "optimize @/sphere.ini --out @/no --set search.start=@/nothing");
    expect(2, "is no number of designs", "export @/earlier --select many --csv -");
    free(said);
    free(all);
    table_free(&front);
    table_free(&three);
    free(front_path);
    free(all_path);
    free(three_path);
}

static void test_a_textbook_problem_is_written_design_by_design(void **state)
{
    (void)state;
    Table t;
    Err err = {0};
    free(output_of("problem dtlz2 --max-evals 60 --seed 3 --threads 1 --csv @/one.csv --set search.initial=50"));
    free(output_of("problem dtlz2 --max-evals 60 --seed 3 --threads 3 --csv @/three.csv --set search.initial=50"));
    char *path = in_place("one.csv"), *one = read_in_place("one.csv"), *three = read_in_place("three.csv");
    assert_string_equal(one, three);
    CHECK_OK(table_read(&t, path, 1, &err), &err);
    assert_int_equal(t.n_rows, 60);
    assert_int_equal(t.n_cols, 29);
    for (size_t i = 0; i < t.n_rows; i++) {
        double g = 1, square = 0;
        for (size_t d = 6; d < 22; d++)
            g += (t.values[i * 29 + d] - 0.5) * (t.values[i * 29 + d] - 0.5);
        for (size_t k = 22; k < 29; k++)
            square += t.values[i * 29 + k] * t.values[i * 29 + k];
        assert_close(square, g * g, 1e-12);
    }
    table_free(&t);
    free(path);
    free(one);
    free(three);
    expect(2, "did you mean wfg4", "problem wfg --csv @/no.csv");
    expect(2, "--csv", "problem wfg4");
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_every_command_explains_itself_with_an_example_first),
        cmocka_unit_test(test_a_misunderstood_command_line_ends_with_2_and_a_suggestion),
        cmocka_unit_test(test_bad_settings_and_data_end_with_65),
        cmocka_unit_test(test_missing_inputs_end_with_66),
        cmocka_unit_test(test_output_that_cannot_be_written_ends_with_74),
        cmocka_unit_test(test_the_printed_settings_are_the_default_file_and_in_order),
        cmocka_unit_test(test_check_names_every_fault_at_once),
        cmocka_unit_test(test_modes_of_tower_and_box_core_are_known),
        cmocka_unit_test(test_modes_of_the_effective_core_are_those_of_the_paper),
        cmocka_unit_test(test_modes_take_the_wall_from_a_design),
        cmocka_unit_test(test_the_spectrum_is_the_same_as_json_and_as_csv),
        cmocka_unit_test(test_the_histories_reach_the_figures_of_the_motion),
        cmocka_unit_test(test_the_picture_of_a_motion_is_whole_or_not_there),
        cmocka_unit_test(test_simulate_gives_the_same_numbers_as_json_and_as_csv),
        cmocka_unit_test(test_the_building_alone_and_the_tied_one_have_no_impacts),
        cmocka_unit_test(test_a_top_heavy_design_is_simulated_with_a_warning),
        cmocka_unit_test(test_the_front_has_the_same_bytes_at_any_number_of_threads),
        cmocka_unit_test(test_a_run_is_repeated_from_its_own_folder),
        cmocka_unit_test(test_the_front_holds_nondominated_designs_in_the_search_box),
        cmocka_unit_test(test_a_run_that_is_finished_is_shown_again_and_a_new_one_gets_a_number),
        cmocka_unit_test(test_the_export_is_the_front),
        cmocka_unit_test(test_a_design_of_the_front_is_evaluated_on_other_motions),
        cmocka_unit_test(test_a_design_is_evaluated_on_every_motion_of_a_folder),
        cmocka_unit_test(test_an_external_simulator_is_searched_and_every_design_exported),
        cmocka_unit_test(test_designs_are_chosen_by_limits_weights_and_wishes_and_polished),
        cmocka_unit_test(test_a_search_begins_with_given_designs_and_a_front_is_thinned),
        cmocka_unit_test(test_a_textbook_problem_is_written_design_by_design),
        cmocka_unit_test(test_a_run_that_is_killed_leaves_its_last_finished_generation),
        cmocka_unit_test(test_a_building_of_five_floors_goes_all_the_way),
    };
    return cmocka_run_group_tests(tests, make_place, clear_place);
}
