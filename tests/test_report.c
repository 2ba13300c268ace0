/* The report and the pictures of a run: what they are computed from, what is written. In a
 * browser: test_browser.c. */
#include "runs.h"

#include "evaluate/replicates.h"
#include "report/elsewhere.h"
#include "report/importance.h"
#include "report/report.h"
#include "report/report_json.h"
#include "scene_options.h"
#include "report/words.h"
#include "settings/options.h"

/* A study of eight designs at a time. */
#define SMALL_STUDY                                                                                                    \
    "optimize configs/quick.ini " SIX_FLOORS "--set search.population=8 --set search.initial=8 --set "                 \
    "search.polish=0 --set motion.stretch=0.5 "

static const char MOTION[] = "0,0\n0.01,1\n0.02,-1\n0.03,0\n";
static Run tower; /* read once for all tests, its knee simulated */
static Report report;

static void set_up(void)
{
    const char *records[] = {"builtin:sylmar-like"};
    linalg_pin(); /* as the program does: other threads, other last digits, other impacts */
    expect(0, "",
           "optimize configs/quick.ini " SIX_FLOORS
           "--max-evals 60 --set motion.stretch=0.5 --set sim.duration_s=4.505 "
           "--set search.population=16 --set search.initial=40 --set building.yield_drift=0.001 "
           "--set 'core.foundation=soil=C radius=5 anchors=inf' --set 'search.limits=core_stress_pa<=1e10' --set "
           "search.objectives=j1_m,contact_force_max_n,j3_g,ed1_pct,edcs_pct,drift_ratio,mcore_kg --out @/tower");
    expect(0, "",
           "optimize configs/quick.ini --max-evals 90 --set search.population=16 --set search.initial=40 "
           "--out @/dtlz " DTLZ2(5, 3));
    write_in_place("own.csv", MOTION);
    write_in_place("twin.csv", MOTION);
    expect(0, "twin.csv has the content of ", "report @/tower --record @/own.csv --record @/twin.csv --unit m_s2");
    expect(0, "", "report @/dtlz");
    CHECK_OK(run_read(&tower, there("tower"), &err), &err);
    const DetailOptions options = {.other = tower.settings, .n_records = 1, .records = records};
    CHECK_OK(report_open(&report, &tower, tower.n_front > 0 ? run_knee(&tower) : 0, &options, &err), &err);
}

static int tear_down(void **state)
{
    report_close(&report);
    run_free(&tower);
    return clear_place(state);
}

/* ---- what is computed ------------------------------------------------------------------------------------------ */

/* 200 designs of three variables in the unit cube and f = a x1 + b x2 + c x1 x2. */
static Importance importance_of_plane(double a, double b, double c)
{
    Importance m;
    Random r = random_stream(3, RANDOM_TEST, 0, 0);
    Run run = {.schema = {.n_var = 3, .n_obj = 1}, .table = evaluation_table(3, 1, 0)};
    for (int i = 0; i < 200; i++) {
        Evaluation *e;
        CHECK_OK(evaluation_table_add(&run.table, &e, &err), &err);
        e->kind = KIND_SAMPLED;
        for (int j = 0; j < 3; j++)
            e->x[j] = random_uniform(&r);
        e->f[0] = a * e->x[0] + b * e->x[1] + c * e->x[0] * e->x[1];
    }
    run.F = run.table.f;
    CHECK_OK(importance_of(&run, &m, &err), &err);
    evaluation_table_free(&run.table);
    return m;
}

/* Var (a x1 + b x2) = (a^2 + b^2) / 12; of x1 x2: Var 7/144, each alone 3/144, together 1/144. */
TEST(importance_is_the_share_of_the_variance_that_a_variable_has_a_part_in)
{
    OWNED(importance_free) Importance sum = importance_of_plane(1, 2, 0), product = importance_of_plane(0, 0, 1);
    assert_true(sum.n_centres == 200 && sum.explained[0] > 0.999 && product.explained[0] > 0.99);
    assert_close(sum.total[0], 0.2, 0.1);
    assert_close(sum.total[1], 0.8, 0.1);
    assert_true(sum.total[2] < 1e-4 && product.total[2] < 1e-3);
    assert_close(product.total[0], 4.0 / 7, 0.1);
    assert_close(product.total[1], 4.0 / 7, 0.1);
}

static double energy(const Track *h, size_t i, EnergyKind k)
{
    return track_at(h, i, h->width - N_ENERGIES + k);
}

