/* The designs that a study names: simulated until their error is known (study/named.h). */
#include "runs.h"

#define STUDY                                                                                                          \
    "optimize configs/quick.ini " SIX_FLOORS "--threads 2 --set search.initial=30 --set search.population=16 "         \
    "--set search.polish=0 --set sim.duration_s=8 --set sim.accuracy=coarse --out @/run --max-evals "

static const double PROMISED[] = {1e-3, 3e-3, 1e-2}; /* of J1, J2, J3: docs/promise.md */

static void make_run(void)
{
    free(output_of(STUDY "60"));
}

static size_t named_of(const Run *run, size_t rows[])
{
    size_t n = 0;
    rows[n++] = run_knee(run);
    for (size_t k = 0; k < run->schema.n_obj; k++)
        rows[n++] = run_best(run, k);
    return n;
}

/* J1, J2, J3 by the preset `accuracy`. */
static void simulate(long id, const char *accuracy, double j[3])
{
    json_auto_t *o =
        as_json("simulate @/run/settings.ini --json --set sim.accuracy=%s --design @/run:%ld", accuracy, id);
    j[0] = number(o, "j1_m");
    j[1] = number(o, "j2_m");
    j[2] = number(o, "j3_g");
}

/* At `coarse`, as the search took them, some of these designs miss what `standard` promises. */
TEST(what_a_study_names_agrees_with_fine_or_says_by_how_much_it_may_not)
{
    OWNED(run_free) Run run = run_in("run");
    size_t rows[OBJECTIVES_MAX + 1];
    const size_t all = named_of(&run, rows), n = SANITIZED ? 1 : 5; /* `fine` takes seconds */
    int missed_before = 0;
    assert_less(n, all);
    for (size_t i = 0; i < n; i++) {
        const Evaluation *e = &run.table.row[rows[i]];
        double fine[3], coarse[3];
        simulate(e->id, "fine", fine);
        simulate(e->id, "coarse", coarse);
        assert_non_null(e->err);
        for (int k = 0; k < 3; k++) {
            assert_at_most(fabs(e->f[k] - fine[k]), fmax(PROMISED[k] * fine[k], 3.0 * e->err[k]));
            missed_before += fabs(coarse[k] - fine[k]) > PROMISED[k] * fine[k] / 3.0;
        }
    }
    assert_true(missed_before > 0 || SANITIZED);
}

/* Unless the command line says by which accuracy. */
TEST(a_design_of_a_run_is_simulated_by_the_steps_that_the_run_knows_it_by)
{
    OWNED(run_free) Run run = run_in("run");
    const Evaluation *e = run.finer.row;
    const double wanted = run_f(&run, run_find(&run, e->id))[2];
    assert_true(e->level > 0);
    for (int coarse = 0; coarse < 2; coarse++) {
        json_auto_t *o = as_json("simulate @/run/settings.ini --json --design @/run:%ld %s", e->id,
                                 coarse ? "--set sim.accuracy=coarse" : "");
        assert_int_equal(number(o, "j3_g") == wanted, !coarse);
    }
}

TEST(errors_are_columns_of_the_files_and_empty_where_they_are_not_known)
{
    OWNED(run_free) Run run = run_in("run");
    char *all = output_of("export @/run --all --csv -"), *front = read_in_place("run/front.csv"), head[64], *row;
    size_t n_known = 0;
    assert_non_null(strstr(front, ",err_j1_m,err_j2_m,err_j3_g,"));
    assert_words(all, ",err_j1_m,err_j2_m,err_j3_g,", ",err_impacts,");
    for (size_t i = 0; i < run.n_front; i++) {
        const Evaluation *e = &run.table.row[run.front[i]];
        snprintf(head, sizeof head, "\n%ld,", e->id);
        row = strstr(front, head);
        assert_non_null(row);
        char *end = strchr(row + 1, '\n');
        assert_int_equal(strncmp(end - 7, ",,,,,,,", 7) == 0, e->err == NULL); /* seven objectives */
        n_known += e->err != NULL;
    }
    assert_true(n_known >= 2 && n_known <= run.finer.n);
    free(all);
    free(front);
}

TEST(choose_marks_what_cannot_be_predicted)
{
    OWNED(run_free) Run run = run_in("run");
    size_t n_marked = 0, n_reasons = 0, i;
    json_t *o = as_json("choose @/run --json"), *pick;
    FREED char *said = output_of("choose @/run");
    json_array_foreach(json_object_get(o, "designs"), i, pick)
    {
        const long id = json_integer_value(json_object_get(pick, "id"));
        int is_unpredictable = 0;
        for (size_t k = 0; k < run.finer.n; k++)
            is_unpredictable |= run.finer.row[k].id == id && run.finer.row[k].reason[0];
        assert_int_equal(json_is_true(json_object_get(json_object_get(pick, "error"), "unpredictable")),
                         is_unpredictable);
        n_reasons += is_unpredictable;
    }
    for (const char *at = said; (at = strstr(at, " unpredictable")); at++)
        n_marked++;
    assert_int_equal(n_marked > 0, n_reasons > 0);
    json_decref(o);
}

