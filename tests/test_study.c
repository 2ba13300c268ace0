/* Studies as a person makes them: runs $IMTET in the repository's root and looks at what a run leaves behind. */
#include "check.h"

#include <dirent.h>
#include <jansson.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

#include "program.h"

/* ------------------------------------------------------------------------------------------------------- the study ---
 */

#define SMALL_STUDY_OF(max_evals)                                                                                      \
    "optimize configs/quick.ini " SIX_FLOORS "--set sim.duration_s=4 --set search.initial=28 "                         \
    "--set search.population=16 --max-evals " #max_evals " "
#define SMALL_STUDY SMALL_STUDY_OF(40)

TEST(the_front_has_the_same_bytes_at_any_number_of_threads)
{
    static const int THREADS[] = {1, 2, 5};
    char arguments[512], name[64], *front[3], *all[3];
    for (int i = 0; i < 3; i++) {
        snprintf(arguments, sizeof arguments, SMALL_STUDY "--threads %d --out @/threads-%d", THREADS[i], THREADS[i]);
        free(output_of(arguments));
        snprintf(name, sizeof name, "threads-%d/front.csv", THREADS[i]);
        front[i] = read_in_place(name);
        snprintf(name, sizeof name, "threads-%d", THREADS[i]);
        all[i] = all_of(name);
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

TEST(a_run_is_repeated_from_its_own_folder)
{
    free(output_of("optimize @/threads-2/settings.ini --out @/again"));
    char *first = read_in_place("threads-2/front.csv"), *second = read_in_place("again/front.csv");
    assert_string_equal(first, second);
    free(first);
    free(second);
    char *path = in_place("again/provenance.json");
    json_t *o = json_load_file(path, 0, NULL);
    assert_non_null(o);
    assert_same_number(json_integer_value(json_object_get(o, "seed")), 1);
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

TEST(the_front_holds_nondominated_designs_in_the_search_box)
{
    Err err = {0};
    Table t;
    char *path = in_place("threads-1/front.csv");
    CHECK_OK(table_read(&t, path, 1, &err), &err);
    assert_int_equal(t.n_cols, 1 + 8 + 7 + 7); /* the last ones: likely errors */
    for (size_t i = 0; i < t.n_rows; i++) {
        const double *a = t.values + i * t.n_cols;
        for (int j = 1; j <= 6; j++)
            assert_true(a[j] >= 0.001 && a[j] <= 0.05);
        assert_true(a[8] <= a[7] && a[8] >= 0.004 && a[7] <= 0.04);
        for (size_t l = 0; l < t.n_rows; l++)
            assert_false(dominates(t.values + l * t.n_cols + 9, a + 9));
    }
    table_free(&t);
    free(path);
}

TEST(a_run_that_is_finished_is_shown_again_and_a_new_one_gets_a_number)
{
    Said s;
    char *before = read_in_place("threads-1/front.csv");
    run(&s, SMALL_STUDY "--threads 2 --max-hours 1 --out @/threads-1"); /* of this session: no lower limit of the run */
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

TEST(the_export_is_the_front)
{
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

TEST(a_design_of_the_front_is_evaluated_on_other_motions)
{
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
    for (int i = 0; i < 9; i++)
        row = strchr(row, ',') + 1;
    const json_t *own = json_array_get(records, 0);
    assert_same_number(number(json_object_get(own, "with_core"), "j1_m"), strtod(row, NULL));
    assert_same_number(number(json_object_get(own, "no_core"), "impacts"), 0);
    json_decref(o);
    free(front);
    expect(65, "has no design 123456", "evaluate @/threads-1 --design 123456 --record builtin:kobe-like");
    char *table = output_of("evaluate @/threads-1 --design knee --record builtin:sylmar-like");
    assert_non_null(strstr(table, "no core"));
    free(table);
}

TEST(status_tells_a_run_from_a_folder_of_runs)
{
    char *said = output_of("status @/threads-1");
    assert_non_null(strstr(said, "threads-1: finished"));
    free(said);
    said = output_of("status @");
    assert_non_null(strstr(said, "\nthreads-1 "));
    assert_null(strstr(said, "hypervolume")); /* each has a box of its own */
    free(said);
}

static const char *record_of(const json_t *list, size_t i)
{
    return json_string_value(json_object_get(json_array_get(list, i), "record"));
}

static size_t n_files(const char *folder)
{
    struct dirent **names;
    size_t n = 0;
    const int entries = scandir(folder, &names, NULL, NULL);
    for (int i = 0; i < entries; i++) {
        n += names[i]->d_type == DT_REG && names[i]->d_name[0] != '.';
        free(names[i]);
    }
    free(names);
    return n;
}

TEST(a_design_is_evaluated_on_every_motion_of_a_folder)
{
    json_t *o = json_of("evaluate @/threads-1 --design knee --records tests/motion --channel 1 --pga 0.3 --json");
    const json_t *records = json_object_get(o, "records"), *unreadable = json_object_get(o, "unreadable");
    assert_int_equal(json_array_size(records) + json_array_size(unreadable), n_files("tests/motion"));
    for (size_t i = 0; i + 1 < json_array_size(records); i++)
        assert_less(strcmp(record_of(records, i), record_of(records, i + 1)), 0);
    for (size_t i = 0; i < json_array_size(records); i++) {
        const json_t *error = json_object_get(json_object_get(json_array_get(records, i), "with_core"), "error");
        assert_true(json_number_value(json_object_get(json_object_get(error, "likely"), "j1_m")) >= 0);
        assert_null(json_object_get(json_object_get(error, "sd_gaps_1_um"), "j1_m"));
    }
    size_t at = 0; /* others lack a gain, or ask which channel */
    while (at < json_array_size(unreadable) && strcmp(record_of(unreadable, at), "tests/motion/irregular.csv") != 0)
        at++;
    const json_t *one = json_array_get(unreadable, at);
    assert_non_null(strstr(json_string_value(json_object_get(one, "reason")), "irregular.csv:26: time 0.24 s breaks"));
    json_decref(o);
    char *table = output_of("evaluate @/threads-1 --design knee --records tests/motion --channel 1");
    assert_non_null(strstr(table, "\none.knet "));
    assert_non_null(strstr(table, "  no core "));
    assert_non_null(strstr(table, "not read: tests/motion/irregular.csv:26"));
    free(table);
    expect(65, "holds no ground motion that can be read", "evaluate @/threads-1 --design knee --records configs/sac20");
    expect(65, "not read: tests/motion/one.knet: motion.channel '99' is not exactly one of its channels",
           "evaluate @/threads-1 --design knee --records tests/motion --channel 99");
    char *empty = in_place("empty");
    assert_int_equal(mkdir(empty, 0777), 0);
    free(empty);
    Said s;
    run(&s, "evaluate @/threads-1 --design knee --records @/empty");
    assert_int_equal(s.code, 65);
    assert_non_null(strstr(s.err, "empty: is empty"));
    assert_string_equal(s.out, ""); /* no title above an error */
    forget(&s);
    run(&s, "evaluate @/threads-1 --design knee --records nowhere");
    assert_int_equal(s.code, 66);
    assert_non_null(strstr(s.err, "nowhere"));
    assert_string_equal(s.out, "");
    forget(&s);
}

/* Each design of the table `some` is a row of the table `all`. */
static void assert_all_in(const char *some, const char *all)
{
    char start[32];
    assert_int_equal(some[strlen(some) - 1], '\n');
    for (const char *row = some; (row = strchr(row, '\n')) && row[1];) {
        snprintf(start, sizeof start, "\n%ld,", strtol(++row, NULL, 10));
        if (!strstr(all, start))
            fail_msg("design %s is not among the simulations", start + 1);
    }
}

/* kill -9 as soon as there is a front; most of the 4000 simulations are still to come. */
TEST(a_run_that_is_killed_leaves_its_last_finished_generation)
{
    Said s;
    run(&s, "%s",
        SMALL_STUDY_OF(4000) "--threads 1 --out @/killed & n=0; "
                             "while ! grep -qs 'number.: 2,' @/killed/log.jsonl && [ $n -lt 1200 ]; do n=$((n+1)); "
                             "sleep 0.05; done; "
                             "kill -9 $! && ! wait $!");
    if (s.code != 0)
        fail_msg("exit %d, said: %s", s.code, s.err);
    forget(&s);
    free(output_of("export @/killed --csv @/rescued.csv"));
    free(output_of("export @/killed --all --csv @/rescued-all.csv"));
    char *rescued = read_in_place("rescued.csv"), *all = read_in_place("rescued-all.csv");
    assert_all_in(rescued, all);
    free(rescued);
    free(all);
    free(output_of("evaluate @/killed --design knee --record builtin:elcentro-like --set sim.duration_s=4"));
}

/* ------------------------------------------------------------------------------------------- problems of others ---
 */

static const char EXTERNAL_INI[] = "[problem]\nkind = external\ncommand = sh tests/worker.sh dies\nvariables = 3\n"
                                   "objectives = 2\nsenses = min,max\n[search]\nmax_evals = 45\ninitial = 30\n"
                                   "population = 12\n";

TEST(an_external_simulator_is_searched_and_every_design_exported)
{
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
    free(output_of(
        "optimize @/external.ini --out @/none")); /* nothing was simulated: no run yet, and no other settings */
}

/* The external run of the test before: f = (x1 min, x2 max). */
TEST(designs_are_chosen_by_limits_weights_and_a_reference_point_and_polished)
{
    free(output_of("optimize @/external.ini --out @/kind --set 'problem.command=sh tests/worker.sh good'"));
    char *said = output_of("choose @/kind --max f1=0.9 --min f2=0.1 --weights f1=1 --reference f1=0,f2=1");
    assert_non_null(strstr(said, "knee"));
    assert_non_null(strstr(said, "weighted"));
    assert_non_null(strstr(said, "nearest to reference"));
    free(said);
    expect(69, "no design of the front is within the limits", "choose @/kind --max f1=-5");
    expect(2, "speed is no objective", "choose @/kind --max speed=5");
    expect(2, "is not NAME=NUMBER", "choose @/kind --weights f1");
    expect(2, "--weights: f2=-1 is negative", "choose @/kind --weights f1=1,f2=-1");
    expect(2, "all of them are 0", "choose @/kind --weights f1=0");

    /* With nothing kept x1 = 0 is the best there is; with all kept nothing may change on this front. */
    said = output_of("polish @/kind --design knee --improve f1 --keep f1 --evals 120 --csv @/polished.csv");
    assert_non_null(strstr(said, "designs tried in"));
    free(said);
    Table t;
    Err err = {0};
    char *path = in_place("polished.csv");
    CHECK_OK(table_read(&t, path, 1, &err), &err);
    assert_true(t.values[4] < 0.01 && t.values[4] == t.values[1]);
    table_free(&t);
    free(path);
    expect(65, "has no design 999999", "polish @/kind --design 999999");
    expect(2, "--evals: '0' is no number from 1", "polish @/kind --design knee --evals 0");
    expect(2, "both designs at the end take 4 simulations", "polish @/kind --design knee --evals 3");
    expect(2, "--replicates: 2.5 is no whole number", "polish @/kind --design knee --replicates 2.5");
}

/* A plain search of 400 is far from the front; with noise nothing is polished. */
TEST(a_study_of_another_problem_than_the_tower_is_polished_at_its_end_unless_noisy)
{
    write_in_place("textbook.ini", "[problem]\nkind = dtlz2\nvariables = 5\nobjectives = 2\n[search]\nmax_evals = 400\n"
                                   "population = 40\nsurrogate = off\npolish = 1\nseed = 2\n");
    char *said = output_of("optimize @/textbook.ini --out @/exact"),
         *noisy = output_of("optimize @/textbook.ini --out @/noisy-end --set problem.noise=0.01");
    assert_non_null(strstr(said, "polished: 1 of 1 designs became better"));
    assert_null(strstr(noisy, "polished: "));
    free(said);
    free(noisy);
}

/* The simulator answers until there is a file beside it. */
TEST(a_design_that_fails_when_it_is_polished_is_named_with_its_reason)
{
    write_in_place("tired.sh", "while read -r line; do id=${line#*:}; id=${id%%,*}\n"
                               "if [ -e \"$0.off\" ]; then echo \"{\\\"id\\\":$id,\\\"error\\\":\\\"no licence\\\"}\"\n"
                               "else echo \"{\\\"id\\\":$id,\\\"f\\\":[$id,1]}\"; fi; done\n");
    char *path = in_place("tired.sh"), command[400];
    snprintf(command, sizeof command,
             "optimize @/external.ini --out @/tired --max-evals 8 --set 'problem.command=sh %s'", path);
    free(output_of(command));
    write_in_place("tired.sh.off", "");
    expect(65, "simulated again, 1 times (error: no licence)", "polish @/tired --design knee");
    free(path);
}

/* The first simulations of the second run are the front of the first one; a choice of three begins with the knee. */
TEST(a_search_begins_with_given_designs_and_a_front_is_thinned)
{
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
    CHECK_OK(file_read(all_path, FILE_LARGEST, &all, &length, &err), &err);
    line = strchr(all, '\n') + 1;
    for (size_t i = 0; i < front.n_rows; i++, line = strchr(line, '\n') + 1) {
        double x = 0.0;
        assert_int_equal(sscanf(line, "%*d,%*d,%*[a-z],ok,,%lf", &x), 1);
        assert_same_number(x, front.values[i * front.n_cols + 1]);
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
    expect(2, "--select: 'many' is no number from 1", "export @/earlier --select many --csv -");
    free(said);
    free(all);
    table_free(&front);
    table_free(&three);
    free(front_path);
    free(all_path);
    free(three_path);
}

TEST(a_textbook_problem_is_written_design_by_design)
{
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

SUITE(make_place, clear_place)
