/* One rule for replicates: a study, `imtet simulate --replicates` and the summary of a tower agree to the last digit. */
#include "runs.h"
#include "scene_options.h"
#include "sim/as_built.h"
#include "evaluate/adapter.h"

enum { DESIGNS = 3, N_VAR = 22 };

static Settings short_scene(const char *records, long replicates, const char *tolerance)
{
    Settings s = paper_settings();
    s.sim.duration_s = 25.0; /* tiny changes have not grown yet, wide ones tell */
    s.sim.accuracy = ACCURACY_COARSE;
    s.sim.forces = FORCES_YES; /* every measure, those of the ground too */
    snprintf(s.core.foundation, sizeof s.core.foundation, "soil=C radius=10");
    s.sim.replicates = replicates;
    CHECK_OK(settings_set(&s, brief("motion.records=%s", records), &err), &err);
    CHECK_OK(settings_set(&s, brief("sim.gap_tolerance_m=%s", tolerance), &err), &err);
    return s;
}

static void designs(double X[DESIGNS * N_VAR])
{
    for (int i = 0; i < DESIGNS; i++)
        for (int j = 0; j < N_VAR; j++)
            X[i * N_VAR + j] = j < 20 ? 0.02 + 0.03 * i + 0.002 * j : j == 20 ? 0.03 : 0.01;
}

typedef struct {
    SimResult shown[DESIGNS];
    ReplicateSummary sum[DESIGNS];
} Replicated;

static Replicated run_designs(Settings s, long threads)
{
    double X[DESIGNS * N_VAR];
    Replicated out = {0};
    OWNED(problem_close) Problem p;
    designs(X);
    s.search.threads = threads;
    CHECK_OK(tower_open(&p, &s, TOWER_AS_SET, SIZE_MAX, &err), &err);
    CHECK_OK(tower_replicate(&p, DESIGNS, X, out.shown, out.sum, &err), &err);
    return out;
}

TEST(one_replicate_under_one_record_is_the_simulation_itself)
{
    const Settings s = short_scene("none", 1, "0");
    const Replicated out = run_designs(s, 1);
    for (int i = 0; i < DESIGNS; i++)
        for (int k = 0; k < N_MEASURES; k++) {
            const double own = measure_value(&out.shown[i], k);
            if (isnan(own)) /* what the scene does not have: the rotation of a fixed base */
                assert_true(isnan(out.sum[i].mean[k]));
            else
                assert_same_number(out.sum[i].mean[k], own);
            assert_true(isnan(out.sum[i].sd[k]));
        }
}

TEST(of_several_records_the_worst_or_the_mean_counts)
{
    Settings one = short_scene("none", 1, "0"), other = one, both = short_scene("builtin:sylmar-like", 1, "0");
    snprintf(other.motion.record, sizeof other.motion.record, "builtin:sylmar-like");
    const Replicated a = run_designs(one, 1), b = run_designs(other, 1), worst = run_designs(both, 2);
    both.sim.robust = ROBUST_MEAN;
    const Replicated mean = run_designs(both, 1);
    for (int i = 0; i < DESIGNS; i++)
        for (int k = 0; k < PAPER_OBJECTIVES; k++) {
            const double x = a.sum[i].mean[k], y = b.sum[i].mean[k];
            assert_same_number(worst.sum[i].mean[k], (measure(k)->sense > 0.0 ? fmax(x, y) : fmin(x, y)));
            assert_close(mean.sum[i].mean[k], 0.5 * (x + y), 1e-12);
        }
}

/* Wide gap errors spread the answers; tiny changes hardly do within a short time where gaps are wide, as in the last
 * design; the core's mass never. */
TEST(replicates_with_gap_errors_have_mean_and_deviation)
{
    const Settings tiny = short_scene("none", 4, "0"), wide = short_scene("none", 4, "0.01");
    const Replicated a = run_designs(tiny, 1), b = run_designs(wide, 1), again = run_designs(wide, 3);
    for (int i = 0; i < DESIGNS; i++) {
        assert_true(a.sum[i].sd[0] >= 0.0 && b.sum[i].sd[0] > 0.0);
        assert_true(i < DESIGNS - 1 || b.sum[i].sd[0] > 100.0 * a.sum[i].sd[0]);
        assert_less(fabs(b.sum[i].mean[0] - a.sum[i].mean[0]), 4.0 * b.sum[i].sd[0]);
        assert_at_most(b.sum[i].sd[6], 1e-9 * b.sum[i].mean[6]);
        assert_memory_equal(b.sum[i].mean, again.sum[i].mean, sizeof b.sum[i].mean);
        assert_memory_equal(b.sum[i].sd, again.sum[i].sd, sizeof b.sum[i].sd);
    }
}

