#include "bench/case.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static const double OPEN_GAP = 10; /* [m] no response of this building reaches it */

static const BenchKind KINDS[N_BENCH_KINDS] = {
    {"linear", 10}, {"one-impact", 10}, {"irregular", 8}, {"tiny", 2}, {"zero", 2}};

const BenchKind *bench_kind(int k)
{
    return &KINDS[k];
}

void bench_irregular_gaps(uint32_t design, int n, double gaps[])
{
    Random r = random_stream(1, RANDOM_TEST, 0, design);
    for (int j = 0; j < n; j++)
        gaps[j] = 0.01 + 0.19 * random_uniform(&r);
}

Motion bench_window(const Motion *whole, double *start_s)
{
    const double wanted = 0.3 * motion_peak(whole);
    size_t first = 0;
    while (first + 2 < whole->n && fabs(whole->accel[first]) < wanted)
        first++;
    const size_t back = (size_t)ceil(1 / whole->dt_s);
    first = first > back ? first - back : 0;
    Motion window = *whole;
    window.accel += first;
    window.n -= first;
    *start_s = (double)first * whole->dt_s;
    return window;
}

static Status set_model(BenchCase *bench_case, const SceneOptions *s, Err *err)
{
    return model_set(&bench_case->model, s, &bench_case->building, bench_case->core, bench_case->gaps, err);
}

/* Impacts when only the middle floor can touch, at this gap. */
static Status count_impacts(BenchCase *bench_case, const SceneOptions *s, double gap, long *impacts, Err *err)
{
    const EngineOptions options = {.duration = bench_case->duration, .accuracy = ACCURACY_FINE};
    SimResult r;
    bench_case->gaps[bench_case->building.n / 2] = gap;
    TRY(set_model(bench_case, s, err));
    TRY(engine_fast(&bench_case->model, &bench_case->motion, &options, &r, err));
    *impacts = r.impacts;
    return STATUS_OK;
}

/* The middle floor's gap a little short of the largest that closes, so that it closes once. */
static Status find_one_impact(BenchCase *bench_case, const SceneOptions *s, Err *err)
{
    double closes = 0, open = OPEN_GAP;
    long impacts;
    for (int k = 0; k < 30; k++) {
        const double middle = 0.5 * (closes + open);
        TRY(count_impacts(bench_case, s, middle, &impacts, err));
        *(impacts > 0 ? &closes : &open) = middle;
    }
    for (double share = 0.9; share < 0.99999; share = 0.5 * (1 + share)) {
        TRY(count_impacts(bench_case, s, share * closes, &impacts, err));
        if (impacts == 1)
            return STATUS_OK;
    }
    return fail(err, STATUS_INTERNAL, "bench: no gap of the middle floor closes exactly once");
}

static void set_gaps(BenchCase *bench_case)
{
    const int n = bench_case->building.n;
    Random r = random_stream(1, RANDOM_TEST, 1, 0);
    for (int j = 0; j < n; j++)
        bench_case->gaps[j] = strcmp(bench_case->kind->name, "tiny") == 0   ? 0.001 + 0.002 * random_uniform(&r)
                              : strcmp(bench_case->kind->name, "zero") == 0 ? 0
                                                                            : OPEN_GAP;
    if (strcmp(bench_case->kind->name, "irregular") == 0)
        bench_irregular_gaps(0, n, bench_case->gaps);
}

Status bench_case_open(BenchCase *bench_case, const BenchKind *kind, const SceneOptions *s, const Motion *motion,
                       int quick, Err *err)
{
    memset(bench_case, 0, sizeof *bench_case);
    bench_case->kind = kind;
    bench_case->motion = bench_window(motion, &bench_case->start);
    bench_case->duration = fmin(quick ? 0.5 * kind->window_s : kind->window_s,
                                (double)(bench_case->motion.n - 1) * bench_case->motion.dt_s);
    bench_case->core = malloc(sizeof *bench_case->core);
    if (!bench_case->core)
        return fail(err, STATUS_NO_MEMORY, "bench: out of memory");
    TRY(building_load(&bench_case->building, &s->building, err));
    TRY(core_beam_make(bench_case->core, &s->core, bench_case->building.n, bench_case->building.storey_m,
                       BENCH_WALL_BASE, BENCH_WALL_TOP, err));
    TRY(model_create(&bench_case->model, bench_case->building.n, bench_case->building.model.n, err));
    set_gaps(bench_case);
    return strcmp(kind->name, "one-impact") == 0 ? find_one_impact(bench_case, s, err) : set_model(bench_case, s, err);
}

void bench_case_close(BenchCase *bench_case)
{
    model_free(&bench_case->model);
    building_free(&bench_case->building);
    free(bench_case->core);
    memset(bench_case, 0, sizeof *bench_case);
}
