/* Before the horizon: what `fast` promises of its accuracies, against CVODE, which shares no code with it. */
#include "check.h"

#include <stdlib.h>
#include <string.h>

#include "bench/timed_run.h"
#include "motion/motion_read.h"
#include "motion/motion_scale.h"
#include "scene_options.h"

typedef struct {
    const char *record, *building;
    CoreSection section;
    uint32_t gaps; /* of the fixed stream of irregular gaps */
    double smaller, stretch, seconds;
    double bumper; /* [N/m] */
} Window;

static const Window WINDOWS[] = {
    {"builtin:kobe-like", "guyan", CORE_BOX, 3, 1, 3.1, 5, 0},
    {"builtin:elcentro-like", "appendix", CORE_BOX, 5, 0.5, 2.0, 5, 0},
    {"builtin:sylmar-like", "guyan", CORE_EFFECTIVE, 7, 0.3, 3.0, 4, 0},
    {"builtin:kobe-like", "appendix", CORE_EFFECTIVE, 9, 0.2, 1.0, 3, 0},
    {"builtin:elcentro-like", "guyan", CORE_BOX, 11, 0.1, 4.0, 4, 0},
    {"builtin:kobe-like", "guyan", CORE_BOX, 3, 1, 3.1, 5, 1e10},
    {"builtin:elcentro-like", "appendix", CORE_BOX, 5, 0.5, 2.0, 5, 1e9},
    {"builtin:kobe-like", "guyan", CORE_EFFECTIVE, 9, 0.2, 1.0, 3, 1e8},
    {"builtin:elcentro-like", "guyan", CORE_BOX, 11, 0.1, 4.0, 4, 1e7},
};
enum { WINDOWS_N = SANITIZED ? 1 : sizeof WINDOWS / sizeof WINDOWS[0], STIFFEST = SANITIZED ? 5 : 80 };

/* J1, J2, J3, shares of mode 1, modes 5 to 10, the core */
static const double FINE = 1e-4, STANDARD[BENCH_OBJECTIVES] = {1e-3, 3e-3, 1e-2, 1e-2, 1e-2, 1e-2};

static void open_window(const Window *w, SceneOptions *s, Motion *m, BenchCase *bench_case)
{
    Err err;
    *s = paper_scene();
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

TEST(fine_and_standard_accuracy_are_what_they_promise)
{
    static TimedRun reference, fine, standard;
    for (int i = 0; i < WINDOWS_N; i++) {
        SceneOptions s;
        Motion m;
        BenchCase bench_case;
        Err err;
        open_window(&WINDOWS[i], &s, &m, &bench_case);
        CHECK_OK(timed_run(&bench_case, ENGINE_CVODE, ACCURACY_FINE, 0, &reference, &err), &err);
        CHECK_OK(timed_run(&bench_case, ENGINE_FAST, ACCURACY_FINE, 0, &fine, &err), &err);
        CHECK_OK(timed_run(&bench_case, ENGINE_FAST, ACCURACY_STANDARD, 0, &standard, &err), &err);
        const RunErrors f = run_errors(&bench_case, &fine, &reference),
                        e = run_errors(&bench_case, &standard, &reference);
        print_message(
            "%s, %s, bumper %g: %ld impacts; fine %.1e; standard J1 %.1e J2 %.1e J3 %.1e shares %.1e %.1e %.1e\n",
            WINDOWS[i].record, WINDOWS[i].building, WINDOWS[i].bumper, reference.result.impacts, f.objectives,
            e.each[0], e.each[1], e.each[2], e.each[3], e.each[4], e.each[5]);
        assert_true(reference.result.outcome == RUN_OK && reference.result.impacts >= 20);
        assert_at_most(f.objectives, FINE);
        for (int k = 0; k < BENCH_OBJECTIVES; k++)
            assert_at_most(e.each[k], STANDARD[k]);
        bench_case_close(&bench_case);
        motion_free(&m);
    }
}

TEST(peaks_of_a_stiff_building_beside_a_core_are_those_of_fine_accuracy)
{
    static TimedRun fine, standard;
    for (int stiffer = 5; stiffer <= STIFFEST; stiffer *= 4) {
        SceneOptions s;
        Motion m;
        BenchCase bench_case;
        Err err;
        open_window(&(Window){"builtin:elcentro-like", "guyan", CORE_BOX, 1, 1, 1.0, 6, 0}, &s, &m, &bench_case);
        for (int i = 0; i < bench_case.model.m; i++) {
            bench_case.model.omega[i] *= stiffer;
            bench_case.model.zeta[i] = 0.005;
        }
        CHECK_OK(timed_run(&bench_case, ENGINE_FAST, ACCURACY_FINE, 0, &fine, &err), &err);
        CHECK_OK(timed_run(&bench_case, ENGINE_FAST, ACCURACY_STANDARD, 0, &standard, &err), &err);
        const RunErrors e = run_errors(&bench_case, &standard, &fine);
        print_message("%d times as stiff: %ld impacts, J1 %.1e J2 %.1e J3 %.1e\n", stiffer * stiffer,
                      fine.result.impacts, e.each[0], e.each[1], e.each[2]);
        for (int k = 0; k < 3; k++)
            assert_at_most(e.each[k], STANDARD[k]);
        bench_case_close(&bench_case);
        motion_free(&m);
    }
}

SUITE(NULL, NULL)
