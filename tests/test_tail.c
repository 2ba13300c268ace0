/* The end of a run: what is left of a motion is known beforehand, and contacts end where it can change nothing. */
#include "bench/case.h"
#include "scene_options.h"
#include "sim/tail.h"

static Motion kobe_like(void)
{
    return motion_of("builtin:kobe-like", 0.3, 3.1);
}

TEST(what_is_left_of_a_motion_is_what_it_gives_to_the_building_at_rest)
{
    const SceneOptions o = paper_scene();
    OWNED(motion_free) Motion m = kobe_like();
    OWNED(building_free) Building b;
    FREED double *input = malloc(m.n * sizeof *input);
    CHECK_OK(building_load(&b, &o.building, &err), &err);
    CHECK_OK(tail_input(&b.model, &m, input, &err), &err);
    double most = 0;
    for (size_t k = m.n - 1; k-- > 0;) {
        const double above = input[k] - input[k + 1];
        assert_at_most(0, above);
        if (k % 97 || above == 0) /* above 0: the largest so far, and so that of sample k itself */
            continue;
        const Motion rest = {.accel = m.accel + k, .n = m.n - k, .dt_s = m.dt_s};
        const SimResult r = run_once(&o, &rest, SCENE_NO_CORE, NULL);
        assert_close(input[k], r.input_energy_j, 1e-9);
        most = fmax(most, input[k]);
    }
    assert_less(0, most);
}

TEST(contacts_end_where_they_can_change_nothing)
{
    SceneOptions o = paper_scene(), never = o;
    OWNED(motion_free) Motion m = kobe_like();
    const double length = (double)(m.n - 1) * m.dt_s;
    never.sim.accuracy = o.sim.accuracy = ACCURACY_STANDARD;
    double x[FLOORS_MAX + 2], earliest = length;
    for (uint32_t design = 0; design < 6; design++) {
        bench_irregular_gaps(design, 20, x);
        x[20] = BENCH_WALL_BASE;
        x[21] = BENCH_WALL_TOP;
        const SimResult r = run_once(&o, &m, SCENE_IMPACT, x);
        never.sim.duration_s = r.settled_s; /* nothing but contacts until then */
        const SimResult s = run_once(&never, &m, SCENE_IMPACT, x);
        print_message("design %u: settled at %.0f of %.0f s, %ld impacts\n", design, r.settled_s, length, r.impacts);
        assert_true(r.outcome == RUN_OK && r.settled_s <= length);
        assert_int_equal(r.impacts, s.impacts);
        assert_true(r.j1_m == s.j1_m && r.j2_m == s.j2_m && r.j3_g == s.j3_g);
        const double least = fmin(fmin(s.ed1_pct, s.ed5_10_pct), s.edcs_pct) / 100 * s.input_energy_j;
        assert_at_most(s.kinetic_strain_j, 0.04 * least); /* the tail share of standard */
        assert_close(r.contact_loss_j, s.contact_loss_j, 1e-15);
        earliest = fmin(earliest, r.settled_s);
    }
    assert_less(earliest, 0.9 * length);
}

/* By the engine alone, contacts followed to the end or not. */
static SimResult run_engine(const SimModel *model, const Motion *m, const double *input)
{
    const EngineOptions options = {
        .duration = (double)(m->n - 1) * m->dt_s, .accuracy = ACCURACY_STANDARD, .tail_input = input};
    SimResult r;
    CHECK_OK(engine_fast(model, m, &options, &r, &err), &err);
    return r;
}

TEST(a_run_without_its_end_has_the_peaks_and_nearly_the_shares_of_the_whole)
{
    const SceneOptions o = paper_scene();
    OWNED(motion_free) Motion m = kobe_like();
    OWNED(building_free) Building b;
    CoreBeam core;
    OWNED(model_free) SimModel model;
    FREED double *input = malloc(m.n * sizeof *input);
    double x[FLOORS_MAX];
    CHECK_OK(building_load(&b, &o.building, &err), &err);
    CHECK_OK(model_create(&model, b.n, b.model.n, &err), &err);
    CHECK_OK(tail_input(&b.model, &m, input, &err), &err);
    CHECK_OK(core_beam_make(&core, &o.core, b.n, b.storey_m, BENCH_WALL_BASE, BENCH_WALL_TOP, &err), &err);
    for (uint32_t design = 0; design < 6; design++) {
        bench_irregular_gaps(design, b.n, x);
        CHECK_OK(model_set(&model, &o, &b, &core, x, &err), &err);
        const SimResult ended = run_engine(&model, &m, input), whole = run_engine(&model, &m, NULL);
        assert_less(ended.settled_s, whole.settled_s);
        assert_true(ended.j1_m == whole.j1_m && ended.j2_m == whole.j2_m && ended.j3_g == whole.j3_g);
        assert_close(ended.input_energy_j, whole.input_energy_j, 1e-3);
        assert_close(ended.ed1_pct, whole.ed1_pct, 3e-3); /* a third of the promise */
        assert_close_in(ended, whole, 5e-3, ed5_10_pct, edcs_pct);
    }
}

TEST(a_motion_that_ends_between_two_samples_ends_without_contacts_as_well)
{
    SceneOptions o = paper_scene();
    OWNED(motion_free) Motion m = kobe_like();
    double x[FLOORS_MAX + 2];
    bench_irregular_gaps(0, 20, x);
    for (int j = 10; j < 20; j++) /* floors lie in the core where contacts have ended */
        x[j] = 0.005;
    x[20] = BENCH_WALL_BASE;
    x[21] = BENCH_WALL_TOP;
    const SimResult whole = run_once(&o, &m, SCENE_IMPACT, x);
    assert_less(whole.settled_s, 0.9 * (double)(m.n - 1) * m.dt_s);
    for (int i = 0; i < 6; i++) { /* anywhere in a period of the first mode */
        o.sim.duration_s = ((double)(m.n - 1) - 10 * i - 0.3) * m.dt_s;
        const SimResult r = run_once(&o, &m, SCENE_IMPACT, x);
        assert_int_equal(r.impacts, whole.impacts);
        assert_same_number(r.j1_m, whole.j1_m);
        assert_same_number(r.j3_g, whole.j3_g);
    }
}

TEST(at_fine_accuracy_contacts_are_followed_to_the_end)
{
    SceneOptions o = paper_scene();
    OWNED(motion_free) Motion m = kobe_like();
    double x[FLOORS_MAX + 2];
    bench_irregular_gaps(1, 20, x);
    x[20] = BENCH_WALL_BASE;
    x[21] = BENCH_WALL_TOP;
    o.sim.accuracy = ACCURACY_FINE;
    m.n = m.n / 3;
    const SimResult r = run_once(&o, &m, SCENE_IMPACT, x);
    assert_close(r.settled_s, (double)(m.n - 1) * m.dt_s, 1e-12);
}

TEST(shares_of_no_net_input_are_undefined)
{
    const SceneOptions o = paper_scene();
    double accel[50] = {0};
    const Motion still = {.accel = accel, .n = 50, .dt_s = 0.02, .name = "still"};
    const SimResult r = run_once(&o, &still, SCENE_NO_CORE, NULL);
    assert_true(r.j1_m == 0 && r.input_energy_j == 0);
    assert_true(isnan(r.ed1_pct) && isnan(r.ed5_10_pct) && isnan(r.edcs_pct));
}

SUITE(NULL, NULL)
