/* search.objectives and search.limits on any result: what is searched for, what is computed, and what the files say. */
#include "runs.h"

#include "base/figure.h"
#include "study/front_review.h"

/* A short, cheap study of a tower of six floors. */
enum { FLOORS = 6, N_VAR = FLOORS + 2 };
static const char TOWER[] = SIX_FLOORS_INI "[sim]\nduration_s = 8\naccuracy = coarse\n"
                                           "[search]\ninitial = 16\npopulation = 8\nmax_evals = 30\nthreads = 1\n"
                                           "polish = 0\n";

static void optimize(const char *name, const char *more)
{
    write_in_place("tower.ini", TOWER);
    free(output_of("optimize @/tower.ini --out @/%s %s", name, more));
}

/* The further measure of that name; NAN where the cell is empty. */
static double extra_of(const Run *run, size_t row, const char *name)
{
    for (size_t k = 0; k < run->schema.n_extra; k++)
        if (strcmp(schema_extra(&run->schema, k)->name, name) == 0)
            return run->table.row[row].extra[k];
    fail_msg("%s is no further measure", name);
    return NAN;
}

TEST(what_is_not_asked_for_is_not_computed_and_left_empty)
{
    optimize("plain", "");
    Run run = run_in("plain");
    assert_int_equal(run.schema.n_obj, 7);
    for (size_t i = 0; i < run.table.n; i++) {
        assert_true(isnan(extra_of(&run, i, "contact_force_max_n")) && isnan(extra_of(&run, i, "core_stress_pa")));
        assert_true(isnan(extra_of(&run, i, "base_shear_n")));
        assert_less(0.0, extra_of(&run, i, "drift_ratio"));
        assert_same_number((extra_of(&run, i, "indentation_ratio") > 0.1),
                           (extra_of(&run, i, "beyond_contact_law") == 1.0));
    }
    run_free(&run);
    optimize("forces", "--set sim.forces=yes");
    OWNED(run_free) Run forces = run_in("forces");
    run = run_in("plain");
    assert_memory_equal(forces.F, run.F, run.table.n * 7 * sizeof *run.F);
    for (size_t i = 0; i < forces.table.n; i++)
        assert_true(extra_of(&forces, i, "core_stress_pa") > 0.0 && extra_of(&forces, i, "base_shear_n") > 0.0);
    run_free(&run);
}

TEST(every_result_of_a_study_is_that_of_a_simulation_of_the_same_design)
{
    optimize("other", "--set 'search.objectives=core_stress_pa, impacts , j1_m'");
    OWNED(run_free) Run run = run_in("other");
    assert_int_equal(run.schema.n_obj, 3);
    const size_t row = run.front[0];
    json_auto_t *o = as_json("simulate @/tower.ini --design @/other:%ld --json", run.table.row[row].id);
    assert_same_number(number(o, "core_stress_pa"), run_f(&run, row)[0]);
    assert_same_number(number(o, "impacts"), run_f(&run, row)[1]);
    assert_same_number(number(o, "j1_m"), run_f(&run, row)[2]);
    for (size_t k = 0; k < run.schema.n_extra; k++) {
        const json_t *value = json_object_get(o, schema_extra(&run.schema, k)->name);
        const double stored = run.table.row[row].extra[k];
        if (strcmp(schema_extra(&run.schema, k)->name, "j3_filtered_g") == 0)
            assert_true(isnan(stored) && json_is_real(value)); /* forces do not bring the filter with them */
        else if (json_is_number(value))
            assert_same_number(json_number_value(value), stored);
        else
            assert_true(json_is_null(value) ? isnan(stored) : json_is_true(value) == (stored == 1.0));
    }
}