TEST(energies_add_up_to_the_input_at_every_instant_and_end_as_the_result_says)
{
    OWNED(scenario_close) Scenario w;
    Track h;
    const SceneOptions options = settings_scene(tower.settings);
    CHECK_OK(scenario_of(&w, &options, &tower.settings->motion, &err), &err);
    for (int s = 0; s < 2; s++) {
        const SceneKind kind = s ? SCENE_NO_CORE : SCENE_IMPACT;
        const SimResult *result = &report.detail.result[kind];
        CHECK_OK(history_run(&w, kind, run_x(&tower, report.chosen), &h, &err), &err);
        assert_less(200, h.n);
        double most = 0;
        for (size_t i = 0; i < h.n; i++) {
            double sum = 0;
            for (int k = 0; k < ENERGY_INPUT; k++)
                sum += energy(&h, i, (EnergyKind)k);
            assert_at_most(fabs(sum - energy(&h, i, ENERGY_INPUT)), 1e-9 * result->input_energy_j);
            most = fmax(most, fabs(track_at(&h, i, HISTORY_U + 5)));
        }
        const size_t end = h.n - 1; /* 4.505 s are no whole number of samples: the run goes on for a part */
        assert_close(energy(&h, end, ENERGY_INPUT), result->input_energy_j, 0.02);
        assert_close(energy(&h, end, ENERGY_DAMPED_BUILDING), result->damped_building_j, 0.02);
        /* What is closed or bent takes and gives during the part of a sample that is left; strain is that of K u. */
        const double kept =
            energy(&h, end, ENERGY_KINETIC) + energy(&h, end, ENERGY_STRAIN) + energy(&h, end, ENERGY_CORE);
        assert_at_most(fabs(energy(&h, end, ENERGY_CONTACTS) + kept - result->kinetic_strain_j -
                            result->contact_loss_j - result->contact_stored_j - result->clamp_j - result->hysteresis_j),
                       0.01 * result->input_energy_j);
        if (kind == SCENE_NO_CORE)
            assert_true(result->contact_loss_j == 0 && energy(&h, end, ENERGY_CORE) == 0);
        assert_at_most(most, result->peak_displacement_m[5] * (1 + 1e-9));
        assert_close(most, result->peak_displacement_m[5], 0.02);
        track_free(&h);
    }
}

TEST(the_chosen_design_is_simulated_as_the_search_did)
{
    const Detail *d = &report.detail;
    const double *f = run_f(&tower, report.chosen), *x = run_x(&tower, report.chosen);
    const SimResult *with_core = &d->result[SCENE_IMPACT], *tied = &d->result[SCENE_RIGID];
    assert_true(with_core->j1_m == f[0] && with_core->j3_g == f[2] && with_core->mcore_kg == f[6]);
    assert_same_number(d->gap_m[3], x[3]);
    assert_same_number(d->thickness_m[0], x[6]);
    assert_close(d->thickness_m[5], x[7], 1e-12);
    assert_true(tied->impacts == 0 && tied->j1_m > 0);
    assert_int_equal(d->n_elsewhere, 1);
    assert_true(d->elsewhere[0].with_core.j1_m != with_core->j1_m);
}

/* ---- what is written ------------------------------------------------------------------------------------------- */

static char *between(const char *text, const char *open, const char *close)
{
    const char *start = strstr(text, open);
    assert_non_null(start);
    start += strlen(open);
    const char *end = strstr(start, close);
    assert_non_null(end);
    return strndup(start, (size_t)(end - start));
}

#define file_of(run, name) read_in_place(brief("%s/%s", run, name))

TEST(the_page_holds_the_rows_of_the_front_to_the_last_digit)
{
    static const char *const RUNS[] = {"tower", "dtlz"};
    for (int i = 0; i < 2; i++) {
        FREED char *page = file_of(RUNS[i], "report.html"), *front = file_of(RUNS[i], "front.csv");
        FREED char *rows = between(page, "id=\"rows\">\n", "</script>");
        const char *whole = front;
        for (char *row = strtok(rows, "\n"); row; row = strtok(NULL, "\n")) {
            whole = strchr(whole, '\n') + 1; /* in the file cells of errors follow, empty ones too */
            assert_int_equal(strncmp(whole, row, strlen(row)), 0);
            assert_true(whole[strlen(row)] == '\n' || (i == 0 && whole[strlen(row)] == ','));
        }
        assert_string_equal(strchr(whole, '\n'), "\n");
    }
}

static json_t *run_of(const char *run)
{
    json_error_t error;
    FREED char *page = file_of(run, "report.html"), *text = between(page, "id=\"run\">", "</script>");
    json_t *all = json_loads(text, 0, &error);
    if (!all)
        fail_msg("%s: %s", run, error.text);
    return all;
}

