/* A run that is interrupted, refused, watched: what it stores and how it goes on. */
#include "runs.h"

#include "base/hypervolume.h"
#include "store/tables.h"
#include "wfg.h"

static const char TOWER[] = SIX_FLOORS_INI "[sim]\nduration_s = 6\n[search]\ninitial = 12\npopulation = 8\n"
                                           "max_evals = 20\n";

/* Cheap: as many simulations as polishing wants, half a second of each. */
static const char POLISHED[] = SIX_FLOORS_INI "[sim]\nduration_s = 6\naccuracy = coarse\n[search]\ninitial = 100\n"
                                              "population = 100\nmax_evals = 800\nsurrogate = off\npolish = 2\nthreads "
                                              "= 1\nseed = 5\nobjectives = j1_m, j2_m, j3_g, mcore_kg\n";

/* An answer takes 40 ms. */
static const char STEADY[] = "[problem]\nkind = external\ncommand = sh tests/worker.sh steady\nvariables = 3\n"
                             "objectives = 2\n[search]\ninitial = 36\npopulation = 12\nmax_evals = 40\n"
                             "threads = 2\n";

/* -- interrupted and gone on with ---------------------------------------------------------------------------------- */

/* Sessions of k simulations each (the end of a generation counts too) until nothing is left; their number. */
static int run_by_pieces(const Settings *s, int k, StudySummary *summary)
{
    for (int sessions = 1;; sessions++) {
        int left = k;
        err = (Err){0};
        const StudyOptions options = {.stop = stop_after, .user = &left};
        const Status status = study_run(s, &options, summary, NULL, &err);
        if (status == STATUS_OK)
            return sessions;
        assert_less(sessions, 200);
        if (status != STATUS_STOPPED)
            fail_msg("session %d of %d simulations: %s", sessions, k, err.text);
    }
}

/* Stopped after every k-th simulation, for some k. */
static void check_pieces(const char *text, const char *name, int n_k, const int k[])
{
    StudySummary summary, again;
    FREED char *whole = formatted("%s-whole", name);
    Settings s = settings_of(text, whole);
    assert_int_equal(run_by_pieces(&s, INT_MAX, &summary), 1);
    assert_int_equal(summary.n_simulated, s.search.max_evals);
    for (int i = 0; i < n_k; i++) {
        FREED char *pieces = formatted("%s-by-%d", name, k[i]);
        s = settings_of(text, pieces);
        assert_less(1, run_by_pieces(&s, k[i], &again));
        assert_int_equal(again.n_simulated, summary.n_simulated);
        assert_int_equal(again.n_failed, summary.n_failed);
        assert_int_equal(again.n_front, summary.n_front);
        assert_same_run(whole, pieces);
    }
}

TEST(a_run_stopped_after_every_kth_simulation_is_the_run_that_never_stopped)
{
    check_pieces(TEXTBOOK, "textbook", 5, (const int[]){2, 3, 7, 13, 31});
}

TEST(the_tower_stopped_in_between_is_the_tower_that_was_not)
{
    check_pieces(TOWER, "tower", 3, (const int[]){2, 5, 15});
}

/* The pieces end in the search and in the polishing after it. */
TEST(a_run_stopped_while_it_polishes_and_one_that_polishes_side_by_side_end_with_the_same_designs)
{
    StudySummary summary;
    Settings s = settings_of(POLISHED, "polish-whole");
    assert_int_equal(run_by_pieces(&s, INT_MAX, &summary), 1);
    assert_int_equal(summary.polish.n_tried, 2);
    assert_less(0, summary.polish.n_better);
    s = settings_of(POLISHED, "polish-pieces");
    assert_same_number(run_by_pieces(&s, 450, &summary), 3);
    assert_same_run("polish-whole", "polish-pieces");
    s = settings_of(POLISHED, "polish-beside");
    s.search.threads = 2;
    assert_int_equal(run_by_pieces(&s, INT_MAX, &summary), 1);
    assert_int_equal(summary.polish.n_tried, 2);
    assert_same_output("export @/polish-whole --all --csv -", "export @/polish-beside --all --csv -");
}

