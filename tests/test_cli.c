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

#include "motion/motion.h"
#include "motion/spectrum.h"

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

TEST(every_command_explains_itself_with_an_example_first)
{
    static const char *const COMMANDS[] = {"",         "optimize", "simulate", "evaluate", "export",
                                           "building", "spectrum", "new",      "check",    "settings"};
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
    char *same[] = {output_of("version"), output_of("-v")};
    for (size_t i = 0; i < N_OF(same); i++) {
        assert_string_equal(same[i], version);
        free(same[i]);
    }
    free(version);
}

TEST(a_misunderstood_command_line_ends_with_2_and_a_suggestion)
{
    expect(2, "no command", "");
    expect(2, "did you mean optimize?", "optimise configs/quick.ini");
    expect(2, "did you mean --design?", "simulate configs/quick.ini --desing none");
    expect(2, "did you mean --json?", "building configs/quick.ini --jsno");
    expect(2, "--help", "building configs/quick.ini --qqqqqqqqqqqqqqqqqqqqqqqq");
    expect(2, "needs a CONFIG|MODEL", "building");
    expect(2, "takes one CONFIG|MODEL", "building configs/quick.ini configs/kobe.ini");
    expect(2, "takes no operand", "settings configs/quick.ini");
    expect(2, "--record needs a value", "simulate configs/quick.ini --record");
    expect(2, "--record needs a value", "simulate configs/quick.ini --record --json");
    expect(2, "--json takes no value", "building configs/quick.ini --json=yes");
    expect(2, "given twice", "simulate configs/quick.ini --pga 1 --pga 2");
    expect(2, "--design FILE is missing", "simulate configs/quick.ini");
    expect(2, "--rigid needs a core", "simulate configs/quick.ini --design none --rigid");
    expect(2, "--set nonsense: write --set section.key=value", "building configs/quick.ini --set nonsense");
    expect(2, "--csv FILE is missing", "export results");
    expect(2, "--all and --select do not go together", "export results --all --select 5 --csv -");
    expect(66, "holds no run", "choose results");
}

TEST(bad_settings_and_data_end_with_65)
{
    expect(65, "did you mean motion.stretch?", "building configs/quick.ini --set motion.strech=2");
    expect(65, "--pga: motion.pga_g: -1 is outside", "simulate configs/quick.ini --design none --pga -1");
    expect(65, "not one of fast|cvode", "simulate configs/quick.ini --design none --set sim.engine=magic");
    expect(65, "tests/bad/config/nan.ini:3:11: building.damping", "building tests/bad/config/nan.ini");
    char *folder = in_place("letters");
    mkdir(folder, 0777);
    free(folder);
    write_in_place("letters/run.sqlite", "this is a letter");
    expect(65, "is no database of a run", "status @/letters");
    expect(65, "is no database of a run", "simulate configs/quick.ini --design @/letters:knee");
    expect(65, "/dev/zero: larger than 1 MiB", "check /dev/zero");
    expect(65, "/dev/zero: larger than 1 MiB", "optimize /dev/zero");
    expect(65, "tests/bad/motion/nan.csv",
           "simulate configs/quick.ini --design none --record tests/bad/motion/nan.csv");
    expect(65, "tests/bad/motion/nan.csv", "spectrum tests/bad/motion/nan.csv");
    expect(65, "a design of 20 floors has gap_03_m there",
           "simulate configs/quick.ini --design tests/bad/design/negative_gap.csv");
}

/* One note on standard error; the answer is that of the present name. */
TEST(old_commands_run_under_their_new_names)
{
    const double gap[1] = {0.01}, wall[1] = {0.02};
    write_designs("one.csv", 1, gap, wall, wall);
    static const char ARGUMENTS[] = "configs/quick.ini --design @/one.csv --json --set sim.duration_s=2";
    Said old, now;
    run(&old, "horizon %s", ARGUMENTS);
    run(&now, "simulate --horizon %s", ARGUMENTS);
    assert_int_equal(now.code, 0);
    assert_string_equal(now.err, "");
    assert_string_equal(old.out, now.out);
    assert_string_equal(old.err, "note: imtet horizon is now: imtet simulate --horizon\n");
    forget(&old);
    forget(&now);
    expect(0, "now: imtet simulate", "help horizon");
}

