/* Core modes that the engine leaves out act as springs: results hardly depend on how many are left out. */
#include "bench/promise.h"
#include "scene_options.h"
#include "sim/fast/fast.h"

enum { WINDOWS = 11, RESULTS = 3 };

typedef struct {
    Building b;
    CoreBeam core;
    SimModel model;
    FastWork *work;
} Stage;

static void stage_open(Stage *t, const SceneOptions *o)
{
    CHECK_OK(building_load(&t->b, &o->building, &err), &err);
    CHECK_OK(model_create(&t->model, t->b.n, t->b.model.n, &err), &err);
    CHECK_OK(fast_create(&t->work, t->b.n, t->b.model.n, 0, 0, &err), &err);
}

static void stage_close(Stage *t)
{
    fast_free(t->work);
    model_free(&t->model);
    building_free(&t->b);
}

static void stage_set(Stage *t, const SceneOptions *options, const PromiseCase *c)
{
    SceneOptions o = *options;
    o.core.theory = c->theory;
    CHECK_OK(core_beam_make(&t->core, &o.core, t->b.n, t->b.storey_m, c->x[t->b.n], c->x[t->b.n + 1], &err), &err);
    CHECK_OK(model_set(&t->model, &o, &t->b, &t->core, c->x, &err), &err);
}

/* core_modes 0: as many as the flexibility says. */
static SimResult run_with(Stage *t, const PromiseCase *c, double flexibility, int core_modes)
{
    SimResult r;
    FastTolerances tolerances = fast_tolerances(ACCURACY_STANDARD);
    tolerances.flexibility_left_out = flexibility;
    tolerances.core_modes = core_modes;
    fast_run(t->work, &t->model, &c->motion, &(EngineOptions){.duration = c->duration}, &tolerances, &r);
    return r;
}

TEST(few_core_modes_and_springs_give_what_all_modes_give)
{
    static const double ALLOWED[RESULTS] = {3e-5, 2e-4, 1e-3}; /* without the springs 1e-4, 1e-3, 2e-3 */
    const SceneOptions o = paper_scene();
    double error[RESULTS][WINDOWS];
    OWNED(stage_close) Stage t;
    OWNED(motion_free) Motion m = motion_of("builtin:kobe-like", 0.3, 3.1);
    const PromisePlan plan = {.options = &o, .records = &m, .n_records = 1, .n_scenes = WINDOWS};
    stage_open(&t, &o);
    for (int k = 0; k < WINDOWS; k++) {
        PromiseCase c;
        double each[BENCH_OBJECTIVES];
        CHECK_OK(promise_case(&plan, 20, GAPS_LOG_UNIFORM, k, &c, &err), &err);
        stage_set(&t, &o, &c);
        const SimResult all = run_with(&t, &c, 0, 0), few = run_with(&t, &c, 0.1, 0);
        assert_true(few.outcome == RUN_OK && few.energy_balance_error < 3e-4);
        assert_less(few.steps, 1.1 * (double)all.steps);
        result_errors(&few, &all, each);
        for (int i = 0; i < RESULTS; i++)
            error[i][k] = each[i];
        motion_free(&c.motion);
    }
    for (int i = 0; i < RESULTS; i++) {
        const double median = bench_median(WINDOWS, error[i]);
        print_message("%s: median %.1e\n", BENCH_OBJECTIVE_NAMES[i], median);
        assert_at_most(median, ALLOWED[i]);
    }
}

TEST(so_many_core_modes_are_kept_as_are_asked_for)
{
    const SceneOptions o = paper_scene();
    OWNED(stage_close) Stage t;
    PromiseCase c;
    OWNED(motion_free) Motion m = motion_of("builtin:kobe-like", 0.3, 3.1);
    const PromisePlan plan = {.options = &o, .records = &m, .n_records = 1, .n_scenes = 1};
    CHECK_OK(promise_case(&plan, 20, GAPS_LOG_UNIFORM, 0, &c, &err), &err);
    stage_open(&t, &o);
    stage_set(&t, &o, &c);
    const SimResult all = run_with(&t, &c, 0, 0), twenty = run_with(&t, &c, 0.1, 20), more = run_with(&t, &c, 0.1, 99);
    const SimResult two = run_with(&t, &c, 0, 2), six = run_with(&t, &c, 0, 6);
    assert_true(twenty.j3_g == all.j3_g && twenty.steps == all.steps && more.j3_g == all.j3_g);
    motion_free(&c.motion);
    assert_less(2 * fabs(six.edcs_pct / all.edcs_pct - 1), fabs(two.edcs_pct / all.edcs_pct - 1));
}

SUITE(NULL, NULL)
