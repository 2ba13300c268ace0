/* Studies as a person makes them: runs $IMTET in the repository's root and looks at what a run leaves behind. */
#include "program.h"

#include <dirent.h>

#define SMALL_STUDY_OF(max_evals)                                                                                      \
    "optimize configs/quick.ini " SIX_FLOORS "--set sim.duration_s=4 --set search.initial=28 "                         \
    "--set search.population=16 --max-evals " #max_evals " "
#define SMALL_STUDY SMALL_STUDY_OF(40)

TEST(the_front_has_the_same_bytes_at_any_number_of_threads)
{
    static const int THREADS[] = {1, 2, 5};
    char *front[3], *all[3];
    for (int i = 0; i < 3; i++) {
        free(output_of(SMALL_STUDY "--threads %d --out @/threads-%d", THREADS[i], THREADS[i]));
        front[i] = read_in_place(brief("threads-%d/front.csv", THREADS[i]));
        all[i] = all_of(brief("threads-%d", THREADS[i]));
    }
    for (int i = 2; i >= 0; i--) {
        assert_string_equal(front[0], front[i]);
        assert_string_equal(all[0], all[i]);
        free(front[i]);
        free(all[i]);
    }
}

TEST(a_run_is_repeated_from_its_own_folder)
{
    free(output_of("optimize @/threads-2/settings.ini --out @/again"));
    assert_same_files("threads-2/front.csv", "again/front.csv");
    json_auto_t *o = json_load_file(there("again/provenance.json"), 0, NULL);
    assert_non_null(o);
    assert_same_number(json_integer_value(json_object_get(o, "seed")), 1);
    assert_non_null(json_object_get(json_object_get(o, "libraries"), "sundials"));
    assert_int_equal(json_string_length(json_object_get(json_object_get(o, "inputs"), "record_fnv1a")), 16);
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
    OWNED(table_free) Table t = table_of("threads-1/front.csv");
    assert_int_equal(t.n_cols, 1 + 8 + 7 + 7); /* the last ones: likely errors */
    for (size_t i = 0; i < t.n_rows; i++) {
        const double *a = t.values + i * t.n_cols;
        for (int j = 1; j <= 6; j++)
            assert_true(a[j] >= 0.001 && a[j] <= 0.05);
        assert_true(a[8] <= a[7] && a[8] >= 0.004 && a[7] <= 0.04);
        for (size_t l = 0; l < t.n_rows; l++)
            assert_false(dominates(t.values + l * t.n_cols + 9, a + 9));
    }
}

TEST(a_run_that_is_finished_is_shown_again_and_a_new_one_gets_a_number)
{
    FREED char *before = read_in_place("threads-1/front.csv"); /* the hours are of this session: no limit of the run */
    expect_output("finished before", SMALL_STUDY "--threads 2 --max-hours 1 --out @/threads-1");
    assert_text(read_in_place("threads-1/front.csv"), before);
    expect_output("threads-1-2/front.csv", SMALL_STUDY "--new --set run.out=@/threads-1");
}

TEST(the_export_is_the_front)
{
    free(output_of("export @/threads-1 --csv @/exported.csv"));
    assert_same_files("threads-1/front.csv", "exported.csv");
}

TEST(a_design_of_the_front_is_evaluated_on_other_motions)
{
    FREED char *front = read_in_place("threads-1/front.csv");
    json_auto_t *o =
        as_json("evaluate @/threads-1 --design %ld --record builtin:kobe-like --record builtin:elcentro-like --json",
                strtol(strchr(front, '\n') + 1, NULL, 10));
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
    expect(65, "has no design 123456", "evaluate @/threads-1 --design 123456 --record builtin:kobe-like");
    expect_output("no core", "evaluate @/threads-1 --design knee --record builtin:sylmar-like");
}