static void shows(const char *arguments)
{
    static const char WANTED[] = "peak 0.3 g (0.8338 g x 0.3598, time x 2)";
    Said s;
    run(&s, "%s --pga 0.3 --set motion.stretch=2", arguments);
    if (s.code != 0 || (!strstr(s.out, WANTED) && !strstr(s.err, WANTED)))
        fail_msg("imtet %s: exit %d, wanted %s\n%s%s", arguments, s.code, WANTED, s.out, s.err);
    forget(&s);
}

TEST(whatever_takes_a_motion_shows_how_it_is_scaled)
{
    shows("spectrum builtin:kobe-like");
    shows("simulate configs/quick.ini --design none --set sim.duration_s=1");
    shows("optimize configs/quick.ini --out @/scaled " SIX_FLOORS
          "--set sim.duration_s=12 --set search.initial=4 --max-evals 4 "
          "--set search.polish=0");
    shows("evaluate @/scaled --design knee --record builtin:kobe-like");
}

TEST(a_file_of_a_run_is_not_replaced_and_one_design_is_one)
{
    char keeps[sizeof place.folder + 8];
    snprintf(keeps, sizeof keeps, "%s/keeps", place.folder);
    assert_int_equal(mkdir(keeps, 0755), 0);
    write_in_place("keeps/run.sqlite", "");
    expect(2, "which a run needs", "spectrum builtin:kobe-like --csv @/keeps/settings.ini");
    expect(2, "which a run needs", "report @/keeps --out @/keeps/front.csv");
    expect(65, "problem.kind = tower", "simulate configs/quick.ini --design none --set problem.kind=dtlz2");
    const double gap[2] = {0.01, 0.02}, wall[2] = {0.02, 0.02};
    write_designs("two.csv", 2, gap, wall, wall);
    expect(2, "two.csv: holds 2 designs, and one is wanted", "building configs/quick.ini --design @/two.csv");
    expect(2, "two.csv:1", "simulate configs/quick.ini --horizon --design @/two.csv");
    expect(2, "holds 2 designs", "simulate configs/quick.ini --sensitivity --design @/two.csv");
}

TEST(standard_output_and_every_setting_belong_to_one)
{
    const double gap[1] = {0.01}, wall[1] = {0.02};
    write_designs("one.csv", 1, gap, wall, wall);
#define ONE "simulate configs/quick.ini --set sim.duration_s=20 --design @/one.csv "
    expect(2, "--csv and --json both want standard output", ONE "--csv - --json");
    expect(2, "--csv and --history both want standard output", ONE "--csv - --history -");
    expect(2, "--history and --json both want standard output", "spectrum builtin:kobe-like --history - --json");
    expect(2, "--every is the spacing of --history", ONE "--every 0.1");
    expect(2, "--sensitivity and --contacts do not go together", ONE "--sensitivity --contacts @/contacts.csv");
    char *text = output_of(ONE "--history -"), *last = strrchr(text, '\n');
    assert_true(last && last[1] == 0);
    for (char *line = text, *end; (end = strchr(line, '\n')); line = end + 1) /* no table among the rows */
        if (line > text && strncmp(line, "1,", 2) != 0)
            fail_msg("%.60s", line);
    free(text);
}

TEST(optimize_and_polish_answer_as_json)
{
    json_t *study = json_of("optimize configs/quick.ini " SIX_FLOORS
                            "--max-evals 60 --set sim.duration_s=4 --set search.initial=30 "
                            "--set search.population=16 --out @/spoken --json");
    json_t *knee = json_object_get(study, "knee");
    char design[64];
    assert_int_equal(json_integer_value(json_object_get(study, "simulated")), 60);
    snprintf(design, sizeof design, "simulate @/spoken/settings.ini --design @/spoken:%" JSON_INTEGER_FORMAT " --json",
             json_integer_value(json_object_get(knee, "design")));
    json_t *alone = json_of(design);
    assert_close(number(knee, "j1_m"), number(alone, "j1_m"), 1e-3);
    assert_at_most(number(json_object_get(json_object_get(study, "best"), "j1_m"), "j1_m"), number(knee, "j1_m"));
    assert_true(json_object_get(json_object_get(study, "baselines"), "links") != NULL);
    json_t *polished = json_of("polish @/spoken --design knee --improve j2_m --evals 24 --json");
    json_t *row = json_array_get(json_object_get(polished, "polished"), 0);
    assert_close(number(row, "j1_m_before"), number(knee, "j1_m"), 1e-2);
    assert_non_null(json_string_value(json_object_get(polished, "verdict")));
    json_decref(polished);
    json_decref(alone);
    json_decref(study);
}

