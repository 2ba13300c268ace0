/* A run read back from its database: what is wrong in one cell is named, and who is on the front is worked out anew. */
#include "runs.h"

#include <sqlite3.h>
#include <sys/stat.h>

#include "store/run.h"
#include "store/lock.h"

static void change(const char *database, const char *sql)
{
    char path[PATH_MAX], *why = NULL;
    sqlite3 *db;
    assert_int_equal(sqlite3_open(path_of(database, path), &db), SQLITE_OK);
    if (sqlite3_exec(db, sql, NULL, NULL, &why) != SQLITE_OK)
        fail_msg("%s: %s", sql, why);
    sqlite3_close(db);
}

/* The sound run, copied, with that change. */
static const char *changed(const char *sql, char folder[PATH_MAX])
{
    char command[512];
    snprintf(command, sizeof command, "rm -rf '%s/other'; cp -r '%s/sound' '%s/other'", place.folder, place.folder,
             place.folder);
    assert_int_equal(system(command), 0);
    change("other/run.sqlite", sql);
    return path_of("other", folder);
}

static void test_what_is_wrong_in_one_cell_is_named(void **state)
{
    (void)state;
    static const struct {
        const char *sql, *words;
        Status status;
    } CASES[] = {
        {"UPDATE evaluation SET x = '' WHERE id = 2", "x of evaluation 2 cannot be read", STATUS_IO},
        {"UPDATE evaluation SET x = '[0,0,0,0,0,0' WHERE id = 2", "x of evaluation 2", STATUS_IO},
        {"UPDATE evaluation SET x = '[0,0,0,0,0,0]]' WHERE id = 2", "x of evaluation 2", STATUS_IO},
        {"UPDATE evaluation SET x = '0,0,0,0,0,0]' WHERE id = 2", "x of evaluation 2", STATUS_IO},
        {"UPDATE evaluation SET x = '[0,0;0,0,0,0]' WHERE id = 2", "x of evaluation 2", STATUS_IO},
        {"UPDATE evaluation SET f = '[1,2]' WHERE id = 3", "f of evaluation 3", STATUS_IO},
        {"UPDATE evaluation SET f = '[1,inf,2]' WHERE id = 3", "f of evaluation 3", STATUS_IO},
        {"UPDATE evaluation SET f = '[1,,2]' WHERE id = 3", "f of evaluation 3", STATUS_IO},
        {"UPDATE evaluation SET spread = '[1,2,3,4]' WHERE id = 4", "spread of evaluation 4", STATUS_IO},
        {"UPDATE evaluation SET f = '[1,2,3]' WHERE id = 3", "evaluation 3 is not what was written", STATUS_IO},
        {"UPDATE evaluation SET x = replace(x, '1', '3') WHERE id = 5", "evaluation 5 is not what was written",
         STATUS_IO},
        {"UPDATE evaluation SET outcome = 'error' WHERE id = 6", "evaluation 6 is not what was written", STATUS_IO},
        {"UPDATE evaluation SET kind = 'infill' WHERE id = 6", "evaluation 6 is not what was written", STATUS_IO},
        {"UPDATE evaluation SET kind = NULL WHERE id = 6", "evaluation 6 is not what was written", STATUS_IO},
        {"UPDATE evaluation SET generation = 1 WHERE id = 6", "evaluation 6 is not what was written", STATUS_IO},
        {"UPDATE generation SET hypervolume = hypervolume / 2 WHERE number = 1", "generation 1 is not what was written",
         STATUS_IO},
        {"UPDATE generation SET front = front + 1 WHERE number = 2", "generation 2 is not what was written", STATUS_IO},
        {"UPDATE generation SET hypervolume = 1, digest = NULL WHERE number = 1",
         "generation 1 is not what was written", STATUS_IO},
        {"UPDATE generation SET hypervolume = 1, digest = NULL", "its generations have no digest", STATUS_IO},
        {"UPDATE front SET left = 1 WHERE left IS NULL", "its front is not what was written", STATUS_IO},
        {"UPDATE run SET settings = replace(settings, 'seed = 1', 'seed = 3')", "its settings are not what was written",
         STATUS_IO},
        {"DELETE FROM run", "it has no settings", STATUS_IO},
        {"UPDATE run SET n_var = 5", "it has 5 variables", STATUS_IO},
        {"UPDATE run SET n_var = 0", "it has 0 variables", STATUS_IO},
        {"UPDATE run SET n_var = 20000", "it has 20000 variables", STATUS_IO},
        {"UPDATE run SET settings = '[problem]' || char(10) || 'kind = nonsense'", "problem.kind", STATUS_BAD_DATA},
        {"UPDATE run SET settings = '', n_var = 2", "it has 2 variables", STATUS_IO}, /* of a tower */
        {"UPDATE evaluation SET f = '[0,0,0]', digest = NULL WHERE id = 2", "evaluation 2 has no digest", STATUS_IO},
        {"DELETE FROM evaluation WHERE id = 2", "evaluation 2 is missing", STATUS_IO},
        {"DELETE FROM evaluation WHERE id = 40", "evaluation 40 is missing", STATUS_IO},
        {"DELETE FROM evaluation", "evaluation 1 is missing", STATUS_IO},
        {"ALTER TABLE session DROP COLUMN stopped", "1 of its 6 tables are not those of a run", STATUS_IO},
    };
    char folder[PATH_MAX];
    FILE *nowhere = fopen("/dev/null", "we");
    assert_non_null(nowhere);
    for (size_t i = 0; i < sizeof CASES / sizeof CASES[0]; i++) {
        Run h;
        Err err = {0};
        const Status status = run_read(&h, changed(CASES[i].sql, folder), &err);
        if (status != CASES[i].status || !strstr(err.text, CASES[i].words))
            fail_msg("%s: %d, %s", CASES[i].sql, status, err.text);
        assert_true(h.table.n == 0 && !h.table.row && !h.state);
        const char *which = strstr(CASES[i].words, "evaluation ");
        if (which && run_print_evaluations(folder, export_evaluations_header, nowhere, &err) != STATUS_IO)
            fail_msg("%s: is exported", CASES[i].sql);
        if (which && !strncmp(which, "evaluation 2", 12) && !strstr(err.text, "evaluation 2"))
            fail_msg("%s: exported: %s", CASES[i].sql, err.text);
    }
    fclose(nowhere);
}

