/* Designs by name: every command takes the same words, and every word leads to the same numbers. */
#include "runs.h"

#define SHORT    SIX_FLOORS "--set sim.duration_s=8 --set sim.accuracy=coarse "
#define SIMULATE "simulate configs/quick.ini " SHORT "--json --design "

typedef struct {
    long knee, off; /* ids; of a design that is not on the front */
    double off_j1;
} Known;

static Known known;

/* A small study, once for all tests. */
static void make_run(void)
{
    FREED char *said =
        output_of("optimize configs/quick.ini --out @/run --threads 2 --max-evals 24 --set search.initial=12 "
                  "--set search.population=12 --set search.polish=0 --set 'search.limits=j1_m<=0.042' " SHORT);
    assert_non_null(strstr(said, "; against viscous links J1 \u00d7 "));
    OWNED(run_free) Run h = run_in("run");
    known.knee = h.table.row[run_knee(&h)].id;
    for (size_t i = 0; i < h.table.n; i++)
        if (!h.place[i].on_front && h.place[i].ok) {
            known.off = h.table.row[i].id;
            known.off_j1 = h.table.f[i * h.schema.n_obj];
        }
    assert_less(0, known.off);
}

static double j1_of(const char *word)
{
    json_auto_t *o = as_json(SIMULATE "%s", word);
    return number(o, "j1_m");
}

TEST(a_front_of_a_taller_building_is_refused)
{
    write_in_place("two/storeys.csv", "height_m,mass_t,stiffness_kn_m\n3.5,300,4e5\n3.5,300,4e5\n");
    expect(65,
           "/run/front.csv: column gap_03_m belongs to another building or other design.variables: a design of these 2 "
           "floors has no such column",
           "simulate configs/quick.ini --set building.model=@/two --set core.width_m=2 --design @/run/front.csv");
}

TEST(a_design_is_the_same_by_every_name)
{
    free(output_of("choose @/run --csv @/chosen.csv"));
    const double knee = j1_of("@/run:knee");
    FOR_EACH (const char *, name, "@/run", "@/run/run.sqlite:knee", "@/chosen.csv:%ld", "@/run/front.csv:%ld",
              "@/run:%ld") {
        assert_same_number(j1_of(brief(*name, known.knee)), knee);
    }
}

TEST(a_row_of_a_design_file_is_taken_by_its_number)
{
    char header[400] = "", row[2][200] = {"", ""};
    for (int j = 0; j < 6; j++) {
        append(header, "gap_%02d_m,", j + 1);
        for (int i = 0; i < 2; i++)
            strcat(row[i], i ? "0.02," : "0.2,");
    }
    write_in_place("two.csv", brief("%st_base_m,t_top_m\n%s0.02,0.01\n%s0.03,0.02\n", header, row[0], row[1]));
    json_auto_t *both = as_json(SIMULATE "@/two.csv");
    assert_same_number(number(json_array_get(both, 1), "j1_m"), j1_of("@/two.csv:2"));
    assert_true(number(json_array_get(both, 0), "j1_m") != j1_of("@/two.csv:2"));
    expect(65, "has no design 3; it holds 2", SIMULATE "@/two.csv:3");
    expect(65, "is chosen by its row", SIMULATE "@/two.csv:knee");
}

TEST(designs_off_the_front_stay_addressable)
{
    assert_same_number(j1_of(brief("@/run:%ld", known.off)), known.off_j1);
    json_auto_t *o = as_json("evaluate @/run --design %ld --json", known.off);
    const json_t *first = json_array_get(json_object_get(o, "records"), 0);
    assert_same_number(number(json_object_get(first, "with_core"), "j1_m"), known.off_j1);
    free(output_of("report @/run --design %ld --record builtin:sylmar-like --out @/off.html", known.off));
    FREED char *said = output_of("polish @/run --design %ld --max-evals 24", known.off);
    assert_int_equal(strstr(said, "No improvement was found") != NULL, strstr(said, "\npolished") == NULL);
}

