/* Every engine against the fast one at its finest, and against the rebound of an isolated
 * impact, each to the accuracy that its tolerance is known to give. */
#include "bench/stability/bob.h"

#include "bench/engines/engines.h"
#include "scene_options.h"

/* What an engine owes at a tolerance: relative error of the objectives in a window with impacts, open books, and the
 * relative error of the loss in an isolated impact. */
typedef struct {
    int engine;
    double tolerance, objectives, books, loss;
} Promise;

static const Promise PROMISES[] = {
    {ENGINE_FAST, 20, 1e-4, 1e-5, 3e-4},        {ENGINE_CVODE, 1e-9, 1e-5, 1e-6, 1e-6},
    {ENGINE_CVODE_BDF, 1e-5, 2e-2, 3e-3, 3e-3}, {ENGINE_ARKODE_IMEX, 1e-5, 1e-3, 3e-5, 3e-3},
    {ENGINE_ETDRK4, 1e-4, 1e-4, 1e-4, 5e-4},    {ENGINE_NEWMARK, 1e-4, 3e-4, 3e-5, 3e-4},
    {ENGINE_RADAU, 2e-4, 3e-4, 1e-5, 1e-5}};
enum { N_PROMISES = sizeof PROMISES / sizeof PROMISES[0] };

static SimResult run(const Promise *p, const SimModel *model, const Motion *m, double duration)
{
    SimResult r;
    const EngineOptions options = {.duration = duration, .accuracy = ACCURACY_FINE, .tolerance = p->tolerance};
    CHECK_OK(bench_engine(p->engine)->run(model, m, &options, &r, &err), &err);
    assert_ran(&r);
    return r;
}

static double worst_of(const SimResult *r, const SimResult *wanted)
{
    const double pairs[][2] = {{r->j1_m, wanted->j1_m},
                               {r->j2_m, wanted->j2_m},
                               {r->j3_g, wanted->j3_g},
                               {r->ed1_pct, wanted->ed1_pct},
                               {r->ed5_10_pct, wanted->ed5_10_pct},
                               {r->edcs_pct, wanted->edcs_pct},
                               {r->indentation_max_m, wanted->indentation_max_m}};
    double worst = 0;
    for (size_t i = 0; i < sizeof pairs / sizeof pairs[0]; i++)
        worst = fmax(worst, fabs(pairs[i][0] / pairs[i][1] - 1));
    return worst;
}

static const char *const LAWS[] = {CONTACT_LAW_LIST(CHOICE_WORD)};
enum { N_LAWS = sizeof LAWS / sizeof LAWS[0] };

/* 0.8 s of two sines, sampled every 50 ms; gaps of 2 mm j. Returns how many of n engines miss what they owe. */
static int misses_under(ContactLaw law, int n, const Promise promises[])
{
    static CoreBeam core;
    SceneOptions s = paper_scene();
    OWNED(building_free) Building b;
    OWNED(model_free) SimModel model;
    double gaps[FLOORS_MAX], accel[21];
    const Motion m = {.accel = accel, .n = 21, .dt_s = 0.05};
    s.core.section = CORE_EFFECTIVE;
    s.contact.law = law;
    for (int k = 0; k < 21; k++)
        accel[k] = 3 * sin(2.5 * 0.05 * k) + 2 * sin(8.2 * 0.05 * k);
    CHECK_OK(load_model(&b, "guyan", &err), &err);
    CHECK_OK(make_core_of(&core, &s, b.n, 1, 1, &err), &err);
    for (int j = 0; j < b.n; j++)
        gaps[j] = 0.002 * (j + 1);
    CHECK_OK(model_create(&model, b.n, b.n, &err), &err);
    CHECK_OK(model_set(&model, &s, &b, &core, gaps, &err), &err);
    const SimResult wanted = run(&(Promise){.engine = ENGINE_FAST, .tolerance = 200}, &model, &m, 0.8);
    assert_less(5, wanted.impacts);
    int broken = 0;
    for (const Promise *p = promises; p < promises + n; p++) {
        const SimResult r = run(p, &model, &m, 0.8);
        const double worst = worst_of(&r, &wanted);
        print_message("%-20s %-12s %-8g objectives %.1e (%.0e)  books %.1e (%.0e)  impacts %ld\n", LAWS[law],
                      bench_engine(p->engine)->name, p->tolerance, worst, p->objectives, r.energy_balance_error,
                      p->books, r.impacts);
        broken += !(worst <= p->objectives && r.energy_balance_error <= p->books);
    }
    return broken;
}

TEST(every_engine_agrees_with_the_fast_one_where_there_are_impacts)
{
    assert_int_equal(misses_under(LAW_PAPER, N_PROMISES, PROMISES), 0);
}

TEST(engines_agree_under_every_law)
{
    static const Promise UNRELATED[] = {
        {ENGINE_FAST, 20, 1e-4, 1e-5, 0}, {ENGINE_CVODE, 1e-9, 1e-5, 1e-6, 0}, {ENGINE_ETDRK4, 5e-5, 2e-4, 1e-4, 0}};
    for (int law = LAW_PAPER + 1; law < N_LAWS; law++)
        assert_int_equal(misses_under((ContactLaw)law, 3, UNRELATED), 0);
}

/* One free mass, one free core mass at rest. A triangular pulse of 2 s brings the mass to 1 m/s and 1 m; it has passed
 * the remaining half metre and closes the gap at t = 2.5 s. The core does not feel the ground (gamma = 0). */
static const double MASS = 1e5, CORE_MASS = 3e5, REDUCED = 0.75e5;

static SimModel pair_of_masses(double a)
{
    SimModel model;
    bobs_model(&model, 1, &(Bob){.mass = MASS, .gap = 1.5}, CORE_MASS,
               &(Contact){.k = 4.8650e10, .a = a, .v0_floor = 1e-3});
    return model;
}

/* lost = m v^2 (1 - e^2) / 2 with the reduced mass m, and e from a (1+e) = ln((1+a)/(1-a e)). */
TEST(every_engine_loses_in_an_isolated_impact_what_the_law_says)
{
    double pulse[] = {0, -1, 0};
    const Motion m = {.accel = pulse, .n = 3, .dt_s = 1};
    OWNED(model_free) SimModel model = pair_of_masses(0.45);
    const double e = contact_rebound(0.45), lost = 0.5 * REDUCED * (1 - e * e);
    int broken = 0;
    for (int i = 0; i < N_PROMISES; i++) {
        const Promise *p = &PROMISES[i];
        const SimResult r = run(p, &model, &m, 2.6);
        const double error = fabs(r.contact_loss_j / lost - 1);
        print_message("%-20s %-8g loss %.1e (%.0e)  impacts %ld\n", bench_engine(p->engine)->name, p->tolerance, error,
                      p->loss, r.impacts);
        broken += !(error <= p->loss && r.impacts == 1);
    }
    assert_int_equal(broken, 0);
}

TEST(every_engine_is_listed_under_its_name)
{
    static const char *const NAMES[] = {
#define X(upper, lower, ...) #lower,
        ENGINE_LIST(CHOICE_WORD) REFERENCE_ENGINES(X)
#undef X
    };
    assert_int_equal(N_PROMISES, BENCH_ENGINES);
    for (int k = 0; k < BENCH_ENGINES; k++) {
        assert_string_equal(bench_engine(k)->name, NAMES[k]);
        assert_int_equal(bench_engine_named(NAMES[k]), k);
        assert_true(bench_engine(k)->run != NULL);
    }
}

SUITE(NULL, NULL)