/* Another number of threads, and a search that learns it has more simulations: the same in one piece or in many. */
/* As a process that is killed once the new limit is stored. */
static void grant_and_die(Settings *s, long max_evals)
{
    RunStore *store;
    CHECK_OK(store_open(&store, s->run.out, 0, &err), &err);
    Settings granted = *store_run(store)->settings;
    granted.search.max_evals = s->search.max_evals = max_evals;
    CHECK_OK(store_resume(store, &store_run(store)->schema, &granted, 1, &err), &err);
    store_free(store);
}

TEST(more_simulations_go_on_the_same_whenever_they_are_granted)
{
    Settings late = settings_of(TEXTBOOK, "late"), early = settings_of(TEXTBOOK, "early");
    study_to_its_end(&late);
    study_stopped_after(17, &early);
    late.search.max_evals = early.search.max_evals = 60;
    assert_int_equal(study_to_its_end(&late).n_simulated, 60);
    early.search.threads = 2;
    assert_int_equal(study_to_its_end(&early).n_simulated, 60);
    grant_and_die(&late, 62);
    assert_int_equal(study_to_its_end(&late).n_simulated, 62);
    FREED char *a = all_of("late"), *b = all_of("early");
    const char *end = a;
    for (int i = 0; i <= 40; i++)
        end = strchr(end, '\n') + 1;
    assert_memory_equal(a, b, (size_t)(end - a)); /* the first 40; from there on more was known when more was granted */
}

/* -- what is refused ----------------------------------------------------------------------------------------------- */

static void refused_with(const Settings *s, const char *said, const char *line)
{
    FREED char *lines = NULL;
    size_t length;
    StudySummary summary;
    FILE *f = open_memstream(&lines, &length);
    assert_int_equal(study_run(s, &(StudyOptions){0}, &summary, f, &err), STATUS_BAD_DATA);
    fclose(f);
    assert_words(err.text, said);
    assert_words(lines, line);
}

TEST(a_search_that_another_version_interrupted_is_refused_before_anything_is_changed)
{
    const Settings s = settings_of(TOWER, "version");
    study_stopped_after(15, &s);
    OWNED(run_free) Run stopped = run_in("version");
    change_database("version/run.sqlite",
                    brief("UPDATE state SET bytes = x'0100000000000000', digest = %ld",
                          state_digest(stopped.generation[stopped.n_generations - 1].number, "\1\0\0\0\0\0\0", 8)));
    shell_in_place("cp -r version as-it-was");
    refused_with(&s, "another version of the program interrupted this search", "");
    refused_with(&s, "nothing was changed", "");
    shell_in_place("diff -r -x lock version as-it-was");
}

TEST(other_settings_are_refused_key_by_key_and_limits_may_change)
{
    Settings s = settings_of(TEXTBOOK, "textbook-whole");
    s.search.seed = 5;
    s.search.stop_after = 30;
    refused_with(&s, "search.seed is 1 there, now 5, and more; put that back, or choose another --out",
                 "search.stop_after: 0 in the run, now 30 (a limit)\n");
    refused_with(&s, "search.seed is 1 there", "search.seed: 1 in the run, now 5\n");
    s.search.seed = 1;
    s.search.max_evals = 39;
    refused_with(&s, "search.max_evals = 39 is less than the 40 simulations that it holds", "search.max_evals");
    s.search.max_evals = 40;
    Settings other = s; /* a value too long for the message is marked as cut, and ends it no earlier */
    snprintf(other.problem.command, OPTION_TEXT_MAX, "no%0200d", 0);
    refused_with(&other, "problem.command is " TEXTBOOK_WORKER " dtlz2 6 3 0.05 there, now no000", "problem.command");
    refused_with(&other, "000..., and more; put that back, or choose another --out", "problem.command");
    study_to_its_end(&s);
    study_to_its_end(&s); /* they are the run's now */
}

/* The same path, other numbers in it. */
TEST(a_record_that_has_changed_is_another_setting)
{
    StudySummary summary;
    Settings s = settings_of(TOWER, "record");
    write_in_place("record.csv", "time_s,accel_m_s2\n0,0\n0.02,1\n0.04,-1\n0.06,0.5\n0.08,0\n");
    snprintf(s.motion.record, sizeof s.motion.record, "%s/record.csv", place.folder);
    assert_int_equal(run_by_pieces(&s, INT_MAX, &summary), 1);
    write_in_place("record.csv", "time_s,accel_m_s2\n0,0\n0.02,1\n0.04,-1\n0.06,0.6\n0.08,0\n");
    refused_with(&s, "motion.record has other content", "motion.record: has other content than when the run began\n");
}