TEST(status_tells_a_run_from_a_folder_of_runs)
{
    expect_output("threads-1: finished", "status @/threads-1");
    assert_words_in(output_of("status @"), "\nthreads-1 ", "!hypervolume"); /* each has a box of its own */
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
    json_auto_t *o =
        as_json("evaluate @/threads-1 --design knee --record tests/motion --set motion.channel=1 --pga 0.3 --json");
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
    assert_words_in(output_of("evaluate @/threads-1 --design knee --record tests/motion --set motion.channel=1"),
                    "\none.knet ", "  no core ", "not read: tests/motion/irregular.csv:26");
    expect(65, "holds no ground motion that can be read", "evaluate @/threads-1 --design knee --record configs/sac20");
    expect(65, "not read: tests/motion/one.knet: motion.channel '99' is not exactly one of its channels",
           "evaluate @/threads-1 --design knee --record tests/motion --set motion.channel=99");
    assert_int_equal(mkdir(there("empty"), 0777), 0);
    Said s;
    run(&s, "evaluate @/threads-1 --design knee --record @/empty");
    assert_int_equal(s.code, 65);
    assert_non_null(strstr(s.err, "empty: is empty"));
    assert_string_equal(s.out, ""); /* no title above an error */
    forget(&s);
    run(&s, "evaluate @/threads-1 --design knee --record nowhere");
    assert_int_equal(s.code, 66);
    assert_non_null(strstr(s.err, "nowhere"));
    assert_string_equal(s.out, "");
    forget(&s);
}

/* Each design of the table `some` is a row of the table `all`. */
static void assert_all_in(const char *some, const char *all)
{
    assert_int_equal(some[strlen(some) - 1], '\n');
    for (const char *row = some; (row = strchr(row, '\n')) && row[1];) {
        FREED char *start = formatted("\n%ld,", strtol(++row, NULL, 10));
        if (!strstr(all, start))
            fail_msg("design %s is not among the simulations", start + 1);
    }
}

/* kill -9 once a front must be on the disk, 0.2 s after the first one; most of the 4000 simulations are still to come. */
TEST(a_run_that_is_killed_leaves_its_last_finished_generation)
{
    OWNED(forget) Said s;
    run(&s, "%s",
        SMALL_STUDY_OF(4000) "--threads 1 --out @/killed & n=0; "
                             "while ! grep -qs 'number.: 30,' @/killed/log.jsonl && [ $n -lt 1200 ]; do n=$((n+1)); "
                             "sleep 0.05; done; sleep 0.5; " /* the store commits five times a second */
                             "kill -9 $! && ! wait $!");
    if (s.code != 0)
        fail_msg("exit %d, said: %s", s.code, s.err);
    free(output_of("export @/killed --csv @/rescued.csv"));
    free(output_of("export @/killed --all --csv @/rescued-all.csv"));
    FREED char *rescued = read_in_place("rescued.csv"), *all = read_in_place("rescued-all.csv");
    assert_all_in(rescued, all);
    free(output_of("evaluate @/killed --design knee --record builtin:elcentro-like --set sim.duration_s=4"));
}

/* The first simulations of the second run are the front of the first one. */
TEST(a_search_begins_with_given_designs)
{
    write_in_place("sphere.ini", DTLZ2_INI(4, 3) "[search]\nmax_evals = 45\ninitial = 30\npopulation = 12\n");
    free(output_of("optimize @/sphere.ini --out @/earlier"));
    free(output_of("optimize @/sphere.ini --out @/later --set search.start=@/earlier"));
    free(output_of("export @/later --all --csv @/all.csv"));
    OWNED(table_free) Table front = table_of("earlier/front.csv");
    FREED char *all = read_in_place("all.csv");
    const char *line = strchr(all, '\n') + 1;
    for (size_t i = 0; i < front.n_rows; i++, line = strchr(line, '\n') + 1) {
        double x = 0.0;
        assert_int_equal(sscanf(line, "%*d,%*d,%*[a-z],ok,,%lf", &x), 1);
        assert_same_number(x, front.values[i * front.n_cols + 1]);
    }
    free(output_of(
        "polish @/earlier --design knee --improve f1 --keep f1 --max-evals 60")); /* a gain enters the archive */
    free(output_of("export @/earlier --all --csv @/polished-too.csv"));
    expect_file("polished-too.csv", ",polished,ok,");
    expect(66, "search.start", "optimize @/sphere.ini --out @/no --set search.start=@/nothing");
}

TEST(a_worker_gives_the_same_run_at_any_number_of_threads)
{
    static const char STUDY[] =
        "optimize configs/quick.ini " DTLZ2(22, 7) "--set search.initial=50 --max-evals 90 --threads %d --out @/%d";
    free(output_of(STUDY, 1, 1));
    free(output_of(STUDY, 3, 3));
    FREED char *one = output_of("export @/1 --all --csv -"), *three = output_of("export @/3 --all --csv -");
    assert_string_equal(one, three);
}

SUITE(make_place, clear_place)