/* 20000 samples of a box: the standard error of a share. */
TEST(growth_is_the_hypervolume_that_status_tells)
{
    OWNED(run_free) Run run = run_in("dtlz");
    json_auto_t *page = run_of("dtlz");
    const json_t *growth = json_object_get(page, "convergence"), *error = json_object_get(growth, "error");
    const json_t *simulated = json_object_get(growth, "simulated"), *volume = json_object_get(growth, "volume");
    assert_int_equal(json_integer_value(json_object_get(page, "evaluated")), run.table.n);
    size_t told = 0;
    for (size_t i = 0; i < run.n_generations; i++) {
        const double v = run.generation[i].hypervolume;
        if (isnan(v) && told == 0) /* before all of the sample are there */
            continue;
        assert_true(v > 0 && v < 1 && (told == 0 || v >= run.generation[i - 1].hypervolume));
        assert_close(json_number_value(json_array_get(volume, told)), v, 1e-5);
        assert_close(json_number_value(json_array_get(error, told)), sqrt(v * (1 - v) / 20000), 1e-5);
        assert_same_number(json_number_value(json_array_get(simulated, told++)), (double)run.generation[i].simulated);
    }
    assert_true(told > 1 && json_array_size(volume) == told);
}

TEST(the_page_has_the_errors_of_front_csv)
{
    OWNED(table_free) Table t = table_of("tower/front.csv");
    json_auto_t *page = run_of("tower");
    const json_t *names = json_object_get(json_object_get(page, "schema"), "objectives");
    const json_t *errors = json_object_get(page, "chosen_error");
    const double chosen = json_number_value(json_object_get(page, "chosen"));
    size_t row = 0;
    while (row < t.n_rows && t.values[row * t.n_cols] != chosen)
        row++;
    assert_less(row, t.n_rows);
    for (size_t k = 0; k < json_array_size(names); k++) {
        FREED char *name = formatted("err_%s", json_string_value(json_object_get(json_array_get(names, k), "name")));
        const int column = table_column(&t, name);
        assert_at_most(0, column);
        assert_close(json_number_value(json_array_get(errors, k)), t.values[row * t.n_cols + (size_t)column], 1e-5);
    }
    assert_string_equal(json_string_value(json_object_get(page, "rule")), "");
}

TEST(an_objective_of_several_simulations_says_of_which)
{
    static const struct {
        const char *records, *robust, *wanted;
        long replicates;
    } CASES[] = {{"none", "worst", "", 1},
                 {"none", "worst", "mean of 4 replicates", 4},
                 {"a.csv, b.csv", "worst", "worst of 3 records", 1},
                 {"a.csv, b.csv", "mean", "mean of 3 records x 4 replicates", 4},
                 {"a.csv", "0.9", "quantile 0.9 of 2 records x 8 replicates", 8}};
    for (size_t i = 0; i < sizeof CASES / sizeof CASES[0]; i++) {
        Settings s = default_settings();
        char text[RULE_WORDS_MAX];
        CHECK_OK(settings_put(&s, "motion.records", CASES[i].records, &err), &err);
        CHECK_OK(settings_put(&s, "sim.robust", CASES[i].robust, &err), &err);
        s.sim.replicates = CASES[i].replicates;
        words_of_rule(&s, text);
        assert_string_equal(text, CASES[i].wanted);
    }
}

TEST(notes_that_are_damaged_or_of_other_designs_are_named_by_the_report)
{
    write_in_place("dtlz/notes.json", "{\"1\": \"good\",\n 2}");
    expect(65, "dtlz/notes.json:2: is no object of notes", "report @/dtlz --out @/never.html");
    write_in_place("dtlz/notes.json", "{\"1\": \"good\", \"4711\": \"of another run\"}");
    expect(65, "dtlz/notes.json: the run has no design '4711'", "report @/dtlz --out @/never.html");
    write_in_place("dtlz/notes.json", "{\"1\": \"good\"}");
    expect(0, "", "report @/dtlz --out @/noted.html");
}

TEST(the_most_records_of_a_study_and_as_many_others_are_elsewhere)
{
    FREED OtherRecords *r = calloc(1, sizeof *r);
    Settings s = default_settings();
    MotionOptions study = s.motion;
    static const char *const NAMES[] = {"elcentro", "sylmar"};
    for (int k = 0; k < 2; k++) {
        char list[40 * TOWER_RECORDS_MAX] = "";
        for (int i = 1; i < TOWER_RECORDS_MAX; i++)
            snprintf(list + strlen(list), 40, "builtin:%s-like factor=%d\n", NAMES[k], i);
        write_in_place("many_list.txt", list);
        FREED char *path = in_place("many_list.txt");
        snprintf(study.records, sizeof study.records, "%s", path);
        CHECK_OK(k == 0 ? elsewhere_of_study(r, &study, &err) : elsewhere_add(r, path, &err), &err);
        assert_int_equal(r->n, (k + 1) * (TOWER_RECORDS_MAX - 1));
    }
    assert_string_equal(r->source[r->n - 1], "builtin:sylmar-like factor=63");
    CHECK_OK(elsewhere_add(r, r->source[5], &err), &err); /* what is there, and the first record of the study */
    CHECK_OK(elsewhere_add(r, study.record, &err), &err);
    assert_int_equal(r->n, 2 * (TOWER_RECORDS_MAX - 1));
}