TEST(missing_inputs_end_with_66)
{
    expect(66, "nowhere.ini", "building nowhere.ini");
    expect(66, "nowhere.csv", "simulate configs/quick.ini --design nowhere.csv");
    expect(66, "nowhere.csv", "simulate configs/quick.ini --design none --record nowhere.csv");
    expect(66, "nowhere.csv", "spectrum nowhere.csv");
    expect(66, "nowhere", "export nowhere --csv @/front.csv");
    expect(66, "nowhere", "evaluate nowhere --design 1 --record builtin:kobe-like");
}

TEST(output_that_cannot_be_written_ends_with_74)
{
    expect(74, "/dev/full", "spectrum builtin:kobe-like --csv /dev/full");
    expect(74, "/no/such/folder/a.csv", "spectrum builtin:kobe-like --csv @/no/such/folder/a.csv");
    expect(74, "standard output", "settings >/dev/full");
    expect(74, "standard output", "spectrum builtin:kobe-like --json >/dev/full");
    expect(74, "configs/quick.ini/run", "optimize configs/quick.ini --out configs/quick.ini/run");
}

/* -------------------------------------------------------------------------------------------- settings and check ---
 */

TEST(the_printed_settings_are_the_default_file_and_in_order)
{
    char *printed = output_of("settings"), *kept = text_of("configs/default.ini");
    if (strcmp(printed, kept) != 0)
        fail_msg("they differ; if the settings were meant to change: imtet settings > configs/default.ini");
    write_in_place("printed.ini", printed);
    free(output_of("check @/printed.ini"));
    free(output_of("check configs/quick.ini"));
    free(printed);
    free(kept);
}