TEST(without_contact_there_is_no_spread)
{
    double x[N_VAR];
    Settings s = short_scene("none", 4, "0");
    OWNED(problem_close) Problem p;
    SimResult shown;
    ReplicateSummary sum;
    for (int j = 0; j < N_VAR; j++)
        x[j] = j < 20 ? 4.0 * (j + 1) : 0.01;
    CHECK_OK(tower_open(&p, &s, TOWER_AS_SET, SIZE_MAX, &err), &err);
    CHECK_OK(tower_replicate(&p, 1, x, &shown, &sum, &err), &err);
    assert_int_equal(sum.n_failed, 0);
    for (int k = 0; k < N_MEASURES; k++)
        if (!isnan(measure_value(&shown, k)))
            assert_at_most(sum.sd[k], 1e-12 * fabs(sum.mean[k]));
}

/* Replicates 0..3 and, asked for again, 4..7 are other ones; the rule of each is a function of seed and number alone. */
TEST(a_design_asked_for_again_gets_further_replicates)
{
    double X[DESIGNS * N_VAR], first[N_VAR], fifth[N_VAR];
    const Settings s = short_scene("none", 4, "0.01");
    OWNED(problem_close) Problem p;
    Queue *q;
    Finished done;
    SimResult alone;
    designs(X);
    CHECK_OK(tower_open(&p, &s, TOWER_AS_SET, SIZE_MAX, &err), &err);
    CHECK_OK(queue_open(&q, &p, &err), &err);
    CHECK_OK(queue_ask(q, &(Asked){.x = X, .repeat = 1}, &err), &err);
    CHECK_OK(queue_next(q, &done, &err), &err);
    memcpy(first, X, sizeof first);
    memcpy(fifth, X, sizeof fifth);
    replicate_design((uint32_t)s.search.seed, 0, 0, 0.01, 20, first);
    replicate_design((uint32_t)s.search.seed, 0, 4, 0.01, 20, fifth);
    assert_memory_equal(first, X, sizeof first);
    assert_memory_not_equal(fifth, X, sizeof fifth);
    CHECK_OK(tower_simulate(&p, 1, &(SimTask){.kind = SCENE_RIGID, .x = fifth}, &alone, &err), &err);
    assert_int_equal(alone.impacts, 0);
    Settings single = s;
    single.sim.gap_tolerance_m = 0.0;
    OWNED(problem_close) Problem other;
    CHECK_OK(tower_open(&other, &single, TOWER_SINGLE, 1, &err), &err);
    CHECK_OK(tower_simulate(&other, 1, &(SimTask){.kind = SCENE_IMPACT, .x = fifth}, &alone, &err), &err);
    assert_same_number(alone.j1_m, ((const Measured *)done.parts)[0].value[MEASURE_J1]);
    queue_close(q);
}

static void run_as_built(const Problem *p, const AsBuilt *built, const double x[], SimResult *r)
{
    SimWorker *w;
    CHECK_OK(sim_worker_create(&w, tower_record(tower_of(p), 0)->scene, &err), &err);
    CHECK_OK(sim_worker_as_built(w, built, &err), &err);
    CHECK_OK(sim_run(w, SCENE_IMPACT, x, r, &err), &err);
    sim_worker_free(w);
}

static SimResult run_scene(const Settings *s, const AsBuilt *built)
{
    double X[DESIGNS * N_VAR];
    OWNED(problem_close) Problem p;
    SimResult r;
    designs(X);
    CHECK_OK(tower_open(&p, s, TOWER_SINGLE, 1, &err), &err);
    run_as_built(&p, built, X, &r);
    return r;
}

TEST(a_structure_as_built_is_the_scene_whose_settings_say_so)
{
    Settings s = short_scene("none", 1, "0");
    s.building.yield_drift = 0.004;
    const SimResult designed = run_scene(&s, NULL);
    for (int k = 0; k < 7; k++) {
        Settings other = s;
        AsBuilt b = AS_DESIGNED;
        const struct {
            double *built, value, *set;
        } part[] = {{&b.restitution, -0.2, &other.contact.restitution},
                    {&b.contact_stiffness, 2, &other.contact.youngs_modulus_pa},
                    {&b.core_stiffness, 1.5, &other.core.youngs_modulus_pa},
                    {&b.core_damping, 0.5, &other.core.damping},
                    {&b.ground_stiffness, 0.5, &other.core.foundation_factor},
                    {&b.strength, 0.6, &other.building.yield_drift},
                    {&b.building_damping, 3, &other.building.damping.at[0]}};
        *part[k].built = part[k].value;
        *part[k].set = k == 0 ? *part[k].set + part[k].value : *part[k].set * part[k].value;
        const SimResult built = run_scene(&s, &b), wanted = run_scene(&other, NULL);
        assert_close(built.j1_m, wanted.j1_m, 1e-9);
        assert_close(built.j3_g, wanted.j3_g, 1e-6);
        assert_less(1e-4, fabs(built.j3_g / designed.j3_g - 1));
    }
}

