#include "bench/stage.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static const double OPEN_GAP = 10; /* [m] no response of this building reaches it */

static const BenchScene SCENES[N_BENCH_SCENES] = {
    {"linear", "no gap closes", 10},
    {"one-impact", "one floor touches once", 10},
    {"irregular", "gaps of 10 to 200 mm", 8},
    {"tiny", "gaps of 1 to 3 mm", 2},
    {"zero", "no gaps", 2},
};

const BenchScene *bench_scene(int k)
{
    return &SCENES[k];
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

static Status set_model(Stage *stage, const SceneOptions *s, Err *err)
{
    return model_set(&stage->model, s, &stage->building, stage->core, stage->gaps, err);
}

/* Impacts when only the middle floor can touch, at this gap. */
static Status count_impacts(Stage *stage, const SceneOptions *s, double gap, long *impacts, Err *err)
{
    const EngineOptions options = {.duration = stage->duration, .accuracy = ACCURACY_FINE};
    SimResult r;
    stage->gaps[stage->building.n / 2] = gap;
    TRY(set_model(stage, s, err));
    TRY(engine_fast(&stage->model, &stage->motion, &options, &r, err));
    *impacts = r.impacts;
    return STATUS_OK;
}

/* The middle floor's gap a little short of the largest that closes, so that it closes once. */
static Status find_one_impact(Stage *stage, const SceneOptions *s, Err *err)
{
    double closes = 0, open = OPEN_GAP;
    long impacts;
    for (int k = 0; k < 30; k++) {
        const double middle = 0.5 * (closes + open);
        TRY(count_impacts(stage, s, middle, &impacts, err));
        *(impacts > 0 ? &closes : &open) = middle;
    }
    for (double share = 0.9; share < 0.99999; share = 0.5 * (1 + share)) {
        TRY(count_impacts(stage, s, share * closes, &impacts, err));
        if (impacts == 1)
            return STATUS_OK;
    }
    return fail(err, STATUS_INTERNAL, "bench: no gap of the middle floor closes exactly once");
}

static void set_gaps(Stage *stage)
{
    const int n = stage->building.n;
    Random r = random_stream(1, RANDOM_TEST, 1, 0);
    for (int j = 0; j < n; j++)
        stage->gaps[j] = strcmp(stage->scene->name, "tiny") == 0   ? 0.001 + 0.002 * random_uniform(&r)
                         : strcmp(stage->scene->name, "zero") == 0 ? 0
                                                                   : OPEN_GAP;
    if (strcmp(stage->scene->name, "irregular") == 0)
        bench_irregular_gaps(0, n, stage->gaps);
}

Status stage_open(Stage *stage, const BenchScene *scene, const SceneOptions *s, const Motion *motion, int quick,
                  Err *err)
{
    memset(stage, 0, sizeof *stage);
    stage->scene = scene;
    stage->motion = bench_window(motion, &stage->start);
    stage->duration =
        fmin(quick ? 0.5 * scene->window_s : scene->window_s, (double)(stage->motion.n - 1) * stage->motion.dt_s);
    stage->core = malloc(sizeof *stage->core);
    if (!stage->core)
        return fail(err, STATUS_NO_MEMORY, "bench: out of memory");
    TRY(building_load(&stage->building, s->building.model, err));
    TRY(core_beam_make(stage->core, &s->core, &s->building, stage->building.n, BENCH_WALL_BASE, BENCH_WALL_TOP, err));
    TRY(model_create(&stage->model, stage->building.n, err));
    set_gaps(stage);
    return strcmp(scene->name, "one-impact") == 0 ? find_one_impact(stage, s, err) : set_model(stage, s, err);
}

void stage_close(Stage *stage)
{
    model_free(&stage->model);
    building_free(&stage->building);
    free(stage->core);
    memset(stage, 0, sizeof *stage);
}
