/* tests/one_scene.h -- a scene that is made for one simulation, and the tower of 20 floors for several. */
#pragma once

#include "scene_options.h"

/* The scene with devices that hardly act, once. */
static inline SimResult simulate(const SceneOptions *o, SceneKind kind, const Motion *motion, const double x[])
{
    OWNED(one_scene_free) OneScene s = one_scene_of(o, motion);
    SimResult r;
    sim_worker_device(s.worker, &(LinearDevice){1, 0.1, 0});
    CHECK_OK(sim_run(s.worker, kind, x, &r, &err), &err);
    assert_ran(&r);
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
    t->motion = motion_of(t->settings.motion.record, t->settings.motion.pga_g, t->settings.motion.stretch);
    const OneScene stage = one_scene_of(&options, &t->motion);
    t->scene = stage.scene;
    t->worker = stage.worker;
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
