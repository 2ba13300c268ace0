/* External workers and limits of the system, as the program meets them: what its files and its exit status say. */
#include "runs.h"

static void write_external(const char *name, const char *command, const char *search)
{
    write_in_place(name, brief("[problem]\nkind = external\ncommand = %s\nvariables = 3\nobjectives = 2\n"
                               "[search]\ninitial = 12\npopulation = 12\nthreads = 2\n%s",
                               command, search));
}

static size_t count_failures(const json_t *status)
{
    size_t n = 0;
    const char *outcome;
    json_t *failure;
    json_object_foreach(json_object_get(status, "failures"), outcome, failure) n += (size_t)number(failure, "count");
    return n;
}

TEST(no_design_is_left_out_whatever_its_message)
{
    static const char *const MODES[] = {"umlauts", "latin"};
    for (size_t i = 0; i < 2; i++) {
        write_external("words.ini", brief("sh tests/worker.sh %s", MODES[i]), "max_evals = 24\n");
        free(output_of("optimize @/words.ini --out @/words"));
        json_auto_t *all = as_json("export @/words --json"), *status = as_json("status @/words --json");
        assert_int_equal(json_array_size(json_object_get(all, "evaluations")), 24);
        assert_int_equal(count_failures(status), 8);
        FREED char *csv = all_of("words");
        json_auto_t *text = json_string(csv); /* refuses what is no UTF-8 */
        assert_non_null(text);
        expect_shell("rm -r '%s/words'", place.folder);
    }
}

TEST(names_that_are_no_utf_8_are_shown)
{
    write_in_place("textbook.ini", TEXTBOOK);
    free(output_of("optimize @/textbook.ini --out @/runs/stra\337e"));
    json_auto_t *status = as_json("status @/runs/stra\337e --json"), *list = as_json("status @/runs --json"),
                *all = as_json("export @/runs/stra\337e --json");
    assert_non_null(strstr(json_string_value(json_object_get(status, "run")), "stra\\xDFe"));
    assert_int_equal(json_array_size(list), 1);
    assert_non_null(json_object_get(json_object_get(all, "settings"), "run.out"));
    free(output_of("report @/runs/stra\337e"));
}

/* -- the system ---------------------------------------------------------------------------------------------------- */

/* As a shell starts what stands before `&`. */
TEST(a_signal_that_was_ignored_at_the_start_stays_ignored)
{
    int status;
    write_external("slow.ini", "sh tests/worker.sh steady", "max_evals = 40\n");
    struct sigaction ignored = {.sa_handler = SIG_IGN}, before;
    assert_int_equal(sigaction(SIGINT, &ignored, &before), 0);
    const pid_t pid = start("slow.ini", "ignoring");
    sigaction(SIGINT, &before, NULL);
    rest(0.4);
    kill(pid, SIGINT);
    status = wait_end(pid);
    assert_true(WIFEXITED(status) && WEXITSTATUS(status) == 0);
}

/* Designs that end the worker, keep it too long or have no result fail alone, as they do one by one. */
TEST(designs_that_are_asked_together_have_the_answers_of_those_asked_one_by_one)
{
    static const char HOW[][9] = {"alone", "together"};
    for (int i = 0; i < 2; i++) {
        FREED char *text = formatted(
            "[problem]\nkind = external\ncommand = python3 tests/batch_worker.py %s %s/sizes-%s\nvariables = 2\n"
            "objectives = 2\ntimeout_s = 4\n[search]\ninitial = 40\npopulation = 20\nmax_evals = 120\n"
            "threads = %d\nfailures_max = 0\n",
            HOW[i], place.folder, HOW[i], 1 + i);
        write_in_place("batch.ini", text);
        free(output_of("optimize @/batch.ini --out @/%s", HOW[i]));
    }
    FREED char *alone = all_of("alone"), *together = all_of("together"), *sizes = read_in_place("sizes-together");
    assert_string_equal(alone, together);
    assert_words(alone, ",dead,", ",timeout,", ",error,no");
    assert_non_null(strstr(sizes, "8\n")); /* lines of two workers: which follows which is chance */
}

/* Nor does a kill: the run goes on at once, even where one of them could do nothing any more. */
TEST(processes_of_their_own_change_no_byte)
{
    write_in_place("isolated.ini", SIX_FLOORS_INI "[sim]\nduration_s = 5\n[search]\nmax_evals = 80\npolish = 0\n"
                                                  "threads = 2\n[run]\nisolate = yes\n");
    const pid_t pid = start("isolated.ini", "apart");
    for (int i = 0; i < 1000 && !signal_child_of(pid, "STOP"); i++)
        rest(0.01);
    kill(pid, SIGKILL);
    wait_end(pid);
    free(output_of("optimize @/isolated.ini --out @/apart"));
    free(output_of("optimize @/isolated.ini --out @/here --set run.isolate=no --threads 1"));
    assert_same_files("apart/front.csv", "here/front.csv");
}

/* Processes are shot from the start to the end: they begin, simulate, or have just done so, and then another one gets
 * the next design. */
TEST(a_simulation_that_crashes_ends_its_design_alone)
{
    write_in_place("isolated.ini", ISOLATED);
    const pid_t pid = start("isolated.ini", "shot");
    size_t n_shot = 0;
    int status;
    while (waitpid(pid, &status, WNOHANG) == 0) {
        rest(0.02);
        n_shot += (size_t)signal_child_of(pid, "KILL");
    }
    assert_true(WIFEXITED(status));
    assert_int_equal(WEXITSTATUS(status), 0);
    FREED char *all = all_of("shot");
    size_t n_lost = 0, n = 0;
    for (const char *at = all; (at = strchr(at, '\n')); at++, n++) {
        const char *lost = strstr(at, "its process ended");
        n_lost += lost && lost < strchrnul(at + 1, '\n');
    }
    assert_int_equal(n, 81);
    assert_true(n_lost >= 1 && n_lost <= n_shot);
    assert_non_null(strstr(all, "its process ended: Killed"));
}

SUITE(prepare, clear_place)
