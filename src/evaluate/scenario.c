#include "evaluate/scenario.h"
#include "motion/motion_scale.h"
#include "motion/motion_source.h"

#include <stdlib.h>
#include <string.h>

static Status build(Scenario *w, Err *err)
{
    const Status status = scene_create(&w->scene, &w->options, &w->motion, err);
    if (status != STATUS_OK)
        scenario_close(w);
    return status;
}

Status scenario_open(Scenario *w, const SceneOptions *o, const MotionOptions *record, Err *err)
{
    memset(w, 0, sizeof *w);
    w->options = *o;
    w->record = *record;
    TRY(motion_open(&w->motion, record, err));
    const Status status = motion_scale(&w->motion, record, err);
    if (status != STATUS_OK) {
        scenario_close(w);
        return status;
    }
    return build(w, err);
}

Status scenario_open_still(Scenario *w, const SceneOptions *o, Err *err)
{
    memset(w, 0, sizeof *w);
    w->options = *o;
    w->motion = (Motion){.n = 2, .dt_s = 0.01, .name = "at rest", .format = "none"};
    w->motion.accel = calloc(w->motion.n, sizeof *w->motion.accel);
    if (!w->motion.accel)
        return fail(err, STATUS_NO_MEMORY, "no memory for a motion of %zu samples", w->motion.n);
    return build(w, err);
}

void scenario_close(Scenario *w)
{
    scene_free(w->scene);
    w->scene = NULL;
    motion_free(&w->motion);
}
