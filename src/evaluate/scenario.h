/* evaluate/scenario.h -- a scenario from settings: the ground motion read and scaled, the scene built on it.
 *
 * Life cycle  scenario_open -> ... -> scenario_close      (a zeroed Scenario may be closed)
 * Ownership   the scene borrows the motion beside it: a Scenario must stay where it was opened */
#ifndef IMTET_EVALUATE_SCENARIO_H
#define IMTET_EVALUATE_SCENARIO_H

#include "motion/motion.h"
#include "motion/options.h"
#include "sim/sim.h"

typedef struct {
    SceneOptions options;
    MotionOptions record; /* of the motion: as it was asked for */
    Motion motion;
    Scene *scene;
} Scenario;

Status scenario_open(Scenario *w, const SceneOptions *o, const MotionOptions *record, Err *err);

/* The same at rest, for questions that no ground motion answers (frequencies). */
Status scenario_open_still(Scenario *w, const SceneOptions *o, Err *err);
void scenario_close(Scenario *w);

#endif
