/* The model that a study chooses (sim.model = auto): against simulations of what is meant, effects of which the answer
 * is known beforehand, what the settings give, what it may cost, and a run that keeps what it has chosen. */
#include "runs.h"
#include "towers.h"

#include "analysis/model_choice.h"

static void make_buildings(void)
{
    write_in_place("six/storeys.csv", "height_m,mass_t,stiffness_kn_m\n3.6,390,354344\n3.6,390,318910\n3.6,390,283475\n"
                                      "3.6,390,248041\n3.6,390,212606\n3.6,390,177172\n");
    write_in_place("s.ini", "[building]\nmodel = six\n[core]\nwidth_m = 4\n[design]\ngap_m = 0.001, 0.13\n"
                            "[motion]\nrecord = builtin:elcentro-like\npga_g = 0.35\n[sim]\nmodel = auto\n"
                            "duration_s = 8\naccuracy = coarse\n[search]\nobjectives = j1_m, drift_ratio, j3_g\n"
                            "initial = 12\npopulation = 8\nmax_evals = 24\nthreads = 2\npolish = 0\n");
}

static Settings scene_of(const char *const sets[])
{
    Settings s = default_settings();
    CHECK_OK(settings_read(&s, there("s.ini"), NULL, NULL, &err), &err);
    for (; *sets; sets++)
        CHECK_OK(settings_set(&s, *sets, &err), &err);
    return s;
}

static int never(void *user)
{
    (void)user;
    return 1;
}

static ModelChoice *chosen(Settings *s)
{
    ModelChoice *c = malloc(sizeof *c);
    CHECK_OK(model_choose(s, &(Observer){.go_on = never}, c, &err), &err);
    return c;
}

static const LadderEffect *effect(const ModelChoice *c, const char *key)
{
    for (size_t i = 0; i < c->ladder.n; i++)
        if (strcmp(c->ladder.effect[i].key, key) == 0)
            return &c->ladder.effect[i];
    return NULL;
}

static Measured simulated(const Settings *s, SceneKind kind, const double x[])
{
    const SimResult r = simulated_as(kind, s, x);
    return measured(&r);
}

/* The three designs, as they are meant: gaps up to where the building with all effects sways. */
static void designs_of(const Settings *all, double X[3][DESIGN_VARIABLES_MAX])
{
    DesignSpace space;
    const double sway_m = simulated(all, SCENE_NO_CORE, NULL).value[MEASURE_J1];
    CHECK_OK(tower_space(all, &space, &err), &err);
    for (size_t k = 0; k < 3; k++) {
        design_spread(&space, &all->design, k, 3, sway_m, X[k]);
        for (int j = 0; j < space.n_gaps; j++)
            assert_true(X[k][j] >= 0.001 && X[k][j] <= sway_m * (j + 1) / space.n_gaps);
    }
}

TEST(what_is_chosen_is_within_the_tolerance_of_all_effects_in_every_scene_of_every_design)
{
    Settings s = scene_of((const char *const[]){"motion.pga_g=0.15", NULL}), all = s;
    FREED ModelChoice *c = chosen(&s);
    double X[3][DESIGN_VARIABLES_MAX];
    int n_off = 0;
    for (size_t i = 0; i < c->ladder.n; i++) {
        const LadderEffect *e = &c->ladder.effect[i];
        CHECK_OK(settings_put(&all, e->key, e->with, &err), &err);
        n_off += !e->is_kept;
    }
    assert_true(c->n_cases == 3 && c->n_records == 1);
    assert_less(0, n_off);
    designs_of(&all, X);
    for (int k = 0; k < 3; k++)
        for (int i = 0; i < LADDER_SCENES; i++) {
            const Measured set = simulated(&s, LADDER_SCENE[i], X[k]), whole = simulated(&all, LADDER_SCENE[i], X[k]);
            for (int m = 0; m < LADDER_MEASURES; m++)
                assert_at_most(fabs(ladder_change(&set, &whole, m)),
                               i == 0 ? c->ladder.tolerance[m] : LADDER_TOLERANCE);
        }
}

/* Each alone, from the model with all: some scene of the design in which it was found changes by more. */
TEST(what_is_needed_changes_one_of_the_designs_by_more_than_the_tolerance)
{
    Settings s = scene_of((const char *const[]){NULL}), all = s;
    FREED ModelChoice *c = chosen(&s);
    double X[3][DESIGN_VARIABLES_MAX];
    for (size_t i = 0; i < c->ladder.n; i++)
        CHECK_OK(settings_put(&all, c->ladder.effect[i].key, c->ladder.effect[i].with, &err), &err);
    designs_of(&all, X);
    for (size_t i = 0; i < c->ladder.n; i++) {
        const LadderEffect *e = &c->ladder.effect[i];
        Settings without = all;
        double most = 0;
        CHECK_OK(settings_put(&without, e->key, e->without, &err), &err);
        for (int k = 0; k < 3 && e->is_needed; k++)
            for (int j = 0; j < LADDER_SCENES; j++) {
                const Measured to = simulated(&without, LADDER_SCENE[j], X[k]),
                               from = simulated(&all, LADDER_SCENE[j], X[k]);
                for (int m = 0; m < LADDER_MEASURES; m++)
                    most = fmax(most, fabs(ladder_change(&to, &from, m)));
            }
        assert_true(!e->is_needed || most > LADDER_TOLERANCE);
    }
}

