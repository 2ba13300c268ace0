/* A run read back from its database: what is wrong in one cell is named, and who is on the front is worked out anew. */
#include "runs.h"

#include "store/run.h"
#include "base/dominance.h"
#include "store/database.h"
#include "store/folder.h"
#include "study/merged.h"

/* The sound run, copied, with that change. */
static const char *changed(const char *sql, char folder[PATH_MAX])
{
    shell_in_place("rm -rf other; cp -r sound other");
    change_database("other/run.sqlite", sql);
    return path_of("other", folder);
}

TEST(what_is_wrong_in_one_cell_is_named)
{
    static const struct {
        const char *sql, *words;
        Status status;
    } CASES[] = {
        {"UPDATE evaluation SET f2 = f2 * (1 + 1e-15) WHERE id = 3", "evaluation 3 is not what was written", STATUS_IO},
        {"UPDATE evaluation SET x2 = x3, x3 = x2 WHERE id = 5", "evaluation 5 is not what was written", STATUS_IO},
        {"UPDATE evaluation SET x1 = NULL WHERE id = 5", "evaluation 5 is not what was written", STATUS_IO},
        {"UPDATE evaluation SET x1 = 'word' WHERE id = 5", "evaluation 5 is not what was written", STATUS_IO},
        {"UPDATE evaluation SET outcome = 'guessed' WHERE id = 6", "evaluation 6 is not what was written", STATUS_IO},
        {"UPDATE evaluation SET f1_sd = 1 WHERE id = 4", "evaluation 4 is not what was written", STATUS_IO},
        {"UPDATE evaluation SET outcome = 'error' WHERE id = 6", "evaluation 6 is not what was written", STATUS_IO},
        {"UPDATE evaluation SET kind = 'infill' WHERE id = 6", "evaluation 6 is not what was written", STATUS_IO},
        {"UPDATE evaluation SET kind = NULL WHERE id = 6", "evaluation 6 is not what was written", STATUS_IO},
        {"UPDATE evaluation SET generation = 1 WHERE id = 6", "evaluation 6 is not what was written", STATUS_IO},
        {"UPDATE generation SET hypervolume = 0.5 WHERE number = 1", "generation 1 is not what was written", STATUS_IO},
        {"UPDATE generation SET front = front + 1 WHERE number = 2", "generation 2 is not what was written", STATUS_IO},
        {"UPDATE front SET left = 1 WHERE left IS NULL", "its front is not what was written", STATUS_IO},
        {"UPDATE run SET settings = replace(settings, 'seed = 1', 'seed = 3')", "its settings are not what was written",
         STATUS_IO},
        {"DELETE FROM run", "it has no settings", STATUS_IO},
        {"UPDATE run SET n_var = 5", "its settings are not what was written", STATUS_IO},
        {"DELETE FROM evaluation WHERE id = 2", "evaluation 2 is missing", STATUS_IO},
        {"DELETE FROM evaluation WHERE id = 40", "evaluation 40 is missing", STATUS_IO},
        {"DELETE FROM evaluation", "evaluation 1 is missing", STATUS_IO},
        {"ALTER TABLE session DROP COLUMN stopped", "its table session is not that of this run", STATUS_IO},
        {"ALTER TABLE evaluation RENAME COLUMN x2 TO x7", "its table evaluation is not that of this run", STATUS_IO},
        {"ALTER TABLE finer ADD COLUMN level2 INTEGER", "its table finer is not that of this run", STATUS_IO}};
    char folder[PATH_MAX];
    for (size_t i = 0; i < sizeof CASES / sizeof CASES[0]; i++) {
        Run h;
        assert_refused(run_read(&h, changed(CASES[i].sql, folder), &err), CASES[i].status, CASES[i].words);
        assert_true(h.table.n == 0 && !h.table.row && !h.state);
        assert_int_equal(err.sub, SUB_DAMAGED);
    }
}

TEST(a_run_that_lost_an_evaluation_is_not_resumed)
{
    free(output_of("optimize @/textbook.ini " EXACT "--out @/sound --new"));
    change_database("sound-2/run.sqlite", "DELETE FROM evaluation WHERE id = 20");
    expect(74, "evaluation 20 is missing; --new --set search.start=",
           "optimize @/textbook.ini " EXACT "--out @/sound-2 --max-evals 50");
}

