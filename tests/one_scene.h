/* tests/one_scene.h -- a scene that is made for one simulation, and the tower of 20 floors for several. */
#pragma once

#include "check.h"
#include "scene_options.h"
#include "sim/sim.h"

/* The scene with devices that hardly act, once. */
static inline SimResult simulate(const SceneOptions *o, SceneKind kind, const Motion *motion, const double x[])
{
    Scene *scene;
    SimWorker *worker;
    SimResult r;
    CHECK_OK(scene_create(&scene, o, motion, &err), &err);
    CHECK_OK(sim_worker_create(&worker, scene, &err), &err);
    sim_worker_device(worker, &(LinearDevice){1, 0.1, 0});
    CHECK_OK(sim_run(worker, kind, x, &r, &err), &err);
    assert_int_equal(r.outcome, RUN_OK);
    sim_worker_free(worker);
    scene_free(scene);
    return r;
}

/* A building of one folder beside that of another on its right, both undamped. The paths are taken over. */
static inline void stand_beside(SceneOptions *o, char *building, char *neighbour)
{
    snprintf(o->building.model, sizeof o->building.model, "%s", building);
    snprintf(o->core.model, sizeof o->core.model, "%s", neighbour);
    free(building);
    free(neighbour);
    o->building.damping = LIST_OF(0);
    o->core.damping = 0;
    o->design.gap_sides = GAPS_RIGHT;
}

/* The tower of 20 floors under the record of its settings. */
typedef struct {
    Settings settings;
    Motion motion;
    Scene *scene;
    SimWorker *worker;
    double x[22];
} Tower;

static inline void tower_open(Tower *t, double t_base, double t_top)
{
    const SceneOptions options = settings_scene(&t->settings);
    CHECK_OK(motion_load(&t->motion, t->settings.motion.record, UNIT_FROM_FILE, &err), &err);
    CHECK_OK(motion_prepare(&t->motion, t->settings.motion.pga_g, t->settings.motion.stretch, &err), &err);
    CHECK_OK(scene_create(&t->scene, &options, &t->motion, &err), &err);
    CHECK_OK(sim_worker_create(&t->worker, t->scene, &err), &err);
    for (int j = 0; j < 20; j++)
        t->x[j] = 0.008 * (j + 1);
    t->x[20] = t_base;
    t->x[21] = t_top;
}

static inline void tower_close(Tower *t)
{
    sim_worker_free(t->worker);
    scene_free(t->scene);
    motion_free(&t->motion);
}