TEST(evaluate_without_a_record_takes_those_of_the_run)
{
    assert_same_output("evaluate @/run --design knee", "evaluate @/run --design knee --record builtin:kobe-like");
    free(output_of("optimize configs/quick.ini --out @/both --max-evals 8 --set search.initial=8 "
                   "--set search.population=8 --set search.polish=0 --set motion.records=builtin:sylmar-like " SHORT));
    json_auto_t *o = as_json("evaluate @/both --design knee --json");
    assert_int_equal(json_array_size(json_object_get(o, "records")), 2);
}

TEST(evaluate_takes_a_design_from_elsewhere)
{
    /* Of a design that the study has not named: by the steps of the settings. */
    json_auto_t *o = as_json("evaluate @/both --design @/run:%ld --json", known.off),
                *own = as_json("evaluate @/run --design %ld --json", known.off);
    const json_t *there = json_array_get(json_object_get(o, "records"), 0);
    const json_t *here = json_array_get(json_object_get(own, "records"), 0);
    assert_non_null(strstr(json_string_value(json_object_get(o, "design")), "/run:"));
    assert_same_number(number(json_object_get(there, "with_core"), "j1_m"),
                       number(json_object_get(here, "with_core"), "j1_m"));
    expect(65, "is not a design of", "polish @/both --design @/run:knee");
}

TEST(evaluate_compares_with_devices_and_replicates_have_a_named_deviation)
{
    json_auto_t *o =
        as_json("evaluate @/run --design knee --json --replicates 3 --set sim.uncertain=contact_stiffness=0.2");
    const json_t *record = json_array_get(json_object_get(o, "records"), 0);
    assert_less(0, number(json_object_get(record, "links"), "link_ns_m"));
    assert_less(0, number(json_object_get(record, "tmd"), "stroke_m"));
    const json_t *replicates = json_object_get(record, "replicates");
    assert_string_equal(json_string_value(json_object_get(replicates, "spread")), "as built");
    assert_same_number(number(replicates, "n"), 3);
    assert_words_in(output_of("evaluate @/run --design knee --replicates 3"), "mean of 3, sd predictability",
                    "the other lines are as designed", "\nviscous links (");
    expect(65, "needs replicates that differ", "evaluate @/run --design knee --set sim.uncertain=damping=0.1");
}

TEST(chances_are_among_all_numbers_and_deviations_are_named_by_what_varies)
{
#define TWO_RECORDS                                                                                                    \
    "simulate configs/quick.ini --design @/run:knee --set motion.records=builtin:sylmar-like --set "                   \
    "'search.objectives=j1_m,p(drift_ratio>0.003)' --set sim.robust=mean_plus_sd " SHORT
    json_auto_t *o = as_json(TWO_RECORDS "--json");
    const json_t *all = json_object_get(o, "replicates");
    assert_true(json_is_number(json_object_get(o, "p(drift_ratio>0.003)")));
    assert_true(json_is_number(json_object_get(json_object_get(all, "mean"), "p(drift_ratio>0.003)")));
    assert_true(json_is_null(json_object_get(json_object_get(all, "standard_error"), "ductility")));
    assert_string_equal(json_string_value(json_object_get(all, "spread")), "over records");
    FREED char *rows = output_of(TWO_RECORDS "--csv -"), *said = output_of(TWO_RECORDS);
    assert_words(rows, ",p(drift_ratio>0.003)_mean,");
    assert_words(said, " se ", "! sd ");
}

TEST(evaluate_and_simulate_estimate_the_same_error_and_a_study_shows_that_of_its_knee)
{
    json_auto_t *o = as_json("evaluate @/run --design %ld --json", known.off);
    json_auto_t *one = as_json(SIMULATE "@/run:%ld", known.off);
    const json_t *core = json_object_get(json_array_get(json_object_get(o, "records"), 0), "with_core");
    const json_t *error = json_object_get(core, "estimated_error"), *wanted = json_object_get(one, "estimated_error");
    assert_less(0, number(wanted, "j3_g"));
    assert_same_number(number(error, "j3_g"), number(wanted, "j3_g"));
    assert_same_number(number(error, "ed1_pct"), number(wanted, "ed1_pct"));
    FREED char *said = output_of("evaluate @/run --design knee");
    FREED char *other = output_of("evaluate @/run --design knee --set sim.engine=cvode --set sim.duration_s=3");
    assert_words(said, " \u00b1 ");
    assert_words(other, "!\u00b1");
    expect_output(" \u00b1 ", "optimize configs/quick.ini --out @/knee --max-evals 8 --set search.initial=8 "
                              "--set search.population=8 --set search.polish=0 " SHORT);
}