/* -- signals and hours --------------------------------------------------------------------------------------------- */

/* Until the run has n evaluations on the disk. */
static void wait_for(const char *out, size_t n)
{
    char folder[PATH_MAX];
    const double begun = clock_seconds();
    for (size_t found = 0; found < n; rest(0.02)) {
        Run saved = {0};
        if (clock_seconds() > begun + 60)
            fail_msg("%s: %zu evaluations after a minute, wanted %zu", out, found, n);
        if (run_is_there(path_of(out, folder))) {
            CHECK_OK(run_read(&saved, folder, &err), &err);
            found = saved.table.n;
            run_free(&saved);
        }
    }
}

/* What `status` counts is in both exports, also of the generation that was cut short. */
static void check_unfinished_is_exported(const char *out)
{
    json_auto_t *status = as_json("status @/%s --json", out), *o = as_json("export @/%s --json", out);
    const double simulated = number(status, "simulated");
    FREED char *all = all_of(out);
    assert_same_number(count(all, "\n") - 1, simulated);
    assert_less(0, count(all, ",unfinished,ok,,"));
    assert_same_number((double)json_array_size(json_object_get(o, "evaluations")), simulated);
}

/* Nothing is known of the front yet; the pace comes from what was simulated. */
static void check_status_has_no_nan(const char *out)
{
    FREED char *said = output_of("status @/%s", out), *list = output_of("status @");
    assert_words(said, "!nan", "!- simulations/s");
    assert_words(list, "!nan");
}

static void check_signal(int number, const char *out)
{
    write_in_place("steady.ini", STEADY);
    const pid_t pid = start("steady.ini", out);
    wait_for(out, 4);
    kill(pid, number);
    kill(pid, number == SIGTERM ? SIGINT : SIGTERM); /* within microseconds, as of `timeout`: the same request */
    const int status = wait_end(pid);
    assert_true(WIFEXITED(status));
    assert_int_equal(WEXITSTATUS(status), 75);
    assert_words_in(read_in_place("said"), brief("%s optimize %s/%s\n", getenv("IMTET"), place.folder, out),
                    "stopped on request after");
    check_unfinished_is_exported(out);
    check_status_has_no_nan(out);
    free(output_of("optimize @/%s", out));
}

TEST(a_signal_stops_within_a_batch_and_the_command_that_is_printed_goes_on)
{
    check_signal(SIGINT, "interrupted");
    check_signal(SIGTERM, "terminated");
    check_signal(SIGHUP, "hung-up");
    assert_same_run("interrupted", "terminated");
    assert_same_run("interrupted", "hung-up");
}

/* `script` gives the program a terminal. */
TEST(progress_is_one_line_on_a_terminal_and_none_in_a_pipe)
{
    OWNED(forget) Said s;
    write_in_place("textbook.ini", TEXTBOOK);
    run(&s, "optimize @/textbook.ini --out @/in-a-pipe");
    assert_int_equal(s.code, 0);
    assert_string_equal(s.err, "");
    if (system("command -v script >/dev/null") != 0)
        skip();
    expect_shell("script -qec '\"%s\" optimize %s/textbook.ini --out %s/on-a-terminal' %s/typed >%s/seen",
                 getenv("IMTET"), place.folder, place.folder, place.folder, place.folder);
    FREED char *seen = read_in_place("seen");
    for (const char *line = seen; (line = strchr(line, '\r')) != NULL;) {
        const size_t shown = strcspn(++line, "\r\n\033");
        assert_at_most(shown, 79); /* `script` in a pipe tells no width */
    }
    assert_words(seen, " of 40", "\033[K");
}

TEST(a_second_signal_ends_at_once)
{
    char path[PATH_MAX];
    const int before = (int)(strstr(DEAF, " deaf") + 5 - DEAF); /* behind it the file that its worker makes */
    write_in_place("deaf.ini", brief("%.*s %s%s", before, DEAF, path_of("asked", path), DEAF + before));
    const pid_t pid = start("deaf.ini", "deaf");
    while (access(path, F_OK) != 0)
        rest(0.02);
    const double begun = clock_seconds();
    kill(pid, SIGSTOP);
    kill(pid, SIGTERM);
    kill(pid, SIGINT); /* it takes both at once: one request, as of `timeout` */
    kill(pid, SIGCONT);
    rest(0.4);
    assert_int_equal(waitpid(pid, NULL, WNOHANG), 0); /* it still waits for the answer that is under way */
    int status;
    do { /* on a busy machine the first two may only just have been taken */
        kill(pid, SIGTERM);
        rest(0.3);
    } while (waitpid(pid, &status, WNOHANG) == 0);
    assert_true(WIFSIGNALED(status) && WTERMSIG(status) == SIGTERM);
    assert_less(clock_seconds(), begun + 50);
}

