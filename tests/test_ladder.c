/* Which effects a scene needs (analysis/ladder.h): each change against simulations of the settings that are meant, the set
 * against the model with all, and effects of which the answer is known beforehand. */
#include "program.h"

#include "analysis/ladder.h"
#include "towers.h"

enum { N = 5 };

/* Five storeys so soft that their weights matter. */
static void make_building(void)
{
    write_in_place("soft/storeys.csv", "height_m,mass_t,stiffness_kn_m\n4,300,60000\n4,300,50000\n4,300,40000\n"
                                       "4,300,30000\n4,300,20000\n");
}

static Settings scene_of(const char *const sets[])
{
    Settings s = default_settings();
    CHECK_OK(settings_put(&s, "building.model", there("soft"), &err), &err);
    CHECK_OK(settings_set(&s, "core.width_m=5", &err), &err);
    CHECK_OK(settings_set(&s, "motion.record=builtin:sylmar-like", &err), &err);
    CHECK_OK(settings_set(&s, "motion.pga_g=0.3", &err), &err);
    CHECK_OK(settings_set(&s, "sim.duration_s=8", &err), &err);
    for (; *sets; sets++)
        CHECK_OK(settings_set(&s, *sets, &err), &err);
    return s;
}

static void design_with(double gap, double x[N + 2])
{
    for (int j = 0; j < N; j++)
        x[j] = gap * (j + 1);
    x[N] = 0.03;
    x[N + 1] = 0.0216;
}

static Ladder *find(const Settings *s, const double x[], LadderForm form)
{
    Ladder *l = malloc(sizeof *l);
    CHECK_OK(ladder_find(s, x, form, l, &err), &err);
    return l;
}

static const LadderEffect *effect(const Ladder *l, const char *key)
{
    for (size_t i = 0; i < l->n; i++)
        if (strcmp(l->effect[i].key, key) == 0)
            return &l->effect[i];
    return NULL;
}

static SimResult simulated(const Settings *s, const double x[])
{
    return simulated_as(SCENE_IMPACT, s, x);
}

/* The settings with the value that each effect has with it (with[i]) or without. */
static Settings composed(const Settings *s, const Ladder *l, int (*has)(const LadderEffect *e))
{
    Settings out = *s;
    for (size_t i = 0; i < l->n; i++)
        CHECK_OK(
            settings_put(&out, l->effect[i].key, has(&l->effect[i]) ? l->effect[i].with : l->effect[i].without, &err),
            &err);
    return out;
}

static int all_but_steps(const LadderEffect *e)
{
    return strcmp(e->key, "sim.accuracy") != 0;
}

static int kept(const LadderEffect *e)
{
    return e->is_kept;
}

TEST(each_change_is_that_of_two_simulations_and_the_set_is_enough)
{
    double x[N + 2];
    const Settings s = scene_of((const char *const[]){NULL});
    design_with(0.008, x);
    FREED Ladder *l = find(&s, x, LADDER_WHOLE);
    const Settings all = composed(&s, l, all_but_steps);
    const SimResult with = simulated(&all, x);
    assert_same_number(l->value[0], with.j1_m);
    for (size_t i = 0; i < l->n; i++) {
        const LadderEffect *e = &l->effect[i];
        Settings other = all;
        const int is_finer = strcmp(e->key, "sim.accuracy") == 0;
        CHECK_OK(settings_put(&other, e->key, is_finer ? e->with : e->without, &err), &err);
        int exceeds = 0;
        for (int c = 0; c < LADDER_SCENES; c++) {
            const double ratio =
                simulated_as(LADDER_SCENE[c], &other, x).j1_m / simulated_as(LADDER_SCENE[c], &all, x).j1_m;
            assert_less(fabs(e->change[c][0] - ((is_finer ? 1 / ratio : ratio) - 1)), 1e-9);
            for (int k = 0; k < LADDER_MEASURES; k++)
                exceeds |= fabs(e->change[c][k]) > (c == 0 ? l->tolerance[k] : LADDER_TOLERANCE);
        }
        assert_int_equal(e->is_needed, exceeds);
        assert_true(e->is_kept >= e->is_needed);
    }
    assert_less(0, fabs(effect(l, "contact.bumper_stiffness_n_m")->change[0][2])); /* gaps close */
    const Settings set = composed(&s, l, kept);
    const SimResult r = simulated(&set, x);
    assert_at_most(fabs(r.j1_m / with.j1_m - 1), l->tolerance[0]);
    assert_at_most(fabs(r.drift_ratio_max / with.drift_ratio_max - 1), l->tolerance[1]);
    assert_at_most(fabs(r.j3_g / with.j3_g - 1), l->tolerance[2]);
    for (int i = 0; i < LADDER_SCENES; i++) {
        const SimResult scene = simulated_as(LADDER_SCENE[i], &set, x);
        assert_close(l->set[i][0], scene.j1_m, 1e-9);
        assert_close(l->set[i][1], scene.drift_ratio_max, 1e-9);
        assert_close(l->set[i][2], scene.j3_g, 1e-9);
    }
}

