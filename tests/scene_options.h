/* tests/scene_options.h -- the options of a scene: the defaults, and those of the paper's study (configs/kobe.ini). */
#pragma once

#include "check.h"
#include "evaluate/scenario.h"
#include "motion/motion_scale.h"
#include "scene/building.h"
#include "sim/engine.h"
#include "sim/sim.h"
#include "motion/spectrum.h"
#include "bench/paper.h"

static inline SceneOptions scene_defaults(void)
{
    const Settings s = default_settings();
    return settings_scene(&s);
}

static inline Settings paper_settings(void)
{
    Settings s;
    paper_defaults(&s);
    return s;
}

static inline SceneOptions paper_scene(void)
{
    const Settings s = paper_settings();
    return settings_scene(&s);
}

/* A record at a peak [g] and on a longer time; of pga_g 0 as it is. */
static inline Motion motion_of(const char *source, double pga_g, double stretch)
{
    Motion m;
    CHECK_OK(motion_load(&m, source, UNIT_FROM_FILE, &err), &err);
    CHECK_OK(motion_prepare(&m, pga_g, stretch, &err), &err);
    return m;
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
    OWNED(motion_free) Motion read = {0};
    TRY(motion_open(&read, record, why));
    return scenario_open(w, o, record, &read, why);
}

static inline Status load_model(Building *b, const char *model, Err *why)
{
    SceneOptions s = scene_defaults();
    snprintf(s.building.model, sizeof s.building.model, "%s", model);
    return building_load(b, &s.building, why);
}

/* Gaps that grow by `step` from the lowest, and the walls of the paper. */
static inline void paper_design(double x[22], double lowest, double step)
{
    for (int j = 0; j < 22; j++)
        x[j] = j < 20 ? lowest + step * j : j == 20 ? 0.012 : 0.0064;
}

#define KOBE "../shared/records/kobe_jma_ns.csv"

/* A design of configs/engineer.ini that an independent integrator has simulated under Kobe, on ground of its own. */
static const double KNOWN_DESIGN[] __attribute__((unused)) = {
    0.062620906, 0.49638428,  0.0075756700, 0.49967802,   0.053314538, 0.45756536, 0.0010002436, 0.18170539,
    0.40825994,  0.45607738,  0.37509996,   0.0083128154, 0.20994399,  0.35243200, 0.39644089,   0.49323430,
    0.40733242,  0.027483092, 0.0066243711, 0.060373916,  0.018777814, 0.010004510};

static inline Status known_settings(Settings *s, const char *anchors, Err *why)
{
    settings_defaults(s);
    TRY(settings_read(s, "configs/engineer.ini", NULL, NULL, why));
    snprintf(s->motion.record, sizeof s->motion.record, "%s", KOBE);
    snprintf(s->core.foundation, sizeof s->core.foundation, "soil=C radius=11.3 weight=2.4e7%s", anchors);
    return STATUS_OK;
}

/* A scene and one that simulates it. */
typedef struct {
    Scene *scene;
    SimWorker *worker;
} OneScene;

static inline OneScene one_scene_of(const SceneOptions *o, const Motion *motion)
{
    OneScene s;
    CHECK_OK(scene_create(&s.scene, o, motion, &err), &err);
    CHECK_OK(sim_worker_create(&s.worker, s.scene, &err), &err);
    return s;
}

static inline void one_scene_free(OneScene *s)
{
    sim_worker_free(s->worker);
    scene_free(s->scene);
}

/* It ran to its end. */
static inline void assert_ran(const SimResult *r)
{
    if (r->outcome != RUN_OK)
        fail_msg("%s", r->reason);
}

/* A scene that is made for one simulation. */
static inline SimResult run_once(const SceneOptions *o, const Motion *motion, SceneKind kind, const double x[])
{
    OWNED(one_scene_free) OneScene s = one_scene_of(o, motion);
    SimResult r;
    CHECK_OK(sim_run(s.worker, kind, x, &r, &err), &err);
    assert_ran(&r);
    return r;
}

/* One simulation under a record; device NULL: none. */
static inline Status run_under(const SceneOptions *o, const MotionOptions *record, SceneKind kind, const double x[],
                               const LinearDevice *device, SimResult *r, Err *why)
{
    OWNED(scenario_close) Scenario w = {0};
    SimWorker *worker = NULL;
    TRY(scenario_of(&w, o, record, why));
    Status status = sim_worker_create(&worker, w.scene, why);
    if (status == STATUS_OK && device)
        sim_worker_device(worker, device);
    THEN(status, sim_run(worker, kind, x, r, why));
    sim_worker_free(worker);
    return status;
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