/* Other words behind the path, another channel or factor, make another record of the same file. */
TEST(a_record_counts_once_under_two_names_and_the_second_is_said)
{
    FREED OtherRecords *r = calloc(1, sizeof *r);
    FREED char *own = in_place("own.csv"), *twin = in_place("twin.csv"), *other = in_place("other.csv");
    FREED char *twice = formatted("%s factor=2", own);
    MotionOptions study = tower.settings->motion;
    write_in_place("other.csv", "0,0\n0.01,1\n0.02,-2\n0.03,0\n");
    snprintf(study.record, sizeof study.record, "%s", own);
    CHECK_OK(elsewhere_of_study(r, &study, &err), &err);
    for (int k = 0; k < 2; k++) {
        CHECK_OK(elsewhere_add(r, twin, &err), &err);
        CHECK_OK(elsewhere_add(r, other, &err), &err);
        CHECK_OK(elsewhere_add(r, twice, &err), &err);
    }
    assert_int_equal(r->n, 2);
    assert_string_equal(r->source[0], other);
    assert_string_equal(r->source[1], twice);
}

/* The band of the page ends where the worst of the records, simulated each on its own, ends; the standard error of their
 * mean is that of drawing with replacement, to what 200 drawings leave open (5 %, three times that here). */
TEST(the_band_of_a_design_reaches_from_the_mildest_to_the_worst_of_its_records)
{
    static const char *const RECORDS[] = {"builtin:kobe-like", "builtin:sylmar-like", "builtin:elcentro-like"};
    Settings s = *tower.settings;
    OWNED(detail_free) Detail several;
    CHECK_OK(settings_put(&s, "motion.records", "builtin:sylmar-like, builtin:elcentro-like", &err), &err);
    CHECK_OK(settings_put(&s, "sim.robust", "mean", &err), &err);
    CHECK_OK(settings_put(&s, "sim.duration_s", "3", &err), &err);
    const double *x = tower.table.row[run_knee(&tower)].x;
    const DetailOptions options = {.without_devices = 1, .other = &s};
    CHECK_OK(detail_make(&s, (int)tower.schema.n_var, x, &options, &several, &err), &err);
    json_auto_t *page = detail_json(&several, &tower.schema.order);
    const json_t *ends = json_object_get(json_object_get(page, "band"), "peak_drift_m");
    double low = INFINITY, high = 0, j1[3], mean, sd;
    for (int i = 0; i < 3; i++) {
        CHECK_OK(settings_put(&s, "motion.records", "none", &err), &err);
        CHECK_OK(settings_put(&s, "motion.record", RECORDS[i], &err), &err);
        OWNED(detail_free) Detail alone;
        CHECK_OK(detail_make(&s, (int)tower.schema.n_var, x, &options, &alone, &err), &err);
        low = fmin(low, alone.result[SCENE_IMPACT].peak_drift_m[4]);
        high = fmax(high, alone.result[SCENE_IMPACT].peak_drift_m[4]);
        j1[i] = alone.result[SCENE_IMPACT].j1_m;
        assert_true(isnan(alone.standard_error[MEASURE_J1]));
    }
    assert_true(low < 0.98 * high);
    assert_close(json_number_value(json_array_get(json_array_get(ends, 0), 4)), low, 1e-12);
    assert_close(json_number_value(json_array_get(json_array_get(ends, 1), 4)), high, 1e-12);
    mean_and_sd_of(3, j1, &mean, &sd);
    assert_close(several.standard_error[MEASURE_J1], sd * sqrt(2.0 / 3) / sqrt(3), 0.15);
}

static int is_among(size_t row, size_t n, const size_t rows[])
{
    for (size_t i = 0; i < n; i++)
        if (rows[i] == row)
            return 1;
    return 0;
}

static double extreme(const Run *run, size_t n, const size_t rows[], size_t column, double sign)
{
    const size_t m = run->schema.n_obj;
    double most = -INFINITY;
    for (size_t i = 0; i < n; i++)
        most = fmax(most, sign * (column < m ? run_f(run, rows[i])[column] : run_x(run, rows[i])[column - m]));
    return most;
}