static void test_a_run_read_without_its_variables_has_the_same_results(void **state)
{
    (void)state;
    Run whole, part;
    Err err = {0};
    char folder[PATH_MAX];
    free(output_of("optimize @/textbook.ini --set problem.noise=0 --out @/silent"));
    CHECK_OK(run_read(&whole, path_of("silent", folder), &err), &err);
    CHECK_OK(run_read_part(&part, folder, RUN_RESULTS, &err), &err);
    const size_t n = whole.table.n, m = whole.schema.n_obj;
    assert_true(part.table.n_var == 0 && part.schema.n_var == whole.schema.n_var);
    assert_true(n > 10 && part.table.n == n);
    assert_memory_equal(part.F, whole.F, n * m * sizeof *whole.F);
    assert_memory_equal(part.place, whole.place, n * sizeof *whole.place);
    assert_true(part.n_front == whole.n_front && part.n_failed == whole.n_failed);
    assert_memory_equal(part.front, whole.front, whole.n_front * sizeof *whole.front);
    run_free(&whole);
    run_free(&part);
}

/* The first number is changed, so that it shows where it comes from. */
static void test_a_run_of_which_results_are_known_is_the_one_that_is_read(void **state)
{
    (void)state;
    Run read, known;
    Database *d;
    Results passed;
    Err err = {0};
    char folder[PATH_MAX], path[PATH_MAX + 16];
    CHECK_OK(run_read_part(&read, path_of("silent", folder), RUN_RESULTS, &err), &err);
    snprintf(path, sizeof path, "%s/run.sqlite", folder);
    CHECK_OK(database_open(&d, path, DATABASE_READ, &err), &err);
    const size_t n = read.table.n, m = read.schema.n_obj;
    results_begin(&passed, n - 5, m);
    for (size_t i = 0; i < n; i++)
        results_take(&passed, &read.table.row[i]);
    assert_int_equal(passed.n, n - 5);
    passed.f[0] += 1.0;
    CHECK_OK(run_review(&known, d, folder, &passed, &err), &err);
    assert_close(known.F[0], read.F[0] + 1.0, 0.0);
    assert_int_equal(known.table.n, n);
    assert_memory_equal(known.F + 1, read.F + 1, (n * m - 1) * sizeof *read.F);
    assert_memory_equal(known.place, read.place, n * sizeof *read.place);
    for (size_t i = 0; i < n; i++) {
        const Evaluation *a = &known.table.row[i], *b = &read.table.row[i];
        assert_true(a->id == b->id && a->generation == b->generation && a->kind == b->kind && a->outcome == b->outcome);
        assert_true(a->seconds == b->seconds && a->violation == b->violation && strcmp(a->reason, b->reason) == 0);
        assert_memory_equal(a->sd, b->sd, m * sizeof *a->sd);
    }
    run_free(&known);
    results_free(&passed);
    results_begin(&passed, n, m);
    results_take(&passed, &read.table.row[0]);
    read.table.row[1].outcome = OUTCOME_DEAD;
    for (size_t i = 1; i < n; i++)
        results_take(&passed, &read.table.row[i]);
    assert_int_equal(passed.n, 0);
    results_free(&passed);
    database_close(d);
    run_free(&read);
}

