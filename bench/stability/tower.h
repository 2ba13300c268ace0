/* bench/stability/tower.h -- the 20-storey tower under a short record that shakes it at once. */
#pragma once

#include "bench/engines/engines.h"
#include "bench/stability/need.h"
#include "motion/motion.h"
#include "sim/sim.h"
#include "settings/options.h"

typedef struct {
    Settings settings;
    int engine;    /* in the place of settings.sim.engine */
    Motion motion; /* owned */
    double x[FLOORS_MAX + 2];
} Tower;

/* Defaults, gaps of 4 mm j + 2 mm (j mod 3), core 12 -> 6.4 mm; two sines, `seconds` long. */
void bench_tower_open(Tower *t, double seconds);
void bench_tower_close(Tower *t);
void bench_tower_set_gaps(Tower *t, double gap);

/* One run: scene, worker, sim_run. A Status that is not OK becomes an outcome with a reason. */
SimResult bench_tower_run(const Tower *t, SceneKind kind);