TEST(a_thinned_front_keeps_every_range_the_knee_and_what_is_asked_for)
{
    OWNED(run_free) Run run = run_in("dtlz");
    const size_t n_columns = run.schema.n_obj + run.schema.n_var, most = 2 * n_columns + 4;
    const size_t kept[] = {run_knee(&run), run.front[1]};
    FREED size_t *rows = calloc(run.n_front, sizeof *rows);
    assert_true(rows && run.n_front > most + 4);
    assert_int_equal(thin_front(&run, run.n_front, kept, rows), run.n_front);
    assert_memory_equal(rows, run.front, run.n_front * sizeof *rows);
    const size_t n = thin_front(&run, most, kept, rows);
    assert_true(n > most / 2 && n <= most);
    assert_true(is_among(kept[0], n, rows) && is_among(kept[1], n, rows));
    for (size_t i = 0; i < n; i++)
        assert_true(run.place[rows[i]].on_front && (i == 0 || rows[i] > rows[i - 1]));
    for (size_t c = 0; c < n_columns; c++)
        for (int s = -1; s <= 1; s += 2)
            assert_same_number(extreme(&run, n, rows, c, s), extreme(&run, run.n_front, run.front, c, s));
}

/* The command, which opens the file as often at most, as far as strace can tell. */
static void expect_openings(int most, const char *file, const char *arguments)
{
    /* the leak sanitizer and strace exclude each other */
    if (SANITIZED || system("strace -o /dev/null true >/dev/null 2>&1") != 0) {
        expect(0, "", arguments);
        return;
    }
    snprintf(place.under, sizeof place.under, "strace -f --seccomp-bpf -e trace=open,openat -o '%s/trace'",
             place.folder);
    expect(0, "", arguments);
    place.under[0] = 0;
    FREED char *trace = read_in_place("trace");
    const int n = count(trace, file);
    if (n == 0 || n > most)
        fail_msg("%s: opens %s %d times", arguments, file, n);
}

TEST(a_report_needs_the_database_alone)
{
    shell_in_place("mkdir bare && cp tower/run.sqlite bare");
    expect_openings(1, "run.sqlite\"", "report @/bare --design knee --record @/own.csv --unit m_s2");
    json_auto_t *bare = run_of("bare"), *whole = run_of("tower");
    json_object_del(json_object_get(bare, "detail"), "verdict"); /* its last line names the folder */
    json_object_del(json_object_get(whole, "detail"), "verdict");
    FOR_EACH (const char *, part, "schema", "knee", "evaluated", "convergence", "detail", "settings", "provenance")
        if (!json_equal(json_object_get(bare, *part), json_object_get(whole, *part)))
            fail_msg("%s differs", *part);
    assert_int_equal(json_integer_value(json_object_get(bare, "evaluated")), 60);
}

/* report: where its files are looked at. */
TEST(a_command_opens_the_database_of_a_run_once)
{
    if (SANITIZED)
        skip();
    FOR_EACH (const char *, command, "choose @/tower --weights j1_m=1",
              "evaluate @/tower --design knee --record builtin:elcentro-like", "export @/tower --csv /dev/null",
              "status @/tower", "polish @/tower --design knee --max-evals 24", "optimize @/tower")
        expect_openings(1, "run.sqlite\"", *command);
}

/* Once for the study, once for each level of steps that its named designs need, of which three suffice here; and for the
 * verdict: by the study's model, by the ladder's, by the set of effects, and as built. */
TEST(a_study_reads_its_record_once_for_every_accuracy_that_it_needs)
{
    expect_openings(8, "end_mark.at2\"",
                    "optimize configs/quick.ini " SIX_FLOORS
                    "--record tests/motion/end_mark.at2 --max-evals 40 --set search.initial=30 "
                    "--set search.population=16 --out @/read");
}

TEST(the_policy_allows_nothing_but_hashes)
{
    FREED char *page = read_in_place("tower/report.html"),
               *policy = between(page, "Content-Security-Policy\" content=\"", "\"");
    assert_words(policy, "default-src 'none'", "!unsafe-inline", "!'unsafe-eval", "!http", "!*");
}

TEST(a_run_of_another_problem_has_no_tower_in_its_report)
{
    json_auto_t *with = run_of("tower"), *dtlz = run_of("dtlz");
    assert_true(json_is_true(json_object_get(with, "tower")) && json_is_object(json_object_get(with, "detail")));
    assert_true(json_is_false(json_object_get(dtlz, "tower")) && json_is_null(json_object_get(dtlz, "detail")));
    assert_less(1, json_array_size(json_object_get(json_object_get(dtlz, "convergence"), "volume")));
}