/* 40 answers of one worker take 1.6 s at least, however busy the machine is: no session is long enough for all of them. One
 * that ends before its worker has answered is followed by one of half as long again. */
TEST(hours_are_obeyed_within_a_batch)
{
    StudySummary summary = {0};
    Settings s = settings_of(STEADY, "hours");
    s.search.threads = 1;
    for (double limit_s = 0.2; limit_s < 1.6 && summary.n_simulated == 0; limit_s *= 1.5) {
        s.search.max_hours = limit_s / 3600;
        assert_int_equal(study_run(&s, &(StudyOptions){0}, &summary, NULL, &err), STATUS_STOPPED);
        assert_int_equal(summary.stopped, STOP_TIME);
        assert_at_most(summary.n_simulated, 1 + limit_s / 0.04);
    }
    assert_less(0, summary.n_simulated);
    s.search.threads = 2;
    s.search.max_hours = 0;
    assert_int_equal(study_to_its_end(&s).n_simulated, 40);
    assert_same_files("hours/front.csv", "interrupted/front.csv");
}

/* -- readers, designs from outside, failures ----------------------------------------------------------------------- */

/* The designs of two searches are the same; the first has n_polished more, with ids of their own. */
static void assert_searched_as(const char *a, const char *b, size_t n_polished)
{
    OWNED(run_free) Run first = run_in(a), second = run_in(b);
    const size_t n = run_first_polished(&first), polished = first.table.n - n;
    assert_int_equal(polished, n_polished);
    assert_int_equal(n, first.n_finished);
    const size_t common = n < second.table.n ? n : second.table.n;
    assert_memory_equal(first.table.x, second.table.x, common * first.schema.n_var * sizeof *first.table.x);
    assert_memory_equal(first.table.f, second.table.f, common * first.schema.n_obj * sizeof *first.table.f);
    for (size_t i = 0; i < n; i++) {
        long id = (long)i + 1;
        for (size_t p = n; p < first.table.n; p++)
            id += first.table.row[p].id <= id;
        assert_int_equal(first.table.row[i].id, id);
    }
}

/* One that beats everything, one that is beaten, one that failed; then the run goes on as if they were not there. */
TEST(polished_designs_join_the_front_but_not_the_search)
{
    char path[PATH_MAX];
    long first = 0;
    Settings s = settings_of(TEXTBOOK, "polished");
    study_stopped_after(20, &s);
    double x[6] = {0.5, 0.5, 0.5, 0.5, 0.5, 0.5}, best[3] = {-9, -9, -9}, worse[3] = {5, 5, 5};
    double spread[3] = {0.001, NAN, 0.002};
    const Evaluation designs[] = {{.x = x, .f = best, .sd = spread, .outcome = OUTCOME_OK, .seconds = 0.5},
                                  {.x = x, .f = worse, .outcome = OUTCOME_OK},
                                  {.x = x, .outcome = OUTCOME_DEAD, .reason = "it died"}};
    Run saved = run_in("polished");
    const long last = saved.table.row[saved.table.n - 1].id;
    run_free(&saved);
    CHECK_OK(add_to_run(path_of("polished", path), 3, designs, &first, &err), &err);
    assert_int_equal(first, last + 1);
    FREED char *front = output_of("export @/polished --csv -"), *id = formatted("\n%ld,", first);
    assert_words(front, id);
    assert_ptr_equal(strchr(strstr(front, id) + 1, '\n')[1], 0); /* it is the only one left */
    CHECK_OK(run_read(&saved, path, &err), &err);
    const RunPlace *at = &saved.place[saved.table.n - 3];
    assert_int_equal(saved.table.row[saved.table.n - 3].kind, KIND_POLISHED);
    assert_true(at->on_front && !at[1].on_front && !at[2].on_front && !at[2].ok);
    assert_true(saved.table.sd[(saved.table.n - 3) * 3] == 0.001 && isnan(saved.table.sd[(saved.table.n - 3) * 3 + 1]));
    assert_true(isnan(saved.table.sd[0]));
    run_free(&saved);

    study_to_its_end(&s);
    assert_searched_as("polished", "textbook-whole", 3);
    FREED char *end = output_of("export @/polished --csv -"), *all = read_in_place("polished/front.csv");
    assert_int_equal(strtol(strchr(end, '\n'), NULL, 10), first);
    assert_ptr_equal(strchr(strstr(end, id) + 1, '\n')[1], 0);
    assert_string_equal(all, front);
    s.search.max_evals = 60; /* a finished run with polished designs goes on */
    assert_int_equal(study_to_its_end(&s).n_simulated, 60);
    assert_searched_as("polished", "late", 3);
}