TEST(what_the_settings_give_stays_be_it_the_default)
{
    Settings s = scene_of((const char *const[]){"building.p_delta=off", "core.foundation=rotation=5.5e11", NULL});
    FREED ModelChoice *c = chosen(&s);
    assert_true(effect(c, "building.p_delta")->is_set && effect(c, "core.foundation")->is_set);
    assert_false(effect(c, "core.theory")->is_set);
    assert_int_equal(s.building.p_delta, SWITCH_OFF);
    assert_string_equal(s.core.foundation, "rotation=5.5e11");
}

/* Light storeys that stay elastic: their weight softens nothing, and no drift comes near 1 %. */
TEST(of_a_stiff_building_in_a_weak_motion_neither_p_delta_nor_yielding_is_needed)
{
    Settings s = scene_of((const char *const[]){"motion.pga_g=0.02", NULL});
    FREED ModelChoice *c = chosen(&s);
    assert_false(effect(c, "building.yield_drift")->is_kept);
    assert_same_number(s.building.yield_drift, 0);
    assert_less(effect(c, "building.yield_drift")->most, 0.1);
}

TEST(the_end_of_the_record_is_open_where_only_peaks_are_searched_for)
{
    Settings peaks = scene_of((const char *const[]){NULL}), shares;
    memset(peaks.given, 0, sizeof peaks.given);
    peaks.sim.duration_s = 0;
    shares = peaks;
    CHECK_OK(settings_set(&shares, "search.objectives=j1_m, ed1_pct", &err), &err);
    FREED ModelChoice *open = chosen(&peaks), *set = chosen(&shares);
    assert_false(effect(open, "sim.duration_s")->is_set);
    assert_true(effect(set, "sim.duration_s")->is_set && shares.sim.duration_s == 0);
}

TEST(it_costs_60_simulations_or_3_percent_and_sees_every_record_that_it_can)
{
    Settings few = scene_of((const char *const[]){"motion.records=builtin:suite", "sim.duration_s=4", NULL});
    FREED ModelChoice *a = chosen(&few);
    assert_int_equal(a->n_records, 23);
    assert_true(a->n_simulations <= 60 && a->n_cases < 23);
    Settings three = scene_of((const char *const[]){"motion.records=builtin:kobe-like, builtin:sylmar-like", NULL});
    FREED ModelChoice *b = chosen(&three);
    assert_true(b->n_records == 3 && b->n_cases >= 3 && b->n_simulations <= 60);
    Settings many = scene_of((const char *const[]){"motion.records=builtin:kobe-like, builtin:sylmar-like",
                                                   "search.max_evals=4000", "sim.duration_s=3", NULL});
    FREED ModelChoice *c = chosen(&many);
    assert_true(c->n_cases == 9 && c->n_simulations <= 360);
}

TEST(any_number_of_threads_chooses_the_same)
{
    Settings one = scene_of((const char *const[]){"search.threads=1", NULL}), four = one;
    four.search.threads = 4;
    FREED ModelChoice *a = chosen(&one), *b = chosen(&four);
    four.search.threads = 1;
    assert_memory_equal(&one, &four, sizeof one);
    for (size_t i = 0; i < a->ladder.n; i++)
        assert_same_number(a->ladder.effect[i].most, b->ladder.effect[i].most);
    assert_int_equal(a->n_simulations, b->n_simulations);
}

static json_t *model_of(const char *run)
{
    FREED char *text = read_in_place(brief("%s/provenance.json", run));
    json_auto_t *all = json_loads(text, 0, NULL);
    return json_incref(json_object_get(all, "model"));
}

TEST(a_run_keeps_what_it_has_chosen_and_what_goes_on_is_the_run_that_never_stopped)
{
    Settings s = scene_of((const char *const[]){NULL});
    StudySummary summary;
    Status status = STATUS_STOPPED;
    snprintf(s.run.out, sizeof s.run.out, "%s", there("parts"));
    assert_refused(study_run(&s, &(StudyOptions){.stop = stop_after, .user = &(int){3}}, &summary, NULL, &err),
                   STATUS_STOPPED, "stopped before its model was chosen; nothing is stored");
    for (int k = 100; status == STATUS_STOPPED; k += 20)
        status = study_run(&s, &(StudyOptions){.stop = stop_after, .user = &(int){k}}, &summary, NULL, &err);
    CHECK_OK(status, &err);
    free(output_of("optimize @/s.ini --out @/whole"));
    FREED char *a = all_of("whole"), *b = all_of("parts");
    assert_string_equal(a, b);
    json_auto_t *model = model_of("whole");
    assert_less(0, json_array_size(json_object_get(json_object_get(model, "confirmed"), "designs")));
    OWNED(run_free) Run run = run_in("whole");
    assert_string_equal(run.settings->core.foundation,
                        json_string_value(json_object_get(json_object_get(model, "settings"), "core.foundation")));
    expect(65, "building.p_delta is",
           "optimize @/s.ini --out @/whole --set building.p_delta=off --set core.theory=euler_bernoulli");
    expect(65, "sim.model: auto in the run, now given", "optimize @/s.ini --out @/whole --set sim.model=given");
}