TEST(every_file_and_command_follows_the_objectives_by_name)
{
    OWNED(table_free) Table front = table_of("other/front.csv");
    assert_int_equal(front.n_cols, 1 + N_VAR + 3 + 3);
    assert_string_equal(front.names[1 + N_VAR], "core_stress_pa");
    assert_string_equal(front.names[1 + N_VAR + 2], "j1_m");
    double least = HUGE_VAL;
    for (size_t i = 0; i < front.n_rows; i++)
        least = fmin(least, front.values[i * front.n_cols + 1 + N_VAR]);
    json_auto_t *o = as_json("choose @/other --json --min core_stress_pa=1 --weights core_stress_pa=1,impacts=1e-9");
    const json_t *designs = json_object_get(o, "designs"),
                 *last = json_array_get(designs, json_array_size(designs) - 1);
    assert_string_equal(json_string_value(json_object_get(last, "name")), "weighted");
    assert_same_number(number(json_object_get(last, "objectives"), "core_stress_pa"), least);
    json_auto_t *exported = as_json("export @/other --json");
    const json_t *columns = json_object_get(exported, "columns"), *column;
    size_t i, objectives = 0;
    json_array_foreach(columns, i, column) objectives +=
        strcmp(json_string_value(json_object_get(column, "role")), "objective") == 0;
    assert_int_equal(objectives, 3);
    free(output_of("report @/other"));
    free(output_of("polish @/other --design knee --improve core_stress_pa --max-evals 30 --csv @/polished.csv"));
    OWNED(table_free) Table polished = table_of("polished.csv");
    assert_int_equal(polished.n_cols, 1 + N_VAR + 5 * 3);
    assert_string_equal(polished.names[1 + N_VAR + 3], "core_stress_pa_before");
    assert_string_equal(polished.names[1 + N_VAR + 12], "core_stress_pa_error");
    const double before = polished.values[1 + N_VAR + 3], error = polished.values[1 + N_VAR + 12];
    assert_close(before, polished.values[1 + N_VAR], 0.5);
    assert_true(error > 0.0 && error < 0.1 * before);
    free(output_of("optimize @/other"));
    expect_output("largest bending stress of the core [Pa], lower is better", "optimize @/other --max-evals 34");
    expect(65, "search.objectives is core_stress_pa, impacts , j1_m there, now auto",
           "optimize @/tower.ini --out @/other");
}

TEST(a_limit_on_a_further_result_decides_what_is_on_the_front)
{
    OWNED(run_free) Run free_of, run;
    free_of = run_in("forces");
    double limit = 0.0;
    for (size_t i = 0; i < free_of.n_front; i++)
        limit += extra_of(&free_of, free_of.front[i], "contact_force_max_n") / (double)free_of.n_front;
    optimize("limited", brief("--set 'search.limits=contact_force_max_n<=%.17g, drift_ratio<=0.9'", limit));
    run = run_in("limited");
    size_t beyond = 0;
    for (size_t i = 0; i < run.table.n; i++) {
        const double force = extra_of(&run, i, "contact_force_max_n");
        assert_close(run.table.row[i].violation, fmax(0.0, force / limit - 1.0), 1e-9);
        beyond += run.table.row[i].violation > 0.0;
        assert_true(!run.place[i].on_front || force <= limit);
    }
    assert_true(beyond > 0 && beyond < run.table.n && run.n_front > 0);
}

static void expect_limited_in(const char *name)
{
    OWNED(table_free) Table front = table_of(name);
    OWNED(run_free) Run run = run_in("limited");
    const size_t at = 1 + run.schema.n_var + run.schema.n_obj;
    assert_int_equal(front.n_cols, at + 2 + run.schema.n_obj); /* the last ones: likely errors */
    assert_int_equal(front.n_rows, run.n_front);
    for (size_t i = 0; i < front.n_rows; i++)
        for (size_t c = at; c < at + 2; c++)
            assert_same_number(front.values[i * front.n_cols + c], extra_of(&run, run.front[i], front.names[c]));
    assert_true(strcmp(front.names[at], "drift_ratio") == 0 && strcmp(front.names[at + 1], "contact_force_max_n") == 0);
}

TEST(limited_results_stand_beside_the_objectives)
{
    expect_limited_in("limited/front.csv");
    free(output_of("optimize @/limited --max-evals 40"));
    expect_limited_in("limited/front.csv");
    free(output_of("export @/limited --csv @/exported.csv"));
    expect_limited_in("exported.csv");
    json_auto_t *o = as_json("choose @/limited --json");
    const json_t *knee = json_array_get(json_object_get(o, "designs"), 0);
    OWNED(run_free) Run run = run_in("limited");
    assert_same_number(number(json_object_get(knee, "limited"), "contact_force_max_n"),
                       extra_of(&run, run_knee(&run), "contact_force_max_n"));
    expect_output("  drift_ratio  contact_force_max_n\n", "choose @/limited");
}

