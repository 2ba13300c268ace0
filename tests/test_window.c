/* Before the horizon: what `fast` promises of its accuracies, against CVODE, which shares no code with it. */
#include "bench/timed_run.h"
#include "motion/motion_read.h"
#include "scene_options.h"

typedef struct {
    const char *record, *building;
    CoreSection section;
    uint32_t gaps; /* of the fixed stream of irregular gaps */
    double smaller, stretch, seconds;
    double bumper; /* [N/m] */
} Window;

/* Both towers of twenty floors, and what cvode takes a tenth of the time for: six. */
static const char SIX[] = "configs/neighbours/tower";
static const Window WINDOWS[] = {{"builtin:kobe-like", "guyan", CORE_BOX, 3, 1, 3.1, 2.5, 0},
                                 {"builtin:kobe-like", "appendix", CORE_EFFECTIVE, 9, 0.2, 1.0, 1.4, 0},
                                 {"builtin:elcentro-like", SIX, CORE_BOX, 5, 0.05, 1.0, 1.75, 0},
                                 {"builtin:sylmar-like", SIX, CORE_EFFECTIVE, 7, 0.05, 1.0, 2, 0},
                                 {"builtin:elcentro-like", SIX, CORE_BOX, 11, 0.02, 1.0, 1.75, 0}};

/* Of four decades of stiffness. */
static const Window WITH_BUMPERS[] = {{"builtin:kobe-like", SIX, CORE_BOX, 3, 0.05, 1.0, 1.75, 1e10},
                                      {"builtin:elcentro-like", SIX, CORE_BOX, 5, 0.05, 1.0, 1.75, 1e9},
                                      {"builtin:kobe-like", SIX, CORE_EFFECTIVE, 9, 0.05, 1.0, 1.75, 1e8},
                                      {"builtin:elcentro-like", SIX, CORE_BOX, 11, 0.02, 1.0, 2, 1e7}};

/* J1, J2, J3, shares of mode 1, modes 5 to 10, the core */
static const double FINE = 1e-4, STANDARD[BENCH_OBJECTIVES] = {1e-3, 3e-3, 1e-2, 1e-2, 1e-2, 1e-2};

static void open_window(const Window *w, SceneOptions *s, Motion *m, BenchCase *bench_case)
{
    *s = paper_scene();
    if (w->building == SIX)
        six_floors(&s->building, &s->core);
    else
        snprintf(s->building.model, sizeof s->building.model, "%s", w->building);
    s->core.section = w->section;
    s->contact.bumper_stiffness_n_m = w->bumper;
    CHECK_OK(motion_load(m, w->record, UNIT_FROM_FILE, &err), &err);
    CHECK_OK(motion_prepare(m, 0.3, w->stretch, &err), &err);
    CHECK_OK(bench_case_open(bench_case, bench_kind(2), s, m, 0, &err), &err);
    bench_irregular_gaps(w->gaps, bench_case->building.n, bench_case->gaps);
    for (int j = 0; j < bench_case->building.n; j++)
        bench_case->gaps[j] *= w->smaller;
    CHECK_OK(model_set(&bench_case->model, s, &bench_case->building, bench_case->core, bench_case->gaps, &err), &err);
    bench_case->duration = w->seconds;
}

static SimResult run(const BenchCase *c, Engine engine, Accuracy accuracy)
{
    SimResult r;
    const EngineOptions options = {.duration = c->duration, .accuracy = accuracy};
    CHECK_OK(engine_entry(engine)->run(&c->model, &c->motion, &options, &r, &err), &err);
    assert_ran(&r);
    return r;
}

/* Each window by cvode, by `fast` at fine, and at standard accuracy: their errors are as promised. */
static void compare_accuracies(size_t n, const Window windows[])
{
    for (size_t i = 0; i < n; i++) {
        SceneOptions s;
        OWNED(motion_free) Motion m;
        OWNED(bench_case_close) BenchCase c;
        double f[BENCH_OBJECTIVES], e[BENCH_OBJECTIVES];
        open_window(&windows[i], &s, &m, &c);
        const SimResult reference = run(&c, ENGINE_CVODE, ACCURACY_FINE), fine = run(&c, ENGINE_FAST, ACCURACY_FINE),
                        standard = run(&c, ENGINE_FAST, ACCURACY_STANDARD);
        result_errors(&fine, &reference, f);
        result_errors(&standard, &reference, e);
        print_message("%s, %s, bumper %g: %ld impacts; standard J1 %.1e J2 %.1e J3 %.1e shares %.1e %.1e %.1e\n",
                      windows[i].record, windows[i].building, windows[i].bumper, reference.impacts, e[0], e[1], e[2],
                      e[3], e[4], e[5]);
        assert_at_most(20, reference.impacts);
        for (int k = 0; k < BENCH_OBJECTIVES; k++) {
            assert_at_most(f[k], FINE);
            assert_at_most(e[k], STANDARD[k]);
        }
    }
}

TEST(fine_and_standard_accuracy_are_what_they_promise)
{
    compare_accuracies(N_OF(WINDOWS), WINDOWS);
}

TEST(fine_and_standard_accuracy_are_what_they_promise_beside_bumpers)
{
    compare_accuracies(N_OF(WITH_BUMPERS), WITH_BUMPERS);
}

TEST(peaks_of_a_stiff_building_beside_a_core_are_those_of_fine_accuracy)
{
    for (int stiffer = 5; stiffer <= 80; stiffer *= 4) {
        SceneOptions s;
        OWNED(motion_free) Motion m;
        OWNED(bench_case_close) BenchCase c;
        double e[BENCH_OBJECTIVES];
        open_window(&(Window){"builtin:elcentro-like", "guyan", CORE_BOX, 1, 1, 1.0, 6, 0}, &s, &m, &c);
        for (int i = 0; i < c.model.m; i++) {
            c.model.omega[i] *= stiffer;
            c.model.zeta[i] = 0.005;
        }
        const SimResult fine = run(&c, ENGINE_FAST, ACCURACY_FINE), standard = run(&c, ENGINE_FAST, ACCURACY_STANDARD);
        result_errors(&standard, &fine, e);
        print_message("%d times as stiff: %ld impacts, J1 %.1e J2 %.1e J3 %.1e\n", stiffer * stiffer, fine.impacts,
                      e[0], e[1], e[2]);
        for (int k = 0; k < 3; k++)
            assert_at_most(e[k], STANDARD[k]);
    }
}

SUITE(NULL, NULL)
