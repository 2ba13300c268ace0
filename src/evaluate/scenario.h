/* evaluate/scenario.h -- a scenario from settings: the ground motion read and scaled, the scene built on it.
 *
 * Life cycle  scenario_open -> ... -> scenario_close      (a zeroed Scenario may be closed)
 * Ownership   the scene borrows the motion beside it: a Scenario must stay where it was opened */
#pragma once

#include "sim/sim.h"

typedef struct {
    SceneOptions options;
    MotionOptions record; /* of the motion: as it was asked for */
    Motion motion;
    Scene *scene;
} Scenario;

/* With a copy of the record as motion_open read it. */
Status scenario_open(Scenario *w, const SceneOptions *o, const MotionOptions *record, const Motion *read, Err *err);

/* motion_scale of a copy. */
Status motion_scale_copy(Motion *out, const Motion *read, const MotionOptions *record, Err *err);

void scenario_close(Scenario *w);

/* The options of a run with twice the steps, by which the error of another one is estimated (analysis/estimate.h); 0:
 * this engine has none. */
int estimate_options(const SimOptions *o, SimOptions *finer);