/* Names of objectives are free text; what is written of them must neither end the script nor open a comment. */
TEST(names_cannot_break_out_of_the_page)
{
    expect(0, "",
           "optimize configs/quick.ini --set \"problem.objective_names=</script><b>, <!--x,'=c,-d\" --max-evals 30 "
           "--set search.population=8 --set search.initial=20 --out @/names " DTLZ2(5, 4));
    expect(0, "", "report @/names");
    json_auto_t *run = run_of("names");
    const json_t *objectives = json_object_get(json_object_get(run, "schema"), "objectives");
    assert_string_equal(json_string_value(json_object_get(json_array_get(objectives, 0), "name")), "</script><b>");
    assert_words_in(read_in_place("names/report.html"), "!</script><b>", "!<!--x");
}

TEST(designs_and_records_that_are_not_there_are_refused)
{
    expect(65, "", "report @/tower --design 999999");
    expect(65, "", "report @/tower --design kne");
    expect(66, "", "report @/tower --record no-such-file.at2");
    expect(65, "", "report @/tower --set motion.record=tests/motion/one.esm");
    expect(2, "", "report @/tower --set sim.accuracy=fine");
    expect(66, "", "report @/no-such-run");
    expect(74, "", "report @/dtlz --out /no/such/folder/x.html");
}

/* The number in cell n, from 1, behind a row's name, below a heading. */
static double cell(const char *page, const char *heading, const char *name, int n)
{
    const char *at = strstr(page, heading);
    FREED char *row = formatted(">%s</th>", name);
    at = at ? strstr(at, row) : NULL;
    for (int i = 0; at && i < n; i++)
        at = strstr(at + 1, "<td>");
    if (!at)
        fail_msg("%s: no %s", heading, row);
    return at ? atof(at + strlen("<td>")) : NAN;
}

#define first_cell(page, heading, name) cell(page, heading, name, 1)

TEST(a_dossier_has_the_design_by_fine_and_by_cvode_limits_and_what_is_not_covered)
{
    static const char CALCULATIONS[] = "The response by four calculations";
    expect(0, "", "report @/tower --dossier @/dossier.html --record builtin:elcentro-like");
    FREED char *page = read_in_place("dossier.html");
    const char *at = page;
    FOR_EACH (const char *, part, "Building, core and ground motion", "The design</h2>", CALCULATIONS,
              "Forces and stresses", "kept</td>", "Which effects the model needs", "Records one by one",
              ">builtin:kobe-like,", ">builtin:elcentro-like,", "Against intensity", "What the figures depend on",
              "without stiffeners", "matrices_fnv1a", "</html>") {
        const char *next = strstr(at, *part);
        if (!next)
            fail_msg("no %s behind what has to stand before it", *part);
        at = next ? next : at; /* fail_msg does not return, which cppcheck does not know */
    }
    assert_words(page, "!nan (nan", "!tuned mass 0 t"); /* there is none */
    expect(2, "name the file .html or .pdf", "report @/tower --dossier @/dossier.txt");
    json_auto_t *fine = as_json("simulate @/tower/settings.ini --design @/tower:knee --set sim.accuracy=fine --json");
    const double wanted = number(fine, "j1_m");
    assert_close(first_cell(page, CALCULATIONS, "accuracy fine"), wanted, 5e-3); /* three digits */
    assert_close(first_cell(page, CALCULATIONS, "by CVODE (SUNDIALS)"), wanted, 5e-3);
    assert_close(cell(page, "<h1>", "no core", 2), report.detail.result[SCENE_NO_CORE].j1_m, 5e-3);
}