/* A simulation has five copies of the design, the run up to eight. */
TEST(simulate_says_no_less_of_what_cannot_be_predicted_than_the_run_knows)
{
    OWNED(run_free) Run run = run_in("run");
    int n_unpredictable = 0;
    for (size_t i = 0; i < run.finer.n; i++) {
        const size_t row = run_find(&run, run.finer.row[i].id);
        if (!run_is_unpredictable(&run, row))
            continue;
        n_unpredictable++;
        json_auto_t *o = as_json("simulate @/run/settings.ini --json --design @/run:%ld", run.finer.row[i].id);
        const json_t *sd = json_object_get(json_object_get(o, "error"), "sd_gaps_1_um");
        for (size_t k = 0; k < run.schema.n_obj; k++)
            assert_at_most(run.table.row[row].err[k], number(sd, schema_objective(&run.schema, k)->name));
    }
    if (!n_unpredictable)
        print_message("skipped: every design that the run names can be predicted\n");
}

/* Three designs of two objectives: the second was on the front until the first came, which was better by its error. */
TEST(a_design_whose_better_values_are_worse_leaves_the_front_and_what_it_hid_is_back)
{
    Evaluation *e;
    const double F[3][2] = {{1.0, 1.0}, {1.5, 1.5}, {3.0, 0.5}};
    Run run = {.schema = {.n_var = 1, .n_obj = 2}, .table = evaluation_table(1, 2, 0)};
    Column columns[3] = {{"x", 1}, {"f1", 1}, {"f2", 1}};
    run.schema.column = columns;
    for (int i = 0; i < 3; i++) {
        CHECK_OK(evaluation_table_add(&run.table, &e, &err), &err);
        e->id = i + 1;
        e->kind = KIND_INFILL;
        e->violation = 0.0;
        memcpy(e->f, F[i], sizeof F[i]);
    }
    run.F = run.table.f;
    run.place = (RunPlace[]){{1, NEVER, 1, 1}, {0, 1, 1, 0}, {0, NEVER, 1, 1}};
    CHECK_OK(run_settle_front(&run, &err), &err);
    assert_int_equal(run.n_front, 2);
    assert_int_equal(run.front[0], 0);
    run.finer.n = 1; /* the first one, by now */
    run.F[0] = run.F[1] = 2.0;
    CHECK_OK(run_settle_front(&run, &err), &err);
    assert_int_equal(run.n_front, 2);
    assert_int_equal(run.front[0], 1);
    assert_int_equal(run.front[1], 2);
    free(run.front);
    evaluation_table_free(&run.table);
}

/* What is named then is known, and nothing else: the search went on with its own values. */
TEST(a_run_that_goes_on_names_anew)
{
    char *said = output_of(STUDY "80"), wanted[64];
    OWNED(run_free) Run run = run_in("run");
    size_t rows[OBJECTIVES_MAX + 1];
    snprintf(wanted, sizeof wanted, "refined with smaller steps: %zu designs, ", run.finer.n);
    assert_non_null(strstr(said, wanted));
    free(said);
    const size_t n = named_of(&run, rows);
    for (size_t i = 0; i < n; i++)
        assert_non_null(run.table.row[rows[i]].err);
    assert_at_most(run.finer.n, 3 * (n + 4));
    FREED char *before = read_in_place("run/front.csv");
    free(output_of("optimize @/run"));
    assert_text(read_in_place("run/front.csv"), before);
}

TEST(what_polishing_brings_to_the_front_is_known_where_it_is_named)
{
    free(output_of("polish @/run --design best_j2_m --improve j2_m --keep mcore_kg=1 --max-evals 60"));
    OWNED(run_free) Run run = run_in("run");
    size_t rows[OBJECTIVES_MAX + 1];
    const size_t n = named_of(&run, rows);
    int has_joined = 0;
    for (size_t i = 0; i < run.table.n; i++)
        has_joined |= run.table.row[i].kind == KIND_POLISHED && run.place[i].on_front;
    for (size_t i = 0; i < n && has_joined; i++)
        assert_non_null(run.table.row[rows[i]].err);
    assert_true(has_joined);
}

TEST(what_an_interrupted_study_names_is_known_too)
{
    static const char SHORT[] = "[motion]\nrecord = builtin:kobe-like\npga_g = 0.3\n[sim]\nduration_s = 4\n"
                                "[search]\ninitial = 20\npopulation = 12\nmax_evals = 60\nthreads = 2\n";
    const Settings s = settings_of(SHORT, "run-cut");
    study_stopped_after(40, &s);
    OWNED(run_free) Run run = run_in("run-cut");
    assert_non_null(run.table.row[run_knee(&run)].err);
    assert_non_null(run.table.row[run_best(&run, 0)].err);
}

SUITE_FILLED(make_place, make_run, clear_place)