TEST(json_for_which_there_is_no_room_is_an_output_that_cannot_be_written)
{
    FILE *full = opened("/dev/full", "we");
    setvbuf(full, NULL, _IONBF, 0);
    OWNED(run_free) Run run = run_in("sound");
    assert_int_equal(export_json(full, &run, &err), STATUS_IO);
    assert_string_equal(err.text, "standard output: cannot be written");
    fclose(full);
}

/* With three replicates; of the last generation, which is not finished, one row is whole but for its cheap part. */
TEST(rows_of_a_generation_that_is_not_finished_count_as_what_is_simulated_of_them)
{
    OWNED(run_free) Run h = run_in("sound");
    const size_t n = run_first_polished(&h), open = n - 9;
    assert_less(11, n);
    for (size_t i = 0; i < n; i++) {
        h.table.row[i].kind = i == 6 ? KIND_FINISHED : i < 9 ? KIND_SCREENED : KIND_UNFINISHED;
        h.table.row[i].sd[0] = NAN;
    }
    h.table.row[10].sd[0] = 1.0;
    h.settings->problem.kind = PROBLEM_TOWER;
    h.settings->problem.noisy = NOISY_NO;
    h.settings->search.fidelity = FIDELITY_REPLICATES;
    h.settings->sim.replicates = 3;
    assert_true(settings_screens(h.settings));
    assert_int_equal(run_evaluations(&h, 0), (8 + 2 + open + 1) / 3);
    assert_int_equal(run_evaluations(&h, 9), (open + 1) / 3);
    h.settings->search.fidelity = FIDELITY_OFF;
    assert_false(settings_screens(h.settings));
    assert_int_equal(run_evaluations(&h, 9), open);
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

TEST(polished_designs_compete_with_the_front_and_can_be_dropped)
{
    double x[6] = {0}, f[6][3] = {{0, 0, 0.9}, {0, 0, 1.5}, {0}, {0, 0, 0.1}, {9, 9, 9}, {0, 0, 0.9}};
    Evaluation designs[6];
    for (size_t i = 0; i < 6; i++)
        designs[i] = (Evaluation){
            .outcome = i == 2 ? OUTCOME_ERROR : OUTCOME_OK, .x = x, .f = f[i], .violation = i == 3 ? 0.5 : 0.0};
    OWNED(run_free) Run sound, h;
    char folder[PATH_MAX];
    sound = run_in("sound");
    CHECK_OK(add_to_run(changed("SELECT 1", folder), 6, designs, NULL, &err), &err);
    CHECK_OK(run_read(&h, folder, &err), &err);
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
}

TEST(a_run_read_for_its_front_has_the_front_and_the_counts_of_the_whole)
{
    char folder[PATH_MAX];
    write_in_place("plain.ini", DTLZ2_INI(4, 2));
    free(output_of("optimize @/plain.ini --max-evals 150 --out @/halves"));
    path_of("halves", folder);
    OWNED(run_free) Run whole = {0}, part = {0};
    CHECK_OK(run_read(&whole, folder, &err), &err);
    Database *d;
    CHECK_OK(database_open(&d, brief("%s/run.sqlite", folder), DATABASE_READ, &err), &err);
    CHECK_OK(run_load(&part, d, folder, RUN_FRONT, &err), &err);
    database_close(d);
    assert_less(part.table.n, whole.table.n);
    assert_int_equal(part.n_front, whole.n_front);
    assert_int_equal(part.n_failed, whole.n_failed);
    assert_int_equal(part.n_repeats, whole.n_repeats);
    assert_int_equal(part.n_finished, whole.n_finished);
    for (size_t i = 0; i < part.n_front; i++) {
        assert_int_equal(part.table.row[part.front[i]].id, whole.table.row[whole.front[i]].id);
        for (size_t k = 0; k < 2; k++)
            assert_same_number(part.F[2 * part.front[i] + k], whole.F[2 * whole.front[i] + k]);
    }
}

/* The square of the distance of the nearest of `chosen` to design i, each objective as a share of its range on the front. */
static double apart2(const Run *run, size_t i, size_t n, const size_t chosen[])
{
    double nearest = INFINITY;
    for (size_t c = 0; c < n; c++) {
        double sum = 0;
        for (size_t k = 0; k < 2; k++) {
            double low = INFINITY, high = -INFINITY;
            for (size_t j = 0; j < run->n_front; j++) {
                low = fmin(low, run->F[2 * run->front[j] + k]);
                high = fmax(high, run->F[2 * run->front[j] + k]);
            }
            const double other = chosen[c] < run->table.n ? run->F[2 * chosen[c] + k] : low;
            sum += pow((run->F[2 * i + k] - other) / (high - low), 2);
        }
        nearest = fmin(nearest, sum);
    }
    return nearest;
}

TEST(a_choice_of_three_begins_with_the_knee_and_goes_on_with_the_farthest)
{
    OWNED(run_free) Run run = {0};
    CHECK_OK(run_read(&run, there("halves"), &err), &err);
    size_t rows[3];
    const size_t ideal = run.table.n;
    assert_int_equal(run_spread_out(&run, 3, 1, rows), 3);
    for (size_t j = 0; j < run.n_front; j++) {
        const size_t i = run.front[j];
        assert_true(apart2(&run, i, 1, &ideal) >= apart2(&run, rows[0], 1, &ideal));
        for (size_t n = 1; n < 3; n++)
            assert_true(apart2(&run, i, n, rows) <= apart2(&run, rows[n], n, rows));
    }
}

/* Whether a design of the front of a or b dominates row i of a. */
static int is_dominated(const Run *a, size_t i, const Run *b)
{
    double f[OBJECTIVES_MAX], g[OBJECTIVES_MAX];
    int is = 0;
    run_minimise(a, i, f);
    for (size_t j = 0; j < b->n_front; j++) {
        run_minimise(b, b->front[j], g);
        is |= dominates(a->schema.n_obj, g, f);
    }
    return is;
}

TEST(several_runs_are_one_front_on_which_a_design_stands_once)
{
    OWNED(run_free) Run a, b, both;
    size_t n = 0;
    char path[2][PATH_MAX];
    write_in_place("plain.ini", DTLZ2_INI(4, 2));
    free(output_of("optimize @/plain.ini --max-evals 150 --out @/first"));
    free(output_of(
        "optimize @/plain.ini --max-evals 150 --out @/second --set search.seed=2 --set search.start=@/first"));
    const char *const folders[] = {path_of("first", path[0]), path_of("second", path[1])};
    CHECK_OK(run_read(&a, folders[0], &err), &err);
    CHECK_OK(run_read(&b, folders[1], &err), &err);
    CHECK_OK(merged_read(&both, 2, folders, &err), &err);
    assert_int_equal(both.table.n, a.table.n + b.table.n);
    assert_int_equal(both.id_step, 1000);
    for (size_t i = 0; i < a.n_front; i++)
        n += !is_dominated(&a, a.front[i], &b);
    const size_t n_first = n;
    for (size_t i = 0; i < b.n_front; i++) {
        int is_twice = 0;
        for (size_t j = 0, d; j < a.n_front; j++) {
            for (d = 0; d < 4 && run_x(&a, a.front[j])[d] == run_x(&b, b.front[i])[d];)
                d++;
            is_twice |= d == 4;
        }
        n += !is_twice && !is_dominated(&b, b.front[i], &a);
    }
    assert_less(0, n_first);
    assert_less(n_first, n);
    assert_less(n, n_first + b.n_front); /* the second one began with the front of the first */
    assert_int_equal(both.n_front, n);
    const size_t last = both.front[n - 1];
    assert_int_equal(both.table.row[last].id, b.table.row[last - a.table.n].id + both.id_step);
    free(output_of("export @/first @/second --csv @/both.csv"));
    OWNED(table_free) Table t = table_of("both.csv");
    assert_int_equal(t.n_rows, n);
    assert_same_number(t.values[(n - 1) * t.n_cols], (double)both.table.row[last].id);
    json_auto_t *o = as_json("choose @/first @/second/run.sqlite --json");
    assert_same_number(number(o, "front"), (double)n);
}

TEST(a_folder_without_a_run_or_with_too_long_a_name_is_told)
{
    char name[PATH_MAX + 64];
    Run run;
    assert_refused(run_read(&run, there("nothing"), &err), STATUS_MISSING, "nothing: there is no such file or folder");
    memset(name, 'a', sizeof name);
    name[sizeof name - 1] = 0;
    assert_refused(run_read(&run, name, &err), STATUS_MISSING, "holds no run");
    assert_false(run_is_there(name));
}

/* Names with quotes too; what SQLite has no room for is refused before anything is simulated. */
TEST(every_number_has_a_column_of_its_name)
{
    sqlite3 *db;
    sqlite3_stmt *row;
    OWNED(forget) Said s;
    write_in_place("names.ini", DTLZ2_INI(3, 2) "objective_names = a b,it's\n"
                                                "[search]\ninitial = 12\npopulation = 8\nmax_evals = 12\n");
    write_in_place("many.ini", "[problem]\nkind = external\ncommand = sh tests/worker.sh good\nvariables = 1990\n"
                               "objectives = 2\n[search]\ninitial = 4\npopulation = 4\nmax_evals = 4\n");
    free(output_of("optimize @/names.ini --out @/names"));
    assert_int_equal(sqlite3_open(there("names/run.sqlite"), &db), SQLITE_OK);
    assert_int_equal(sqlite3_prepare_v2(db, "SELECT \"a b\", \"it's\", x3 FROM evaluation WHERE typeof(x3) = 'real'",
                                        -1, &row, NULL),
                     SQLITE_OK);
    assert_int_equal(sqlite3_step(row), SQLITE_ROW);
    sqlite3_finalize(row);
    sqlite3_close(db);
    run(&s, "optimize @/many.ini --out @/many");
    if (s.code == 65)
        fail_msg("%s", s.err);
    expect(65, "problem.variables = 1991: a run has room for 1990 variables beside 2 objectives",
           "optimize @/many.ini --set problem.variables=1991 --out @/more");
    expect(65, "a run has room for 1990 variables", "check @/many.ini --set problem.variables=1991");
}

TEST(a_lock_names_its_holder_and_who_cannot_have_one_is_told_why)
{
    char path[PATH_MAX], lock[PATH_MAX];
    Folder first, second;
    LockHolder holder;
    CHECK_OK(folder_take(&first, path_of("held", path), 0, &err), &err);
    folder_note(&first, 7);
    assert_true(folder_is_held(path, &holder) && holder.pid == getpid());
    assert_int_equal(holder.n_stored, 7);
    assert_int_equal(folder_take(&second, path, 0, &err), STATUS_IO);
    assert_int_equal(second.lock, -1);
    assert_non_null(strstr(err.text, "held: is in use by process"));
    write_in_place("held/lock", ""); /* whoever emptied it: it is held all the same */
    assert_true(folder_is_held(path, &holder));
    assert_string_equal(holder.host, "an unknown machine");
    write_in_place("held/run.sqlite", "a run"); /* without one the folder would go with its lock */
    folder_release(&first);
    assert_false(folder_is_held(path, &holder));
    assert_int_equal(unlink(path_of("held/lock", lock)), 0);
    assert_int_equal(symlink("/dev/full", lock), 0);
    assert_refused(folder_take(&first, path, 0, &err), STATUS_IO, "lock: cannot be written");
}

/* As a killed process that the system still tears down. */
TEST(who_lets_go_of_a_lock_within_a_second_is_waited_for)
{
    char path[PATH_MAX], word;
    int ends[2];
    Folder folder;
    path_of("passing", path);
    assert_int_equal(pipe(ends), 0);
    const pid_t pid = fork();
    if (pid == 0) {
        const int taken = folder_take(&folder, path, 0, &err) == STATUS_OK && write(ends[1], "!", 1) == 1;
        usleep(300000);
        _exit(taken ? 0 : 1);
    }
    close(ends[1]);
    assert_int_equal(read(ends[0], &word, 1), 1);
    close(ends[0]);
    CHECK_OK(folder_take(&folder, path, 0, &err), &err);
    folder_release(&folder);
    assert_int_equal(wait_end(pid), 0);
}

static void make_sound(void)
{
    write_in_place("textbook.ini", TEXTBOOK);
    free(output_of("optimize @/textbook.ini --out @/sound"));
}

SUITE_FILLED(prepare, make_sound, clear_place)