/* Coarse, so that the run knows its knee by other steps than those of its accuracy. */
TEST(a_dossier_of_several_records_has_what_the_study_judges_and_the_largest_demands_of_all)
{
    static const char *const RECORDS[] = {"kobe", "sylmar", "elcentro"}; /* the mildest first */
    double stress = 0, j1 = 0;
    char command[800];
    expect(0, "",
           SMALL_STUDY
           "--max-evals 12 --set sim.duration_s=3 --set sim.accuracy=coarse --record builtin:kobe-like "
           "--set motion.records=builtin:sylmar-like,builtin:elcentro-like --set sim.robust=worst "
           "--set search.objectives=j1_m,mcore_kg --set 'search.limits=p(drift_ratio>0.2)<=0.5' --out @/several");
    expect(0, "", "report @/several --dossier @/several.html");
    FREED char *page = read_in_place("several.html");
    for (size_t i = 0; i < N_OF(RECORDS); i++) {
        json_auto_t *alone = as_json("simulate @/several/settings.ini --design @/several:knee --set "
                                     "motion.records=none --record builtin:%s-like --json",
                                     RECORDS[i]);
        j1 = fmax(j1, number(alone, "j1_m"));
        stress = fmax(stress, number(alone, "core_stress_pa"));
    }
    assert_close(cell(page, "<h1>", "this design", 2), j1, 5e-3);
    assert_close(first_cell(page, "Forces and stresses", "core stress [MPa]"), 1e-6 * stress, 5e-3);
    assert_close(first_cell(page, "Forces and stresses", "p(drift_ratio&#62;0.2)"), 0, 0);
    assert_words(page, "&#60;= 0.5</td><td class=\"words\">kept",
                 "Values as the study judges them: worst of 3 records.",
                 "Forces and strokes under builtin:kobe-like, the first of 3 records.");
    assert_int_equal(sscanf(strstr(page, "<code>imtet "), "<code>imtet %799[^<]", command), 1);
    json_auto_t *again = as_json("%s", command);
    assert_close(cell(page, "The response by", "accuracy fine", 6), number(again, "ed5_10_pct"), 5e-3);
    assert_int_equal(cell(page, "The response by", "accuracy fine", 8), number(again, "impacts"));
    expect_output("of replacement; under builtin:kobe-like\n",
                  "simulate @/several/settings.ini --design @/several:knee");
}

TEST(a_dossier_of_a_design_that_was_screened_only_says_so)
{
    expect(0, "",
           SMALL_STUDY
           "--max-evals 8 --set sim.duration_s=1.5 --record builtin:elcentro-like --set sim.accuracy=coarse "
           "--set motion.records=builtin:sylmar-like,builtin:kobe-like --set search.fidelity=records "
           "--set search.objectives=j1_m,mcore_kg --out @/screened");
    expect(0, "", "report @/screened --design 1 --dossier @/screened.html");
    expect_file("screened.html", "of 3 records, of which this design, only screened, has seen a part.</p>");
}

/* Links on the floors of a zone or none at all; the building alone costs nothing. */
TEST(a_design_of_links_is_said_to_be_one_and_its_dossier_has_their_constants_and_forces)
{
    FREED char *said = output_of(
        SMALL_STUDY
        "--max-evals 8 --set sim.duration_s=2 --record builtin:elcentro-like --set search.objectives=j1_m,cost "
        "--set design.variables=gaps,thickness,links --set design.devices=link,none --set design.device_zones=2 --set "
        "design.gap_zones=1 --set design.link_zones=1 --set 'design.prices=link=1 core_t=1' --out @/links");
    assert_words(said, "Against no core J1 \u00d7 0.", "!never_closing");
    expect(0, "", "report @/links --dossier @/links.html");
    FREED char *page = read_in_place("links.html");
    assert_words(page, "<th>floor</th><th>link [MN (s/m)^n]</th><th>link force [MN]", "on floors: none.",
                 "!contact force right [MN]</th>");
    const char *roof = strstr(page, "<th>6</th>");
    double constant, force, stroke;
    assert_int_equal(sscanf(roof ? roof : "", "<th>6</th><td>%lf</td><td>%lf</td><td>%lf", &constant, &force, &stroke),
                     3);
    assert_close(force, first_cell(page, "Forces and stresses", "force of a link or tuned mass [MN]"), 5e-3);
    assert_close(stroke, 1e3 * first_cell(page, "Forces and stresses", "stroke of a link or tuned mass [m]"), 5e-3);
}

/* What the shell says of the test's folder, "9\n". */
static void expect_said(const char *wanted, const char *command)
{
    char said[80] = "";
    FILE *f = popen(brief("cd '%s' && %s", place.folder, command), "r");
    assert_true(f && fgets(said, sizeof said, f) && pclose(f) == 0);
    if (strncmp(said, wanted, strlen(wanted)) != 0)
        fail_msg("%s: %s", command, said);
}

TEST(a_dossier_that_cannot_be_made_is_refused_before_anything_is_simulated)
{
    expect(65, "--dossier needs a tower", "report @/dtlz --dossier @/d.html");
    expect(2, "do not go together", "report @/tower --dossier @/d.html --out @/page.html");
    snprintf(place.under, sizeof place.under, "env PATH=/nowhere");
    expect(66, "Chromium, which draws it, cannot be started", "report @/tower --dossier @/d.pdf");
    expect(66, "Chromium, which draws it, cannot be started", "report @/tower --pictures @/none");
    place.under[0] = 0;
    expect_said("0", "ls | grep -cx none || true");
}

