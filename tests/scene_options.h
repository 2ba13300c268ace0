/* tests/scene_options.h -- the options of a scene: the defaults, and those of the paper's study (configs/kobe.ini). */
#ifndef IMTET_TESTS_SCENE_OPTIONS_H
#define IMTET_TESTS_SCENE_OPTIONS_H

#include "evaluate/scenario.h"
#include "motion/motion_scale.h"
#include "scene/building.h"
#include "bench/paper.h"

static inline SceneOptions scene_defaults(void)
{
    Settings s;
    settings_defaults(&s);
    return settings_scene(&s);
}

static inline SceneOptions paper_scene(void)
{
    Settings s;
    paper_defaults(&s);
    return settings_scene(&s);
}

/* The tower of six floors of program.h: what simulations do with twenty floors, in a tenth of the time. */
static inline void six_floors(BuildingOptions *building, CoreOptions *core)
{
    snprintf(building->model, sizeof building->model, "configs/neighbours/tower");
    core->width_m = 5;
}

/* With the record read. */
static inline Status scenario_of(Scenario *w, const SceneOptions *o, const MotionOptions *record, Err *why)
{
    Motion read;
    TRY(motion_open(&read, record, why));
    const Status status = scenario_open(w, o, record, &read, why);
    motion_free(&read);
    return status;
}

static inline Status load_model(Building *b, const char *model, Err *why)
{
    SceneOptions s = scene_defaults();
    snprintf(s.building.model, sizeof s.building.model, "%s", model);
    return building_load(b, &s.building, why);
}

#define LIST_OF(...) ((NumberList){.n = sizeof((double[]){__VA_ARGS__}) / sizeof(double), .at = {__VA_ARGS__}})

/* The core of n storeys of the options' heights. */
static inline Status make_core_of(CoreBeam *core, const SceneOptions *s, int n, double t_base, double t_top, Err *why)
{
    double storey_m[FLOORS_MAX];
    for (int j = 0; j < n; j++)
        storey_m[j] = list_at(&s->building.heights_m, j);
    return core_beam_make(core, &s->core, n, storey_m, t_base, t_top, why);
}

#endif