TEST(one_failure_in_ten_is_survived_and_never_on_the_front)
{
    write_in_place("tenth.ini", "[problem]\nkind = external\ncommand = sh tests/worker.sh tenth\nvariables = 3\n"
                                "objectives = 2\n[search]\ninitial = 40\npopulation = 12\nmax_evals = 100\n"
                                "threads = 2\n");
    free(output_of("optimize @/tenth.ini --out @/tenth"));
    OWNED(run_free) Run saved = run_in("tenth");
    assert_int_equal(saved.table.n, 100);
    assert_int_equal(saved.n_failed, 10);
    assert_less(0, saved.n_front);
    for (size_t i = 0; i < saved.table.n; i++) {
        assert_int_equal(saved.place[i].ok, saved.table.row[i].id % 10 != 0);
        assert_true(saved.place[i].ok || (!saved.place[i].on_front && saved.place[i].entered == NEVER));
    }
    json_auto_t *o = as_json("status @/tenth --json"), *list = as_json("status @ --json");
    assert_int_equal(number(json_object_get(json_object_get(o, "failures"), "error"), "count"), 10);
    assert_string_equal(json_string_value(json_object_get(o, "state")), "finished");
    assert_int_equal(number(o, "failed"), 10);
    const json_t *generations = json_object_get(o, "generations");
    double before = 0;
    for (size_t i = 0; i < json_array_size(generations); i++) {
        const double volume = json_number_value(json_object_get(json_array_get(generations, i), "hypervolume"));
        assert_true(volume >= before && volume <= 1); /* none before all of the sample are there */
        before = volume;
    }
    assert_less(0, before);
    int found = 0;
    for (size_t i = 0; i < json_array_size(list); i++)
        found += strcmp(json_string_value(json_object_get(json_array_get(list, i), "run")), there("tenth")) == 0;
    assert_int_equal(found, 1);
}

/* The front generation by generation, from `entered` and `left`, against dominance among what was simulated then. */
TEST(the_front_of_every_generation_can_be_told)
{
    OWNED(run_free) Run s = run_in("tower-whole");
    const size_t m = s.schema.n_obj;
    for (size_t g = 0; g < s.n_generations; g++) {
        long on_front = 0;
        for (size_t i = 0; i < s.table.n; i++) {
            const RunPlace *r = &s.place[i];
            int beaten = !r->ok || (long)i >= s.generation[g].simulated;
            for (size_t j = 0; j < s.table.n && !beaten; j++) {
                int worse = 0, better = 0;
                for (size_t k = 0; k < m && s.place[j].ok; k++) {
                    const double sense = schema_objective(&s.schema, k)->sense;
                    const double d = sense * (s.F[j * m + k] - s.F[i * m + k]);
                    worse = worse || d > 0;
                    better = better || d < 0;
                }
                beaten = (long)j < s.generation[g].simulated && better && !worse;
            }
            const int told = r->entered != NEVER && r->entered <= (long)g && (r->left == NEVER || r->left > (long)g);
            assert_int_equal(told, !beaten);
            on_front += told;
        }
        assert_int_equal(on_front, s.generation[g].front);
    }
}

/* Against the exact volume of some boxes. */
TEST(the_share_that_is_covered_is_the_hypervolume_of_the_box)
{
    const double lower[3] = {0, -1, 2}, reference[3] = {1, 1, 6};
    const double F[] = {0.2, 0, 3, 0.5, -0.5, 2.5, 0.1, 0.9, 5, 2, 2, 7};
    Hypervolume *h;
    CHECK_OK(hypervolume_create(&h, 3, lower, reference, 1, &err), &err);
    double before = 0;
    for (size_t i = 0; i < 4; i++) {
        hypervolume_add(h, F + 3 * i);
        assert_at_most(before, hypervolume_share(h));
        before = hypervolume_share(h);
        const double share = wfg_hypervolume(i + 1, 3, F, reference) / 8,
                     error = sqrt(share * (1 - share) / HYPERVOLUME_SAMPLES);
        assert_less(fabs(hypervolume_share(h) - share), 4 * error);
    }
    hypervolume_free(h);
}