static void test_a_run_that_lost_an_evaluation_is_not_resumed_and_its_files_keep_it(void **state)
{
    (void)state;
    Said s;
    Run end;
    Err err = {0};
    char folder[PATH_MAX];
    free(output_of("optimize @/textbook.ini --set problem.noise=0 --out @/sound --new"));
    char *before = read_in_place("sound-2/evaluations.csv");
    change("sound-2/run.sqlite", "DELETE FROM evaluation WHERE id = 20");
    assert_int_equal(run_read_part(&end, path_of("sound-2", folder), RUN_ENDED, &err), STATUS_IO);
    assert_non_null(strstr(err.text, "evaluation 20 is missing"));
    assert_int_equal(unlink(path_of("sound-2/front.csv", folder)), 0);
    run(&s, "optimize @/textbook.ini --set problem.noise=0 --out @/sound-2 --max-evals 50 --force-settings");
    assert_int_equal(s.code, 74);
    assert_non_null(strstr(s.err, "evaluation 20 is missing; evaluations.csv beside it has 40 evaluations: --new"));
    char *after = read_in_place("sound-2/evaluations.csv");
    assert_string_equal(before, after);
    forget(&s);
    free(before);
    free(after);
}

static void test_json_for_which_there_is_no_room_is_an_output_that_cannot_be_written(void **state)
{
    (void)state;
    Err err = {0};
    char folder[PATH_MAX];
    FILE *full = fopen("/dev/full", "we");
    assert_non_null(full);
    setvbuf(full, NULL, _IONBF, 0);
    assert_int_equal(export_json_of(full, path_of("sound", folder), &err), STATUS_IO);
    assert_string_equal(err.text, "standard output: cannot be written");
    fclose(full);
}