TEST(check_names_every_fault_at_once)
{
    write_in_place("many.ini", "[motion]\nrecord = not-there.csv\npga_g = nan\nstretc = 3\n[core]\nsection = tube\n"
                               "[building]\nmodel = /not/there\n");
    Said s;
    run(&s, "check @/many.ini --set search.sead=3");
    assert_int_equal(s.code, 65);
    static const char *const WANTED[] = {"many.ini:3:9: motion.pga_g",
                                         "many.ini:4:1: motion.stretc",
                                         "many.ini:6:11: core.section",
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

TEST(modes_take_the_wall_from_a_design)
{
    write_designs("wall.csv", 1, (double[]){0.01}, (double[]){0.012}, (double[]){0.0064});
    char *plain = output_of("building configs/quick.ini"),
         *given = output_of("building configs/quick.ini --design @/wall.csv");
    assert_string_equal(plain, given);
    free(plain);
    free(given);
}

TEST(the_spectrum_is_the_same_as_json_and_as_csv)
{
    Err err = {0};
    Table t;
    json_t *o = json_of("spectrum builtin:kobe-like --pga 0.3 --set motion.stretch=3.1 --json --csv @/spectrum.csv");
    char *path = in_place("spectrum.csv");
    CHECK_OK(table_read(&t, path, 1, &err), &err);
    assert_close(number(o, "pga_g"), 0.3, 1e-12);
    const json_t *psa = json_object_get(o, "psa_m_s2");
    assert_int_equal(json_array_size(psa), t.n_rows);
    for (size_t i = 0; i < t.n_rows; i++)
        assert_same_number(json_real_value(json_array_get(psa, i)), t.values[i * t.n_cols + 1]);
    table_free(&t);
    free(path);
    json_decref(o);
}

/* Husid's curve ends at 1, velocity and displacement reach the peaks of the table. */
TEST(the_histories_reach_the_figures_of_the_motion)
{
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

TEST(the_picture_of_a_motion_is_whole_or_not_there)
{
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

TEST(simulate_gives_the_same_numbers_as_json_and_as_csv)
{
    write_designs("two.csv", 2, (double[]){0.001, 0.004}, (double[]){0.012, 0.03}, (double[]){0.0064, 0.01});
    json_t *list = json_of("simulate configs/quick.ini" SHORT "--design @/two.csv --json");
    free(output_of("simulate configs/quick.ini" SHORT "--design @/two.csv --csv @/results.csv"));
    char *csv = read_in_place("results.csv"), *line, *rest = csv;
    char *streamed = output_of("simulate configs/quick.ini" SHORT "--design @/two.csv --csv -");
    assert_string_equal(streamed, csv);
    free(streamed);
    assert_int_equal(json_array_size(list), 2);
    char *table = output_of("simulate configs/quick.ini" SHORT "--design @/two.csv");
    assert_non_null(strstr(table, "\ntwo.csv:2  "));
    assert_null(strstr(table, "e+0"));
    free(table);
    char *names = strdup(strsep(&rest, "\n"));
    assert_int_equal(strncmp(names, "design,j1_m,j2_m,j3_g,ed1_pct,ed5_10_pct,edcs_pct,mcore_kg,input_energy_j,", 72),
                     0);
    assert_non_null(strstr(names, ",impacts,"));
    assert_non_null(strstr(names, ",core_stress_pa,"));
    for (size_t i = 0; i < 2; i++) {
        const json_t *o = json_array_get(list, i);
        assert_string_equal(json_string_value(json_object_get(o, "outcome")), "ok");
        assert_int_equal(json_array_size(json_object_get(o, "peak_drift_m")), 20);
        line = strsep(&rest, "\n");
        assert_int_equal(strtol(strsep(&line, ","), NULL, 10), (long)i + 1);
        char *copy = strdup(names), *left = copy, *name;
        for (strsep(&left, ","); strcmp(name = strsep(&left, ","), "outcome") != 0;) {
            const json_t *value = json_object_get(o, name);
            const char *text = strsep(&line, ",");
            const double cell = strtod(text, NULL);
            if (json_is_null(value)) /* what the scene does not have */
                assert_string_equal(text, "");
            else
                assert_true(json_is_boolean(value) ? cell == json_is_true(value) : cell == number(o, name));
        }
        free(copy);
        assert_string_equal(line, "ok");
        assert_less(0, number(o, "impacts"));
    }
    free(names);
    free(csv);
    json_decref(list);
}

TEST(no_output_replaces_a_file_that_is_read_a_run_or_another_output)
{
    write_in_place("own.ini", "[sim]\nduration_s = 5\n");
    write_in_place("own.sqlite", "SQLite format 3");
    expect(2, "which the command reads", "simulate @/own.ini --design none --history @/own.ini");
    expect(2, "are one file", "simulate @/own.ini --design none --history @/a.csv --floor-spectra @/a.csv");
    expect(2, "are one file", "simulate @/own.ini --design none --history @/a.csv --floor-spectra @/./a.csv");
    expect(2, "is a database", "simulate @/own.ini --design none --history @/own.sqlite");
    char *settings = read_in_place("own.ini");
    assert_string_equal(settings, "[sim]\nduration_s = 5\n");
    free(settings);
}

/* Whoever writes it, and whether the command line, the settings, a folder or a link names it. */
TEST(no_option_that_writes_replaces_what_a_run_keeps_or_a_setting_names)
{
    static const char *const FOLDERS[] = {"held", "records", "tower"};
    static const char *const OPTIONS[] = {"--csv", "--svg", "--history"};
    for (size_t i = 0; i < sizeof FOLDERS / sizeof FOLDERS[0]; i++) {
        char *folder = in_place(FOLDERS[i]);
        assert_int_equal(mkdir(folder, 0777), 0);
        free(folder);
    }
    write_in_place("held/run.sqlite", "");
    write_in_place("held/front.csv", "id\n");
    write_in_place("held/settings.ini", "[motion]\nrecord = ../motion.csv\n");
    write_in_place("records/one.csv", "t,a_g\n0,1\n");
    write_in_place("tower/K.csv", "1e8\n");
    write_in_place("tower/M.csv", "1e5\n");
    write_in_place("motion.csv", "t,a_g\n0,0\n0.01,0.1\n0.02,0\n");
    write_in_place("tower.ini", "[building]\nmodel = tower\n[motion]\nrecord = motion.csv\n");
    write_in_place("a.csv", "gap_01_m,t_base_m,t_top_m\n0.01,0.01,0.01\n");
    char *link = in_place("linked.csv");
    assert_int_equal(symlink("held/front.csv", link), 0);
    free(link);
    for (size_t i = 0; i < sizeof OPTIONS / sizeof OPTIONS[0]; i++) {
        char words[128];
        snprintf(words, sizeof words, "spectrum builtin:kobe-like %s @/held/log.jsonl", OPTIONS[i]);
        expect(2, "held/log.jsonl, which a run needs; name another file", words);
    }
    expect(2, "front.csv, which a run needs", "simulate configs/quick.ini --design none --contacts @/held/front.csv");
    expect(2, "linked.csv, which a run needs", "spectrum builtin:kobe-like --csv @/linked.csv");
    expect(2, "held/log.jsonl, which a run needs", "building guyan --svg @/held/log.jsonl");
    expect(2, "held/settings.ini, which a run needs", "report @/nowhere --out @/held/settings.ini");
    expect(2, "one.csv, which the command reads", "evaluate @/held --records @/records --csv @/records/one.csv");
    expect(2, "a.csv, which the command reads", "simulate @/tower.ini --design @/a.csv:1 --history @/a.csv");
    expect(2, "motion.csv, which motion.record names", "simulate @/tower.ini --design none --csv @/motion.csv");
    expect(2, "K.csv, which building.model names", "building @/tower.ini --svg @/tower/K.csv");
    expect(2, "motion.csv, which the command reads", "spectrum @/motion.csv --csv @/motion.csv");
    expect(2, "motion.csv, which the command reads", "export @/held --csv @/motion.csv");
    write_in_place("moved.csv", "t,a_g\n0,0\n0.01,0.1\n0.02,0\n");
    expect(2, "moved.csv, which the command reads",
           "polish @/held --set motion.record=@/moved.csv --design 1 --csv @/moved.csv");
    expect(2, "motion.csv, which the command reads", "choose @/held/run.sqlite --csv @/motion.csv");
    expect(2, "motion.csv, which the command reads", "simulate configs/quick.ini --design @/held:1 --csv @/motion.csv");
    char *kept = read_in_place("held/front.csv");
    assert_string_equal(kept, "id\n");
    free(kept);
    free(output_of("building @/tower --svg @/tower/drawn.svg"));
    free(output_of("building @/tower --svg @/tower/drawn.svg"));
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
    write_in_place("five.ini", "[building]\nmodel = five\nheights_m = 4, 3\n[core]\nwidth_m = 5\n"
                               "[motion]\npga_g = 0.6\n[sim]\nduration_s = 8\n"
                               "[search]\ninitial = 12\npopulation = 8\nmax_evals = 20\n");
    write_in_place("five.csv", "gap_01_m,gap_02_m,gap_03_m,gap_04_m,gap_05_m,t_base_m,t_top_m\n"
                               "0.002,0.004,0.006,0.008,0.01,0.012,0.0064\n");
}

TEST(a_building_of_five_floors_goes_all_the_way)
{
    const double k = 4e8, m = 6e5;
    write_five_floors(k, m);
    free(output_of("check @/five.ini"));
    json_t *o = json_of("building @/five.ini --json");
    for (int i = 0; i < 5; i++)
        assert_close(json_real_value(json_array_get(json_object_get(o, "building_hz"), (size_t)i)),
                     sqrt(k / m) * sin((2 * i + 1) * M_PI / 22) / M_PI, 1e-9);
    json_decref(o);

    json_t *fast = json_of("simulate @/five.ini --design @/five.csv --set sim.accuracy=fine --json");
    json_t *slow = json_of("simulate @/five.ini --design @/five.csv --set sim.engine=cvode --json");
    assert_int_equal(json_array_size(json_object_get(fast, "peak_drift_m")), 5);
    assert_less(10, number(fast, "impacts"));
    assert_close(number(fast, "j1_m"), number(slow, "j1_m"), 1e-3);
    json_decref(fast);
    json_decref(slow);

    free(output_of("optimize @/five.ini --set sim.duration_s=6 --out @/five.run"));
    char *front = read_in_place("five.run/front.csv");
    assert_int_equal(strncmp(front, "id,gap_01_m,gap_02_m,gap_03_m,gap_04_m,gap_05_m,t_base_m,", 57), 0);
    free(front);
    free(output_of("evaluate @/five.run --design knee --record builtin:elcentro-like"));
    expect(65, "a design of 20 floors has gap_06_m there", "simulate configs/quick.ini --design @/five.csv");
}

SUITE(make_place, clear_place)