TEST(choose_names_the_extremes_and_writes_them)
{
    json_t *o = as_json("choose @/run --json --weights j1_m=1"), *list = json_object_get(o, "designs");
    assert_int_equal(json_array_size(list), 1 + 7 + 1);
    size_t i;
    json_t *pick;
    json_array_foreach(list, i, pick)
    {
        const char *name = json_string_value(json_object_get(pick, "name"));
        const double wanted = number(json_object_get(pick, "objectives"), "j1_m");
        if (strcmp(name, "weighted") == 0)
            continue;
        FREED char *word = formatted("@/run:%s", name);
        assert_close(j1_of(word), wanted, 1e-3); /* by the steps of the settings; the study has taken more */
    }
    json_decref(o);
    expect(2, "both want standard output", "choose @/run --json --csv -");
}

/* Half of the front by a result that is no objective; the ids chosen are those within. */
TEST(choose_limits_any_result_of_a_run)
{
    size_t k, i;
    OWNED(run_free) Run h = run_in("run");
    CHECK_OK(schema_pick(&h.schema, h.schema.n_obj + h.schema.n_extra, "", "drift_ratio", &k, &err), &err);
    const double bound = h.table.row[run_knee(&h)].extra[k - h.schema.n_obj];
    json_auto_t *o = as_json("choose @/run --json --max drift_ratio=%.17g", bound);
    json_t *pick;
    assert_less(0, json_array_size(json_object_get(o, "designs")));
    json_array_foreach(json_object_get(o, "designs"), i, pick)
    {
        const size_t row = run_find(&h, (long)number(pick, "id"));
        assert_at_most(h.table.row[row].extra[k - h.schema.n_obj], bound);
    }
    assert_less(number(o, "within_limits"), (double)h.n_front);
    expect(2, "did you mean drift_ratio?", "choose @/run --max drift_rato=1");
    expect(69, "this run did not store base_shear_n", "choose @/run --max base_shear_n=1");
}

/* By a result that the knee is not the best in. */
TEST(a_knee_within_limits_is_told_from_that_of_the_front)
{
    static const char *const NAMES[] = {"j1_m", "j2_m", "j3_g", "mcore_kg"};
    char words[200] = "";
    size_t i;
    json_auto_t *o = as_json("choose @/run --json");
    json_t *list = json_object_get(o, "designs"), *pick;
    const json_t *knee = json_object_get(json_array_get(list, 0), "objectives");
    json_array_foreach(list, i, pick) for (int k = 0; k < 4; k++)
    {
        if (strcmp(json_string_value(json_object_get(pick, "name")), brief("best_%s", NAMES[k])) == 0 &&
            number(pick, "id") != known.knee)
            snprintf(words, sizeof words, "choose @/run --max %s=%.17g", NAMES[k],
                     nextafter(number(knee, NAMES[k]), 0));
    }
    assert_true(words[0]);
    FREED char *wanted = formatted("of the whole front, is design %ld\n", known.knee);
    FREED char *said = output_of("choose @/run");
    assert_null(strstr(said, wanted));
    expect_output(wanted, words);
}

TEST(words_that_name_nothing_are_refused_with_what_is_there)
{
    expect(65, "the nearest id is 24", SIMULATE "@/run:999");
    expect(65, "did you mean knee", SIMULATE "@/run:nee");
    expect(65, "j1 is no objective; did you mean j1_m?", SIMULATE "@/run:best_j1");
    expect(66, "nowhere", SIMULATE "@/nowhere:knee");
    expect(66, "holds no run", SIMULATE "@/");
    expect(65, "has no design of id 999", SIMULATE "@/run/front.csv:999");
}

SUITE_FILLED(make_place, make_run, clear_place)