TEST(a_brief_ladder_has_the_same_changes_and_verdicts_without_steps_and_costs)
{
    double x[N + 2];
    const Settings s = scene_of((const char *const[]){NULL});
    design_with(0.008, x);
    FREED Ladder *whole = find(&s, x, LADDER_WHOLE), *brief = find(&s, x, LADDER_BRIEF);
    assert_int_equal(brief->n, whole->n - 1);
    assert_true(isnan(brief->all_s) && isnan(brief->set_s));
    for (size_t i = 0; i < brief->n; i++) {
        assert_string_equal(brief->effect[i].key, whole->effect[i].key);
        assert_int_equal(brief->effect[i].is_needed, whole->effect[i].is_needed);
        assert_true(isnan(brief->effect[i].cost_s) && whole->effect[i].cost_s != 0);
        for (int k = 0; k < LADDER_MEASURES; k++)
            assert_close(1 + brief->effect[i].change[0][k], 1 + whole->effect[i].change[0][k], 1e-9);
    }
}

/* Gaps that never close: nothing of the core or its contacts matters, and what is left is the building alone. */
TEST(without_contact_nothing_of_the_core_changes_the_design_or_the_building_alone)
{
    static const char *const OF_CORE[] = {"core.theory", "core.foundation", "contact.bumper_stiffness_n_m"};
    double x[N + 2];
    const Settings s = scene_of((const char *const[]){NULL});
    design_with(9, x);
    FREED Ladder *l = find(&s, x, LADDER_WHOLE);
    for (int i = 0; i < 3; i++) {
        const LadderEffect *e = effect(l, OF_CORE[i]);
        assert_non_null(e);
        for (int c = 0; c < LADDER_SCENES; c++)
            assert_true(LADDER_SCENE[c] == SCENE_RIGID ||
                        fabs(e->change[c][0]) < 1e-5); /* a mat that lifts has steps */
        assert_true(!e->is_needed || LADDER_SCENE[e->decided_in] == SCENE_RIGID);
    }
    assert_true(effect(l, "building.p_delta")->is_needed);
}

TEST(what_the_settings_have_stays_as_they_have_it)
{
    double x[N + 2];
    const Settings s = scene_of(
        (const char *const[]){"core.foundation=rotation=5.5e11", "sim.accuracy=fine", "sim.duration_s=5", NULL});
    design_with(0.008, x);
    FREED Ladder *l = find(&s, x, LADDER_WHOLE);
    const LadderEffect *ground = effect(l, "core.foundation"), *steps = effect(l, "sim.accuracy");
    assert_true(ground->is_set && steps->is_set);
    assert_string_equal(ground->with, "rotation=5.5e11");
    assert_string_equal(steps->without, "standard");
    assert_null(effect(l, "sim.duration_s")); /* the run ends before the strong part does */
}

TEST(a_neighbour_has_no_ground_and_no_beam)
{
    json_t *o = as_json("check configs/neighbours.ini --json --ladder"), *row;
    size_t i;
    json_array_foreach(json_object_get(json_object_get(o, "ladder"), "effects"), i, row)
    {
        const char *key = json_string_value(json_object_get(row, "setting"));
        assert_true(strcmp(key, "core.foundation") != 0 && strcmp(key, "core.theory") != 0);
    }
    assert_true(i >= 4);
    json_decref(o);
}