/* Tables are written in blocks of some thousand rows. */
TEST(an_export_of_thousands_has_every_design_in_its_order)
{
    enum { DESIGNS = 4200 };
    write_in_place("large.ini", DTLZ2_INI(3, 2) "[search]\nsurrogate = off\n"
                                                "stop_after = 0\nmax_evals = 4200\n");
    free(output_of("optimize @/large.ini --out @/large"));
    FREED char *all = all_of("large");
    long n = 0;
    for (const char *line = strchr(all, '\n'); line && line[1]; line = strchr(line + 1, '\n'))
        assert_int_equal(strtol(line + 1, NULL, 10), ++n);
    assert_int_equal(n, DESIGNS);
}

/* Kernels as the program has them, whose runs are compared with those of this process. */
static int prepare_pinned(void **state)
{
    linalg_pin();
    return prepare(state);
}

/* -- results that one version of the program has and another lacks ---------------------------------------------------- */

static Status take_extra(const Evaluation *e, void *extra, Err *why)
{
    (void)why;
    memcpy(extra, e->extra, 3 * sizeof(double));
    return STATUS_OK;
}

/* A file of `wrote`, a row of which `reads` inserts and reads: results are found by their names. */
static void exchange(const char *name, const Schema *wrote, const Schema *reads, const Settings *s, double extra[3])
{
    Database *db;
    RowColumns columns;
    double numbers[] = {0.1, 0.2, 0.3, 4, 5, 6, 7, 8};
    char path[PATH_MAX];
    const Evaluation e = {
        .id = 1, .kind = KIND_SAMPLED, .x = numbers, .f = numbers + 3, .extra = numbers + 5, .reason = ""};
    CHECK_OK(tables_create(path_of(name, path), wrote, s, "{}", &err), &err);
    CHECK_OK(database_open(&db, path, DATABASE_WRITE, &err), &err);
    CHECK_OK(tables_check(db, reads, &err), &err);
    CHECK_OK(tables_columns(db, ROWS_EVALUATION, reads, &columns, &err), &err);
    CHECK_OK(rows_insert(db, &columns, reads, &e, &err), &err);
    CHECK_OK(rows_each(db, ROWS_EVALUATION, reads, "1", take_extra, extra, &err), &err);
    free(columns.place);
    database_close(db);
}

TEST(a_result_that_a_file_lacks_is_not_known_and_one_that_only_the_file_has_is_passed_over)
{
    Schema now, before;
    double extra[3];
    Settings s = settings_of("[problem]\nkind = external\ncommand = true\nvariables = 3\nobjectives = 2\n", "columns");
    s.problem.constraints = 3;
    CHECK_OK(schema_of(&now, &s, 0, &err), &err);
    before = now;
    before.n_extra = before.n_limited = 2;
    exchange("older.sqlite", &before, &now, &s, extra);
    assert_true(extra[0] == 6 && extra[1] == 7 && isnan(extra[2]));
    extra[2] = 0;
    exchange("newer.sqlite", &now, &before, &s, extra);
    assert_true(extra[0] == 6 && extra[1] == 7);
    before.n_extra = 3; /* of other names: none of the two is found */
    before.column = calloc(8, sizeof *before.column);
    memcpy(before.column, now.column, 8 * sizeof *now.column);
    snprintf(before.column[5].name, TABLE_NAME_MAX, "g_9");
    exchange("other.sqlite", &now, &before, &s, extra);
    assert_true(isnan(extra[0]) && extra[1] == 7 && extra[2] == 8);
    snprintf(before.column[3].name, TABLE_NAME_MAX, "f9");
    Database *db;
    CHECK_OK(database_open(&db, there("other.sqlite"), DATABASE_READ, &err), &err);
    assert_refused(tables_check(db, &before, &err), STATUS_IO, "its table evaluation is not that of this run");
    database_close(db);
    free(before.column);
    schema_free(&now);
}

SUITE(prepare_pinned, clear_place)