static void test_values_that_are_not_known_are_nan_and_a_word_that_is_not_known_is_unfinished(void **state)
{
    (void)state;
    Run h;
    Err err = {0};
    char folder[PATH_MAX];
    CHECK_OK(run_read(&h,
                      changed("UPDATE evaluation SET digest = NULL;"
                              "UPDATE evaluation SET f = '[1,null,3]', spread = NULL, seconds = NULL WHERE id = 1;"
                              "UPDATE evaluation SET kind = 'guessed' WHERE id = 2;"
                              "UPDATE state SET bytes = x'';"
                              "UPDATE session SET search = NULL, ended = NULL",
                              folder),
                      &err),
             &err);
    assert_true(h.table.row[0].id == 1 && !h.place[0].ok && !h.place[0].on_front && h.F[0] == 1 && isnan(h.F[1]));
    assert_true(isnan(h.table.row[0].seconds) && isnan(h.table.sd[0]));
    assert_int_equal(h.table.row[1].kind, KIND_UNFINISHED);
    assert_true(h.state && h.n_state == 0);
    assert_true(h.n_sessions > 0 && isnan(h.session[0].search_s) && h.session[0].ended[0] == 0);
    run_free(&h);
}

/* With three replicates; of the last generation, which is not finished, one row is whole but for its cheap part. */
static void test_rows_of_a_generation_that_is_not_finished_count_as_what_is_simulated_of_them(void **state)
{
    (void)state;
    Run h;
    Err err = {0};
    char folder[PATH_MAX];
    CHECK_OK(run_read(&h,
                      changed("UPDATE evaluation SET digest = NULL, kind = 'screened', spread = NULL;"
                              "UPDATE evaluation SET kind = 'finished' WHERE id = 7;"
                              "UPDATE evaluation SET kind = NULL WHERE id > 9",
                              folder),
                      &err),
             &err);
    const size_t n = run_first_polished(&h), open = n - 9;
    assert_less(11, n);
    h.table.row[10].sd[0] = 1.0;
    h.settings->problem.kind = PROBLEM_TOWER;
    h.settings->problem.noisy = NOISY_NO;
    h.settings->search.fidelity = FIDELITY_REPLICATES;
    h.settings->sim.replicates = 3;
    assert_true(run_is_screened(&h));
    assert_int_equal(run_evaluations(&h, 0), (8 + 2 + open + 1) / 3);
    assert_int_equal(run_evaluations(&h, 9), (open + 1) / 3);
    h.settings->search.fidelity = FIDELITY_OFF;
    assert_false(run_is_screened(&h));
    assert_int_equal(run_evaluations(&h, 9), open);
    run_free(&h);
}

static void test_a_run_from_before_the_choice_of_core_theory_keeps_the_only_one_there_was(void **state)
{
    (void)state;
    Run h;
    Err err = {0};
    char folder[PATH_MAX];
    CHECK_OK(run_read(&h, path_of("sound", folder), &err), &err);
    assert_int_equal(h.settings->core.theory, CORE_TIMOSHENKO);
    run_free(&h);
    CHECK_OK(
        run_read(
            &h,
            changed("UPDATE run SET settings = replace(settings, 'theory = timoshenko' || char(10), ''), digest = NULL",
                    folder),
            &err),
        &err);
    assert_int_equal(h.settings->core.theory, CORE_EULER_BERNOULLI);
    run_free(&h);
}

/* Feasible, whole, and nobody better: by comparing everybody with everybody. */
static int belongs_on_front(const Run *h, size_t i)
{
    const size_t m = h->schema.n_obj;
    for (size_t j = 0; j < h->table.n; j++) {
        size_t no_worse = 0, better = 0;
        if (!h->place[j].ok || h->table.row[j].violation > 0 || h->table.row[j].kind == KIND_UNFINISHED)
            continue;
        for (size_t k = 0; k < m; k++) {
            no_worse += h->F[j * m + k] <= h->F[i * m + k];
            better += h->F[j * m + k] < h->F[i * m + k];
        }
        if (no_worse == m && better > 0)
            return 0;
    }
    return h->place[i].ok && !(h->table.row[i].violation > 0);
}

