/* Constraint values that external workers answer: how many there are is learned, and they bound the front. */
#include "runs.h"

/* Of mode `bounded` the front is x2 = 0, x3 = a, x1 = 6 .. 15 among 882 designs. */
static void write_bounded(const char *name, const char *mode, const char *search)
{
    FREED char *text = formatted(
        "[problem]\nkind = external\ncommand = sh tests/worker.sh %s\nvariables = 3\nobjectives = 2\nlower = 0\n"
        "upper = 20\nkinds = int, int, choice:a|b\n[search]\ninitial = 16\npopulation = 12\nmax_evals = 90\n"
        "threads = 1\n%s",
        mode, search);
    write_in_place(name, text);
}

static void assert_starts_with(const char *file, const char *head)
{
    FREED char *text = read_in_place(file);
    assert_memory_equal(text, head, strlen(head));
}

TEST(the_front_is_that_of_the_designs_whose_constraints_are_kept)
{
    write_bounded("bounded.ini", "bounded", "");
    free(output_of("optimize @/bounded.ini --out @/bounded"));
    OWNED(run_free) Run run = run_in("bounded");
    assert_int_equal(run.n_front, 10);
    for (size_t i = 0; i < run.n_front; i++) {
        const double *x = run_x(&run, run.front[i]);
        assert_true(x[0] == 6.0 + (double)(run_f(&run, run.front[i])[0] - 6.0) && x[1] == 0.0 && x[2] == 0.0);
    }
    for (size_t i = 0; i < run.table.n; i++) {
        const Evaluation *e = &run.table.row[i];
        assert_true(e->extra[0] == 6.0 - e->x[0] && e->extra[1] == e->x[0] + e->x[1] - 15.0);
        assert_true(e->violation == fmax(e->extra[0], 0.0) + fmax(e->extra[1], 0.0));
    }
    assert_starts_with("bounded/front.csv", "id,x1,x2,x3,f1,f2,g_1,g_2\n");
    json_auto_t *all = as_json("export @/bounded --json");
    json_t *last = json_array_get(json_object_get(all, "columns"), 6);
    assert_string_equal(json_string_value(json_object_get(last, "role")), "constraint");
}

TEST(every_design_is_asked_for_once_the_first_one_too)
{
    int asked[91] = {0}, id;
    write_bounded("ids.ini", brief("bounded %.1000s/ids", place.folder), "");
    free(output_of("optimize @/ids.ini --out @/asked"));
    FILE *f = opened(there("ids"), "r");
    while (fscanf(f, "%d", &id) == 1)
        asked[id]++;
    fclose(f);
    for (id = 1; id <= 90; id++)
        assert_int_equal(asked[id], 1);
}

TEST(another_number_of_values_than_in_the_first_answer_fails_the_design_alone)
{
    write_bounded("odd.ini", "unbounded", "");
    free(output_of("optimize @/odd.ini --out @/odd"));
    OWNED(run_free) Run run = run_in("odd");
    assert_int_equal(run.table.n, 90);
    for (size_t i = 0; i < run.table.n; i++)
        assert_int_equal(run.table.row[i].outcome, (i + 1) % 3 == 0 ? OUTCOME_NOT_FINITE : OUTCOME_OK);
    assert_string_equal(run.table.row[2].reason, "g has 0 values and not 2 as in the first answer of the run");
}

/* The designs that fail before are kept as well. */
TEST(where_the_first_designs_fail_the_first_that_succeeds_says_how_many)
{
    write_in_place("late.sh", "while read -r line; do id=${line#*:}; id=${id%%,*}\n"
                              "[ $id -lt 4 ] && echo \"{\\\"id\\\":$id,\\\"error\\\":\\\"early\\\"}\" || "
                              "echo \"{\\\"id\\\":$id,\\\"f\\\":[$id,1],\\\"g\\\":[$id]}\"\ndone\n");
    write_bounded("late.ini", "bounded", "");
    expect(69, "search.limits: none of 87 designs keeps g<=0; those that come nearest",
           "optimize @/late.ini --out @/late --set 'problem.command=sh @/late.sh'");
    OWNED(run_free) Run run = run_in("late");
    for (size_t i = 0; i < run.table.n; i++)
        assert_int_equal(run.table.row[i].outcome, i < 3 ? OUTCOME_ERROR : OUTCOME_OK);
    assert_true(run.schema.n_extra == 1 && run.table.row[3].extra[0] == 4.0);
}

TEST(threads_and_kills_change_no_byte_of_a_search_with_words_numbers_and_constraints)
{
    write_bounded("bytes.ini", "bounded", "");
    free(output_of("optimize @/bytes.ini --out @/whole"));
    free(output_of("optimize @/bytes.ini --out @/three --threads 3"));
    FREED char *whole = all_of("whole"), *three = all_of("three");
    assert_string_equal(whole, three);
    FOR_EACH (size_t, killed_at, 1, 9, 17, 40, 66) {
        const pid_t pid = start("bytes.ini", "killed");
        const double until = clock_seconds() + 60;
        while (finished_in("killed") < *killed_at && clock_seconds() < until)
            rest(0.005);
        kill(pid, SIGKILL);
        wait_end(pid);
    }
    free(output_of("optimize @/bytes.ini --out @/killed"));
    assert_int_equal(finished_in("killed"), 90);
    assert_same_run("whole", "killed");
}

TEST(the_welded_beam_of_the_example_has_four_constraints)
{
    if (system("command -v python3 >/dev/null") != 0)
        skip();
    free(output_of("optimize configs/beam.ini --out @/beam --max-evals 40"));
    OWNED(run_free) Run run = run_in("beam");
    assert_int_equal(run.schema.n_extra, 4);
    assert_less(0, run.n_front);
}

/* What the awk program of the example solves, in closed form. */
TEST(a_simulator_that_reads_a_template_is_searched)
{
    if (system("command -v python3 >/dev/null") != 0)
        skip();
    free(output_of("optimize configs/template.ini --out @/template --max-evals 40"));
    OWNED(run_free) Run run = run_in("template");
    for (size_t i = 0; i < run.table.n; i++) {
        const Evaluation *e = &run.table.row[i];
        const double b = e->x[0], h = e->x[1], steel = e->x[2] == 0, E = steel ? 210000 : 70000;
        assert_close(e->f[0], (steel ? 7.85e-3 : 2.7e-3) * b * h, 1e-8);
        assert_close(e->f[1], 4 * 2000 * 1e9 / (E * b * h * h * h), 1e-8);
        assert_close(e->extra[0], 6 * 2000 * 1e3 / (b * h * h) / (steel ? 235 : 160) - 1, 1e-7);
    }
}

SUITE(prepare, clear_place)
