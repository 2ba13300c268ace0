/* simulator/scenario.h -- settings made real: the ground motion read and scaled, the scene built on it.
 *
 * Life cycle  world_open -> ... -> world_close      (a zeroed World may be closed)
 * Ownership   the scene borrows the motion beside it: a World must stay where it was opened */
#ifndef IMTET_SIMULATOR_SCENARIO_H
#define IMTET_SIMULATOR_SCENARIO_H

#include "scene/motion.h"
#include "sim/sim.h"

typedef struct Settings Settings;

typedef struct {
    SceneOptions options;
    MotionOptions record; /* of the motion: as it was asked for */
    Motion motion;
    Scene *scene;
} World;

Status world_open(World *w, const Settings *s, Err *err);

/* The same at rest, for questions that no ground motion answers (frequencies). */
Status world_open_still(World *w, const Settings *s, Err *err);
void world_close(World *w);

#endif