static void test_polished_designs_compete_with_the_front_and_can_be_dropped(void **state)
{
    (void)state;
#define ROW(id, outcome, f, violation)                                                                                 \
    "INSERT INTO evaluation(id, generation, kind, outcome, reason, seconds, x, f, violation) VALUES (" #id             \
    ", 1, 'polished', '" outcome "', '', 0.1, '[0,0,0,0,0,0]', '" f "', " #violation ");"
    static const char POLISHED[] = ROW(1000001, "ok", "[0,0,0.9]", 0) ROW(1000002, "ok", "[0,0,1.5]", 0)
        ROW(1000003, "error", "[0,0,0]", 0) ROW(1000004, "ok", "[0,0,0.1]", 0.5) ROW(1000005, "ok", "[9,9,9]", 0)
            ROW(1000006, "ok", "[0,0,0.9]", 0) "UPDATE evaluation SET digest = NULL;";
    Run sound, h;
    Err err = {0};
    char folder[PATH_MAX];
    CHECK_OK(run_read(&sound, path_of("sound", folder), &err), &err);
    CHECK_OK(run_read(&h, changed(POLISHED, folder), &err), &err);
    assert_int_equal(h.table.n, sound.table.n + 6);
    size_t n_front = 0;
    for (size_t i = 0; i < h.table.n; i++) {
        if (h.place[i].on_front != belongs_on_front(&h, i))
            fail_msg("design %ld", h.table.row[i].id);
        n_front += h.place[i].on_front != 0;
    }
    assert_int_equal(h.n_front, n_front);
    assert_true(h.place[sound.table.n].on_front && !h.place[sound.table.n + 1].on_front &&
                h.place[sound.table.n + 5].on_front);
    assert_int_equal(h.n_failed, sound.n_failed + 1);

    run_drop_polished(&h);
    assert_true(h.table.n == sound.table.n && h.n_front == sound.n_front && h.n_failed == sound.n_failed);
    for (size_t i = 0; i < h.table.n; i++)
        assert_int_equal(h.place[i].on_front, sound.place[i].on_front);
    run_free(&h);
    run_free(&sound);
}

static void test_a_folder_without_a_run_or_with_too_long_a_name_is_told(void **state)
{
    (void)state;
    char path[PATH_MAX], name[PATH_MAX + 64];
    Run run;
    Err err = {0};
    assert_int_equal(run_read(&run, path_of("nothing", path), &err), STATUS_MISSING);
    assert_non_null(strstr(err.text, "nothing: holds no run: run.sqlite is not there"));
    memset(name, 'a', sizeof name);
    name[sizeof name - 1] = 0;
    assert_int_equal(run_read(&run, name, &err), STATUS_MISSING);
    assert_non_null(strstr(err.text, "holds no run"));
    assert_false(run_path(name, path, sizeof path));
}

/* Names with quotes are columns of the view `designs`; more than a view can hold are not. */
static void test_the_view_has_a_column_for_every_name_or_there_is_none(void **state)
{
    (void)state;
    char path[PATH_MAX];
    sqlite3 *db;
    sqlite3_stmt *row;
    write_in_place("names.ini", "[problem]\nkind = dtlz2\nvariables = 3\nobjectives = 2\nobjective_names = a b,it's\n"
                                "[search]\ninitial = 12\npopulation = 8\nmax_evals = 12\n");
    write_in_place("many.ini", "[problem]\nkind = external\ncommand = sh tests/worker.sh good\nvariables = 1000\n"
                               "objectives = 2\n[search]\ninitial = 12\npopulation = 8\nmax_evals = 12\n");
    free(output_of("optimize @/names.ini --out @/names"));
    assert_int_equal(sqlite3_open(path_of("names/run.sqlite", path), &db), SQLITE_OK);
    assert_int_equal(sqlite3_prepare_v2(db, "SELECT \"a b\", \"it's\" FROM designs", -1, &row, NULL), SQLITE_OK);
    assert_int_equal(sqlite3_step(row), SQLITE_ROW);
    sqlite3_finalize(row);
    sqlite3_close(db);
    free(output_of("optimize @/many.ini --out @/many"));
    assert_int_equal(sqlite3_open(path_of("many/run.sqlite", path), &db), SQLITE_OK);
    assert_int_equal(sqlite3_prepare_v2(db, "SELECT * FROM designs", -1, &row, NULL), SQLITE_ERROR);
    sqlite3_close(db);
}

