/* tests/stability/tower.h -- the 20-storey tower under a short record that shakes it at once. */
#ifndef IMTET_TESTS_TOWER_H
#define IMTET_TESTS_TOWER_H

#include "../check.h"

#include "scene/motion.h"
#include "sim/sim.h"
#include "settings/settings.h"

typedef struct {
    Settings settings;
    Motion motion; /* owned */
    double x[FLOORS_MAX + 2];
} Tower;

/* Defaults, gaps of 4 mm j + 2 mm (j mod 3), core 12 -> 6.4 mm, and two sines of `seconds` with pauses for no one. */
void tower_open(Tower *t, double seconds);
void tower_close(Tower *t);
void tower_set_gaps(Tower *t, double gap);

/* One run of the whole door: scene, worker, sim_run. A Status that is not OK becomes an outcome with a reason. */
SimResult tower_run(const Tower *t, SceneKind kind);

#endif
