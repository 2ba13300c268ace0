#include "bench/stability/tower.h"
#include "bench/paper.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

void bench_tower_open(Tower *t, double seconds)
{
    memset(t, 0, sizeof *t);
    paper_defaults(&t->settings);
    t->motion.dt_s = 0.05;
    t->motion.n = (size_t)(seconds / t->motion.dt_s) + 1;
    t->motion.accel = malloc(t->motion.n * sizeof *t->motion.accel);
    if (!t->motion.accel) {
        Err err;
        need(fail(&err, STATUS_NO_MEMORY, "no memory for %zu samples", t->motion.n), &err);
    }
    for (size_t i = 0; i < t->motion.n; i++) {
        const double at = (double)i * t->motion.dt_s;
        t->motion.accel[i] = 2 * sin(2.5 * at) + 1.2 * sin(8.2 * at);
    }
    for (int j = 0; j < 20; j++)
        t->x[j] = 0.004 * (j + 1) + 0.002 * (j % 3);
    t->x[20] = 0.012;
    t->x[21] = 0.0064;
}

void bench_tower_close(Tower *t)
{
    motion_free(&t->motion);
}

void bench_tower_set_gaps(Tower *t, double gap)
{
    for (int j = 0; j < 20; j++)
        t->x[j] = gap;
}

SimResult bench_tower_run(const Tower *t, SceneKind kind)
{
    SimResult r = {0};
    const SceneOptions options = settings_scene(&t->settings);
    Scene *scene = NULL;
    SimWorker *worker = NULL;
    Err err = {0};
    Status status = scene_create(&scene, &options, &t->motion, &err);
    if (status == STATUS_OK) {
        scene_set_engine(scene, bench_engine(t->engine));
        status = sim_worker_create(&worker, scene, &err);
    }
    if (status == STATUS_OK) {
        sim_worker_device(worker, &(LinearDevice){.link_ns_m = 1e12}); /* floors and core move as one */
        status = sim_run(worker, kind, t->x, &r, &err);
    }
    if (status != STATUS_OK) {
        r = (SimResult){.outcome = RUN_ENGINE_FAILED};
        snprintf(r.reason, sizeof r.reason, "%.*s", (int)sizeof r.reason - 1, err.text);
    }
    sim_worker_free(worker);
    scene_free(scene);
    return r;
}