TEST(a_stiffer_building_vibrates_faster_by_the_root_of_it)
{
    Building b, out;
    FREED double *store = NULL;
    AsBuilt stiff = AS_DESIGNED;
    stiff.building_stiffness = 1.21;
    CHECK_OK(load_model(&b, "guyan", &err), &err);
    CHECK_OK(as_built_building(&stiff, &b, &out, &store, &err), &err);
    for (int i = 0; i < b.n; i++) {
        assert_close(out.omega[i], 1.1 * b.omega[i], 1e-12);
        assert_close(out.model.omega[i], 1.1 * b.model.omega[i], 1e-12);
        assert_close(out.K[i * b.n + i], 1.21 * b.K[i * b.n + i], 1e-12);
        assert_true(out.zeta[i] == b.zeta[i] && out.phi == b.phi);
    }
    building_free(&b);
}

TEST(what_is_uncertain_has_its_mean_and_deviation_and_the_rest_is_as_designed)
{
    enum { DRAWS = 20000 };
    const UncertainOptions u = {.restitution = 0.1, .core_stiffness = 0.3, .damping = 0.5};
    double sum[3] = {0}, squares[3] = {0};
    assert_same_number(replicate_as_built(1, 0, &u).core_stiffness, 1);
    for (size_t k = 1; k <= DRAWS; k++) {
        const AsBuilt b = replicate_as_built(1, k, &u);
        const double of[3] = {b.restitution, b.core_stiffness - 1, b.building_damping - 1};
        assert_true(b.contact_stiffness == 1 && b.building_stiffness == 1 && b.core_stiffness > 0);
        for (int i = 0; i < 3; i++) {
            sum[i] += of[i] / DRAWS;
            squares[i] += of[i] * of[i] / DRAWS;
        }
    }
    const double wanted[3] = {0.1, 0.3, 0.5};
    for (int i = 0; i < 3; i++) {
        assert_less(fabs(sum[i]), 5 * wanted[i] / sqrt(DRAWS));
        assert_close(sqrt(squares[i]), wanted[i], 0.05);
    }
}

TEST(rules_over_all_replicates_have_their_closed_values)
{
    const ReplicatePlan plus = {.rule = ROBUST_MEAN_PLUS_SD}, quantile = {.rule = ROBUST_QUANTILE, .quantile = 0.9};
    double v[5] = {3, 1, 5, 2, 4}, sd;
    assert_close(robust_pooled(&plus, 1, 5, v, &sd), 3 + sqrt(2.5), 1e-14);
    assert_close(sd, sqrt(2.5), 1e-14);
    assert_close(robust_pooled(&plus, -1, 5, v, &sd), 3 - sqrt(2.5), 1e-14);
    assert_close(robust_pooled(&quantile, 1, 5, v, &sd), 4.6, 1e-14);
    assert_close(robust_pooled(&quantile, -1, 5, v, &sd), 1.4, 1e-14);
    assert_close(robust_pooled(&plus, 1, 1, v, &sd), 1, 1e-14);
}

TEST(the_two_deviations_of_replicates_have_two_names)
{
    const UncertainOptions none = {0}, some = {.damping = 0.1};
    assert_string_equal(spread_word(0, &none), "predictability");
    assert_string_equal(spread_word(0.005, &none), "as built");
    assert_string_equal(spread_word(0, &some), "as built");
}