/* A storey that carries the weight W over its height h keeps k - W/h of k; where all have yielded, 2 % of that stands:
 * the share that yields is 0.98 (1 - W/(h k)) at most. */
TEST(the_hardening_that_p_delta_raises_is_said)
{
    static const double STIFFNESS[N] = {6e7, 5e7, 4e7, 3e7, 2e7}, HEIGHT = 4, MASS = 3e5;
    double x[N + 2], wanted = 0.05;
    for (int j = 0; j < N; j++)
        wanted = fmax(wanted, 1 - 0.98 * (1 - (N - j) * MASS * 9.81 / (HEIGHT * STIFFNESS[j])));
    assert_less(0.06, wanted);
    const Settings s = scene_of((const char *const[]){NULL});
    design_with(0.008, x);
    FREED Ladder *l = find(&s, x, LADDER_BRIEF);
    assert_close(l->hardening, wanted, 1e-6);
}

TEST(a_scatter_as_built_above_the_tolerance_takes_its_place)
{
    double x[N + 2];
    const Settings s = scene_of((const char *const[]){"sim.replicates=2", "sim.gap_tolerance_m=0.03", NULL});
    design_with(0.008, x);
    FREED Ladder *l = find(&s, x, LADDER_WHOLE);
    assert_less(LADDER_TOLERANCE, l->tolerance[0]);
    assert_less(LADDER_TOLERANCE, l->tolerance[2]);
}

TEST(the_command_prints_the_ladder_and_refuses_it_where_there_is_no_tower)
{
    json_auto_t *o =
        as_json("check configs/quick.ini --json --ladder --set building.model=@/soft --set sim.duration_s=12");
    const json_t *ladder = json_object_get(o, "ladder");
    assert_true(json_array_size(json_object_get(ladder, "effects")) >= 6);
    const char *theory = json_string_value(json_object_get(json_object_get(ladder, "settings"), "core.theory"));
    assert_true(strcmp(theory, "timoshenko") == 0 || strcmp(theory, "euler_bernoulli") == 0);
    assert_less(0, number(json_object_get(json_object_get(ladder, "by_the_set"), "rigid"), "j1_m"));
    expect_output(": no fault", "check configs/engineer.ini");
    expect(65, "--ladder: problem.kind is not tower",
           "check configs/quick.ini --ladder --set problem.kind=external --set problem.command=true");
}

/* Links hold the tower so well that its storeys stay elastic; alone they yield, so that the comparison needs it. */
TEST(an_effect_is_needed_where_only_the_building_alone_needs_it_and_the_set_has_all_three_scenes)
{
    double x[3] = {10, 0.03, 4e6};
    const Settings s = scene_of((const char *const[]){
        "design.variables=gaps,thickness,links", "design.gap_zones=1", "design.link_zones=1",
        "design.link_n_s_m=1e3,1e8", "design.thickness_m=0.01,0.05", "search.objectives=j1_m,ductility",
        "building.yield_drift=0.01", "motion.pga_g=0.5", NULL});
    double design[4] = {x[0], x[1], x[1], x[2]};
    FREED Ladder *l = find(&s, design, LADDER_WHOLE);
    const LadderEffect *yielding = effect(l, "building.yield_drift");
    assert_less(fabs(yielding->change[0][0]), LADDER_TOLERANCE);
    assert_true(yielding->is_needed);
    assert_int_equal(LADDER_SCENE[yielding->decided_in], SCENE_NO_CORE);
    const Settings all = composed(&s, l, all_but_steps);
    for (int c = 0; c < LADDER_SCENES; c++) {
        const SimResult with = simulated_as(LADDER_SCENE[c], &all, design);
        assert_at_most(fabs(l->set[c][0] / with.j1_m - 1), LADDER_TOLERANCE);
    }
}

SUITE_FILLED(make_place, make_building, clear_place)