/* What the end finds is what simulations of the named designs say, and with it they are within the tolerance. */
TEST(where_a_named_design_needs_more_both_values_and_the_command_are_said)
{
    Ladder l = {.n = 1, .tolerance = {0.02, 0.02, 0.02}};
    Settings s = scene_of((const char *const[]){"core.theory=euler_bernoulli", NULL});
    double X[3][DESIGN_VARIABLES_MAX];
    FREED ModelCase *cases;
    size_t n;
    l.effect[0] = (LadderEffect){
        .words = "shear", .key = "core.theory", .with = "timoshenko", .without = "euler_bernoulli", .most = 1};
    designs_of(&s, X);
    CHECK_OK(model_confirm(&s, 1, 8, X[1], &(Observer){.go_on = never}, &l, &cases, &n, &err), &err);
    assert_int_equal(n, 1);
    assert_true(l.effect[0].is_kept);
    Settings more = s;
    more.core.theory = CORE_TIMOSHENKO;
    assert_same_number(cases[0].by_set.value[MEASURE_J1], simulated(&s, SCENE_IMPACT, X[1]).value[MEASURE_J1]);
    assert_same_number(cases[0].by_more.value[MEASURE_J1], simulated(&more, SCENE_IMPACT, X[1]).value[MEASURE_J1]);
}

/* -- presets ------------------------------------------------------------------------------------------------------- */

static Settings begun(const char *folder)
{
    Settings s = default_settings();
    CHECK_OK(settings_read(&s, there(brief("%s/study.ini", folder)), NULL, NULL, &err), &err);
    return s;
}

/* Six storeys of 3.6 m, 2,340 t, 0.95 s: 0.6 % of 21.6 m are 0.13 m, a seventh 3.1 m; 2 M w / n is 5.16 MN s/m. */
TEST(a_preset_has_the_box_of_its_building_and_what_options_say_comes_before_it)
{
    free(output_of("new @/devices --preset devices --set building.model=@/six"));
    const Settings s = begun("devices");
    assert_int_equal(s.sim.model, MODEL_AUTO);
    assert_close(s.design.gap_m.at[1], 0.13, 1e-12);
    assert_close(s.core.width_m, 3.1, 1e-12);
    assert_true(s.design.link_n_s_m.at[0] == 1.5e5 && s.design.link_n_s_m.at[1] == 1.5e7);
    assert_true(s.design.gap_zones == 5 && s.design.link_zones == 5 && s.design.device_zones == 5);
    assert_string_equal(s.core.foundation, "soil=C radius=3.1 anchors=100");
    assert_true(s.core.stiffeners == 0.25 && s.motion.pga_g == 0 && s.search.max_evals == 300);
    expect_output(": no fault", "check @/devices/study.ini --pga 9");
    free(output_of(
        "new @/stops --preset stops --set building.model=@/six --set core.width_m=4 --set design.gap_m=0.01,0.2"));
    const Settings stops = begun("stops");
    assert_true(stops.core.width_m == 4 && stops.design.gap_m.at[1] == 0.2 && stops.design.device_zones == 0);
}

TEST(every_preset_is_a_study_that_checks)
{
    FOR_EACH (const char *, name, "stops", "devices", "engineer", "risk") {
        free(output_of("new @/of-%s --preset %s --set building.model=@/six --set building.yield_drift=0.01", *name,
                       *name));
        free(output_of("check @/of-%s/study.ini", *name));
    }
}

static void is_same(const char *key, unsigned flags, const char *was, const char *is, void *user)
{
    (void)user;
    if (!(flags & SETTING_FREE))
        fail_msg("%s: %s in configs/kobe.ini, %s by the preset", key, was, is);
}

TEST(the_paper_s_preset_is_configs_kobe_ini)
{
    Settings kobe = default_settings();
    free(output_of("new @/paper --preset paper"));
    const Settings s = begun("paper");
    CHECK_OK(settings_read(&kobe, "configs/kobe.ini", NULL, NULL, &err), &err);
    settings_compare(&kobe, &s, is_same, NULL);
}

TEST(files_that_are_not_there_and_presets_that_are_none_begin_nothing)
{
    expect(66, "motion.record: RECORD.AT2: there is no such file", "new @/no --record RECORD.AT2");
    expect(66, "building.model: ", "new @/no --preset devices --set building.model=@/none");
    expect(2, "--preset: device is no preset; did you mean devices?", "new @/no --preset device");
    assert_int_equal(access(there("no"), F_OK), -1);
    free(output_of("new @/plain"));
    const Settings s = begun("plain");
    assert_int_equal(s.sim.model, MODEL_AUTO);
}

SUITE_FILLED(make_place, make_buildings, clear_place)