/* The numbers behind a word of the titles in a picture, floor by floor: "floor 3: 41.2 mm". */
static void expect_floors(const char *svg, const char *format, double factor, const double values[])
{
    for (int j = 0; j < report.detail.n_floors; j++) {
        FREED char *head = formatted(format, j + 1);
        const char *at = strstr(svg, head);
        assert_non_null(at);
        assert_close(atof(at + strlen(head)), factor * values[j], 5e-3); /* three digits */
    }
}

TEST(pictures_are_drawn_as_svg_and_png_each)
{
    /* With the width of the SVG [px]; the PNG has half as many again. */
    static const char *const NAMES[] = {"front", "growth",   "gaps",         "peaks",
                                        "modes", "energies", "displacement", "elsewhere"};
    static const int WIDTHS[] = {1200, 700, 900, 1200, 1200, 1200, 1200, 1000};
    if (!has_browser())
        skip();
    expect_openings(1, "run.sqlite\"", "report @/tower --pictures @/tower/pictures");
    expect(0, "", "report @/names --pictures @/names/pictures");
    for (size_t i = 0; i < N_OF(NAMES); i++) {
        FREED char *name = formatted("tower/pictures/%s.svg", NAMES[i]), *svg = read_in_place(name);
        assert_words(svg, brief(" width=\"%d\"", WIDTHS[i]), "!<foreignObject");
        FREED char *width = formatted(" %3d %3d", WIDTHS[i] * 3 / 2 / 256, WIDTHS[i] * 3 / 2 % 256);
        expect_said(width, brief("head -c 20 tower/pictures/%s.png | tail -c 2 | od -An -t u1", NAMES[i]));
        if (i == 0) { /* short titles, units for people and every baseline; in three panels, the chosen design twice */
            assert_words(svg, "J1 displacement [m]", "contact force [MN]", "without core", "rigidly connected",
                         "tuned mass damper", "viscous links");
            assert_int_equal(count(svg, "<circle "), 3 * (tower.n_front + 1));
        }
        if (i == 2) {
            expect_floors(svg, "<title>floor %d: ", 1e3, report.detail.gap_side_m[0]);
            expect_floors(svg, "<title>thickness, floor %d: ", 1e3, report.detail.thickness_m);
        }
    }
    /* Nothing is left of the page that was drawn. */
    expect_said("16\n", "ls tower/pictures | wc -l");
    expect_said("front.png front.svg growth.png growth.svg\n", "echo $(ls names/pictures)");
    expect_said("2\n", "grep -o '>&lt;/script&gt;&lt;b&gt;<' names/pictures/front.svg | wc -l"); /* names are labels */
}

/* The folder's name comes from elsewhere. */
TEST(a_dossier_of_a_hostile_folder_shows_its_name_as_text_and_runs_no_scripts_but_its_own)
{
#define HOSTILE "r<img src=x onerror=alert(1)>"
    expect_said("0", "cp -r tower '" HOSTILE "' && echo 0");
    expect(0, "", "report '@/" HOSTILE "' --dossier @/hostile.html");
    expect_said("0\n", "grep -c '<img' hostile.html || true");
    expect_said("4\n", "grep -o 'r&#60;img src=x onerror=alert(1)&#62;' hostile.html | wc -l");
    expect_said("1\n", "grep -h Content-Security-Policy hostile.html tower/report.html | sort -u | wc -l");
    if (!has_browser())
        skip();
    expect(0, "", "report '@/" HOSTILE "' --dossier '@/" HOSTILE "/d.pdf'");
    expect_said("%PDF-", "head -1 '" HOSTILE "/d.pdf'");
    expect_said("1\n", "ls '" HOSTILE "' | grep -c d.pdf"); /* and no page beside it */
    /* What its scripts draw: frame, modes, gaps, thickness, three peaks, two histories with spectra and bars, forces. */
    expect_said("15\n",
                "chromium --headless --no-sandbox --dump-dom hostile.html 2>unread | grep -o '<svg class=.plot' | "
                "wc -l");
}

/* The bundle is what its sources make of the libraries; they are there after `make web`. */
TEST(the_bundle_of_charts_is_what_its_sources_give)
{
    if (access("web/node_modules/esbuild", F_OK) != 0) {
        print_message("web/node_modules is not there (make web): the bundle is not made again\n");
        skip();
    }
    expect_shell("cd web && node bundle.mjs '%s' && cmp '%s/charts.js' charts.js && cmp '%s/LICENSES.txt' LICENSES.txt",
                 place.folder, place.folder, place.folder);
}

SUITE_FILLED(make_place, set_up, tear_down)