/* A study under mean_plus_sd has mean and deviation of the replicates that are simulated one by one. */
TEST(mean_plus_sd_is_that_of_the_single_simulations)
{
    enum { REPLICATES = 4 };
    Settings s = short_scene("none", REPLICATES, "0.01");
    double X[DESIGNS * N_VAR], v[REPLICATES], mean, sd;
    s.sim.uncertain.contact_stiffness = 0.5;
    s.sim.robust = ROBUST_MEAN_PLUS_SD;
    const Replicated out = run_designs(s, 2);
    designs(X);
    for (size_t k = 0; k < REPLICATES; k++) {
        Settings single = s;
        double x[N_VAR];
        OWNED(problem_close) Problem p;
        SimResult r;
        const AsBuilt b = replicate_as_built((uint32_t)s.search.seed, k, &s.sim.uncertain);
        memcpy(x, X, sizeof x);
        replicate_design((uint32_t)s.search.seed, 0, k, 0.01, 20, x);
        CHECK_OK(tower_open(&p, &single, TOWER_SINGLE, 1, &err), &err);
        run_as_built(&p, k ? &b : NULL, x, &r);
        v[k] = r.j3_g;
    }
    mean_and_sd_of(REPLICATES, v, &mean, &sd);
    assert_close(out.sum[0].mean[MEASURE_J3], mean + sd, 1e-12);
    assert_close(out.sum[0].sd[MEASURE_J3], sd, 1e-12);
}

#define SHORT                                                                                                          \
    "--set motion.stretch=1 --set sim.duration_s=6 --set sim.accuracy=coarse --set motion.record=builtin:sylmar-like "

static void write_design(void)
{
    char text[1200] = "";
    double X[DESIGNS * N_VAR];
    designs(X);
    for (int j = 0; j < 20; j++)
        append(text, "gap_%02d_m,", j + 1);
    append(text, "t_base_m,t_top_m\n");
    for (int j = 0; j < N_VAR; j++)
        append(text, "%.17g%c", X[j], j + 1 < N_VAR ? ',' : '\n');
    write_in_place("design.csv", text);
}

/* Mean and deviation of every objective as `imtet simulate --replicates 6` has them. */
static void simulated(const char *set, double mean[PAPER_OBJECTIVES], double sd[PAPER_OBJECTIVES])
{
    FREED char *text =
        output_of("simulate configs/quick.ini --design @/design.csv --replicates 6 --json " SHORT "%s", set);
    json_auto_t *o = json_loads(text, 0, NULL);
    const json_t *e = json_object_get(o, "replicates");
    assert_non_null(e);
    for (int k = 0; k < PAPER_OBJECTIVES; k++) {
        mean[k] = json_real_value(json_object_get(json_object_get(e, "mean"), measure(k)->name));
        sd[k] = json_real_value(json_object_get(json_object_get(e, "sd"), measure(k)->name));
    }
}

TEST(simulate_draws_the_replicates_of_a_study_and_knows_the_tolerance)
{
    static const char TOLERANCE[] = "--set sim.gap_tolerance_m=0.02 --set motion.records=builtin:elcentro-like";
    double mean[3][PAPER_OBJECTIVES], sd[3][PAPER_OBJECTIVES];
    write_design();
    simulated("--set sim.gap_tolerance_m=0", mean[0], sd[0]);
    simulated("--set sim.gap_tolerance_m=0.02", mean[1], sd[1]);
    simulated(TOLERANCE, mean[2], sd[2]);
    for (int k = 0; k < 6; k++)
        assert_true(sd[0][k] != sd[1][k] && mean[0][k] != mean[1][k]);
    assert_less(2.0 * sd[0][0], sd[1][0]);
    free(
        output_of("optimize configs/quick.ini --out @/study --threads 2 --set search.start=%s/design.csv --max-evals 4 "
                  "--set search.initial=4 --set search.population=4 --set sim.replicates=6 " SHORT "%s",
                  place.folder, TOLERANCE));
    OWNED(run_free) Run h = run_in("study");
    assert_memory_equal(h.F, mean[2], sizeof mean[2]);
    assert_memory_equal(h.table.sd, sd[2], sizeof sd[2]);
}

/* The CSV of `imtet simulate` with these words. */
static char *csv_of(const char *set)
{
    return output_of("simulate configs/quick.ini --design @/design.csv --csv - " SHORT "%s", set);
}

TEST(replicates_and_records_follow_one_rule_however_they_are_asked_for)
{
    write_design();
    FREED char *by_option = csv_of("--replicates 3 --set sim.gap_tolerance_m=0.02");
    FREED char *by_set = csv_of("--set sim.replicates=3 --set sim.gap_tolerance_m=0.02");
    assert_string_equal(by_option, by_set);
    assert_non_null(strstr(by_set, ",1,3,mean,as built,"));
    assert_words_in(csv_of("--set motion.records=builtin:elcentro-like --set sim.robust=worst"),
                    ",2,1,worst,predictability,");
    assert_words_in(csv_of(""), "!_mean");
    expect(2, "needs a design with gaps", "simulate configs/quick.ini --design none --set sim.replicates=4");
    expect(2, "needs a design with gaps", "simulate configs/quick.ini --design @/design.csv --rigid --replicates 4");
}

SUITE(prepare, clear_place)