static void test_a_lock_names_its_holder_and_who_cannot_have_one_is_told_why(void **state)
{
    (void)state;
    char path[PATH_MAX];
    int first, second;
    LockHolder holder;
    Err err = {0};
    CHECK_OK(lock_take(path_of("lock", path), &first, &err), &err);
    assert_true(lock_is_held(path, &holder) && holder.pid == getpid());
    assert_int_equal(lock_take(path, &second, &err), STATUS_IO);
    assert_int_equal(second, -1);
    assert_non_null(strstr(err.text, "is in use by process"));
    write_in_place("lock", ""); /* whoever emptied it: it is held all the same */
    assert_true(lock_is_held(path, &holder));
    assert_string_equal(holder.host, "an unknown machine");
    lock_release(first);
    assert_false(lock_is_held(path, &holder));
    assert_int_equal(lock_take("/dev/full", &first, &err), STATUS_IO);
    assert_int_equal(first, -1);
    assert_non_null(strstr(err.text, "/dev/full: cannot be written"));
    assert_int_equal(lock_take(path_of("no/such/folder", path), &first, &err), STATUS_IO);
    assert_false(lock_is_held(path, &holder));
}

/* As a killed process that the system still tears down. */
static void test_who_lets_go_of_a_lock_within_a_second_is_waited_for(void **state)
{
    (void)state;
    char path[PATH_MAX], word;
    int fd, ends[2];
    Err err = {0};
    path_of("passing", path);
    assert_int_equal(pipe(ends), 0);
    const pid_t pid = fork();
    if (pid == 0) {
        const int taken = lock_take(path, &fd, &err) == STATUS_OK && write(ends[1], "!", 1) == 1;
        usleep(300000);
        _exit(taken ? 0 : 1);
    }
    close(ends[1]);
    assert_int_equal(read(ends[0], &word, 1), 1);
    close(ends[0]);
    CHECK_OK(lock_take(path, &fd, &err), &err);
    lock_release(fd);
    assert_int_equal(wait_end(pid), 0);
}

static int make_sound(void **state)
{
    if (prepare(state) != 0)
        return -1;
    write_in_place("textbook.ini", TEXTBOOK);
    free(output_of("optimize @/textbook.ini --out @/sound"));
    return 0;
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_what_is_wrong_in_one_cell_is_named),
        cmocka_unit_test(test_a_run_read_without_its_variables_has_the_same_results),
        cmocka_unit_test(test_a_run_of_which_results_are_known_is_the_one_that_is_read),
        cmocka_unit_test(test_a_run_that_lost_an_evaluation_is_not_resumed_and_its_files_keep_it),
        cmocka_unit_test(test_json_for_which_there_is_no_room_is_an_output_that_cannot_be_written),
        cmocka_unit_test(test_values_that_are_not_known_are_nan_and_a_word_that_is_not_known_is_unfinished),
        cmocka_unit_test(test_rows_of_a_generation_that_is_not_finished_count_as_what_is_simulated_of_them),
        cmocka_unit_test(test_a_run_from_before_the_choice_of_core_theory_keeps_the_only_one_there_was),
        cmocka_unit_test(test_polished_designs_compete_with_the_front_and_can_be_dropped),
        cmocka_unit_test(test_a_folder_without_a_run_or_with_too_long_a_name_is_told),
        cmocka_unit_test(test_the_view_has_a_column_for_every_name_or_there_is_none),
        cmocka_unit_test(test_a_lock_names_its_holder_and_who_cannot_have_one_is_told_why),
        cmocka_unit_test(test_who_lets_go_of_a_lock_within_a_second_is_waited_for),
    };
    return cmocka_run_group_tests_name("saved", tests, make_sound, clear_place);
}