/* The n-th line behind the first that begins with `from`, NULL: none. */
static char *line_from(char *text, const char *from, int n)
{
    char *line = strstr(text, from);
    for (; line && n > 0; n--)
        line = strchr(line, '\n') + 1;
    return line;
}

TEST(columns_stand_below_their_names_however_long_these_are)
{
    write_in_place("tower.ini", TOWER);
    FREED char *said = output_of("optimize @/tower.ini --out @/long --set "
                                 "search.objectives=j1_m,building_base_shear_n,contact_force_max_n,mcore_kg");
    for (char *sign; (sign = strstr(said, "\u00b1"));) /* of two bytes, one place */
        memmove(sign, sign + 1, strlen(sign));
    char *heads = line_from(said, " design ", 0), *row = line_from(said, "best building_base_shear_n", 0);
    while (heads > said && heads[-1] != '\n')
        heads--;
    assert_non_null(row);
    for (const char *end = heads; *end != '\n'; end++) /* every name ends where a number does */
        if (end[0] != ' ' && (end[1] == ' ' || end[1] == '\n')) {
            const char below = row[end - heads], next = row[end - heads + 1];
            if (below == ' ' || (next != ' ' && next != '\n'))
                fail_msg("%.200s", heads);
        }
}

/* ---- the end of a study ------------------------------------------------------------------------------------------- */

TEST(the_status_of_a_study_names_gaps_that_never_close)
{
    write_in_place("tower.ini", TOWER);
    free(output_of("optimize @/tower.ini --out @/calm --set motion.pga_g=0.0005"));
    json_auto_t *o = as_json("status @/calm --json");
    const json_t *review = json_object_get(o, "front_review");
    assert_int_equal(json_integer_value(json_object_get(review, "beyond_contact_law")), 0);
    assert_int_equal(json_array_size(json_object_get(review, "gaps_on_smallest")), FLOORS);
    const json_t *never = json_object_get(review, "never_closing");
    assert_int_equal(json_array_size(never), FLOORS);
    assert_int_equal(json_integer_value(json_array_get(never, FLOORS - 1)), FLOORS);
    assert_less(0, number(review, "designs_simulated"));
}

TEST(gaps_on_their_bounds_are_counted_floor_by_floor)
{
    enum { THREE = 3, DESIGNS = 4 };
    Settings s;
    Run run = {.settings = &s, .n_front = 3, .front = (size_t[]){0, 1, 3}};
    Evaluation *e;
    settings_defaults(&s); /* gaps of 1 to 500 mm */
    CHECK_OK(schema_of(&run.schema, &s, THREE, &err), &err);
    run.table = evaluation_table(run.schema.n_var, run.schema.n_obj, run.schema.n_extra);
    static const double X[DESIGNS][THREE + 2] = {{0.001, 0.2, 0.5, 0.01, 0.01},
                                                 {0.001, 0.5, 0.4999999, 0.01, 0.01},
                                                 {0.001, 0.5, 0.5, 0.01, 0.01}, /* not on the front */
                                                 {0.0011, 0.001, 0.5, 0.04, 0.004}};
    for (int i = 0; i < DESIGNS; i++) {
        CHECK_OK(evaluation_table_add(&run.table, &e, &err), &err);
        memcpy(e->x, X[i], sizeof X[i]);
        for (size_t k = 0; k < run.schema.n_extra; k++)
            if (strcmp(schema_extra(&run.schema, k)->name, "beyond_contact_law") == 0)
                e->extra[k] = i != 1;
    }
    const FrontReview r = front_review(&run);
    assert_int_equal(r.n_gaps, THREE);
    assert_true(r.at_smallest[0] == 2 && r.at_smallest[1] == 1 && r.at_smallest[2] == 0);
    assert_true(r.at_largest[0] == 0 && r.at_largest[1] == 1 && r.at_largest[2] == 2);
    assert_int_equal(r.n_beyond, 2);
    evaluation_table_free(&run.table);
    schema_free(&run.schema);
}

SUITE(prepare, clear_place)
