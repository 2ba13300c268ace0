/* An external worker asked beside any search: by check, and by simulate of designs of a run or a file. */
#include "runs.h"

/* f1 = x1, f2 = 20 - x1 + x2 + 3 for the word b; every request's id is written down. */
static void write_study(const char *name, const char *mode)
{
    FREED char *text = formatted(
        "[problem]\nkind = external\ncommand = sh tests/worker.sh %s %s/asked\nvariables = 3\nobjectives = 2\n"
        "lower = 0\nupper = 20\nkinds = int, int, choice:a|b\ntimeout_s = 0.3\n"
        "[search]\ninitial = 12\npopulation = 12\nmax_evals = 30\nthreads = 2\n",
        mode, place.folder);
    write_in_place(name, text);
}

TEST(check_asks_the_worker_one_design_and_says_its_answer_and_the_time_of_the_study)
{
    write_study("kinds.ini", "bounded");
    json_auto_t *o = as_json("check @/kinds.ini --json");
    const json_t *worker = json_object_get(o, "worker"), *study = json_object_get(o, "study");
    assert_true(number(worker, "x1") == 10.0);
    assert_true(number(worker, "f1") == 10.0);
    assert_true(number(worker, "f2") == 23.0); /* the word in the middle is b */
    assert_true(number(worker, "g_1") == -4.0);
    assert_true(number(worker, "g_2") == 5.0);
    assert_string_equal(json_string_value(json_object_get(worker, "outcome")), "ok");
    const double each = number(study, "simulation_s"), search = number(study, "search_s");
    assert_true(each > 0.0 && fabs(number(study, "seconds") - (30 * each / 2 + search)) < 1e-12);
    assert_text(read_in_place("asked"), "1\n1\n"); /* quick: once more, without the start of the process */
}

TEST(simulate_gives_what_the_run_has_of_every_design_of_its_front)
{
    write_study("kinds.ini", "bounded");
    free(output_of("optimize @/kinds.ini --out @/kinds"));
    free(output_of("simulate @/kinds.ini --design @/kinds/front.csv --csv @/again.csv"));
    OWNED(run_free) Run h = run_in("kinds");
    OWNED(table_free) Table t;
    CHECK_OK(table_read(&t, there("again.csv"), TABLE_WORDS, &err), &err);
    assert_int_equal(t.n_rows, h.n_front);
    assert_less(0, h.n_front);
    for (size_t i = 0; i < t.n_rows; i++) {
        static const char *const NAMES[] = {"f1", "f2", "g_1", "g_2"};
        const Evaluation *e = &h.table.row[h.front[i]];
        double value;
        CHECK_OK(sheet_number(&t, i, "design", NAN, &value, &err), &err);
        assert_int_equal((long)value, i + 1);
        for (int k = 0; k < 4; k++) {
            CHECK_OK(sheet_number(&t, i, NAMES[k], NAN, &value, &err), &err);
            assert_true(value == (k < 2 ? e->f[k] : e->extra[k - 2]));
        }
    }
}

TEST(simulate_takes_one_design_of_a_run_or_a_file_and_refuses_what_only_a_tower_has)
{
    write_study("kinds.ini", "bounded");
    write_in_place("mine.csv", "x3,x2,x1\na,4,7\nb,1,2\n");
    json_t *all = as_json("simulate @/kinds.ini --design @/mine.csv:2 --json"), *one = json_array_get(all, 0);
    assert_true(number(one, "f2") == 20 - 2 + 1 + 3);
    assert_string_equal(json_string_value(json_object_get(one, "x3")), "b");
    json_decref(all);
    expect(2, "--rigid needs problem.kind = tower", "simulate @/kinds.ini --design @/mine.csv --rigid");
    expect(65, "problem.kind = tower", "simulate @/kinds.ini --design none");
    write_in_place("short.csv", "x1,x2\n1,1\n");
    expect(65, "short.csv: has no column x3", "simulate @/kinds.ini --design @/short.csv");
    write_in_place("words.csv", "x1,x2,x3\n1,1,c\n");
    expect(65, "words.csv:2:", "simulate @/kinds.ini --design @/words.csv");
    expect(70, "the simulation failed: the worker ended",
           "simulate @/kinds.ini --design @/mine.csv:1 --set problem.command=true");
}

SUITE(prepare, clear_place)
