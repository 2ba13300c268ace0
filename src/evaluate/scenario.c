#include "evaluate/scenario.h"

#include "base/stat.h"
#include "motion/motion_scale.h"
#include "sim/fast/fast.h"

Status motion_scale_copy(Motion *out, const Motion *read, const MotionOptions *record, Err *err)
{
    const size_t rows = read->force_rows ? read->n_force_rows * (read->n_force + 1) : 0;
    *out = *read;
    out->accel = malloc(read->n * sizeof *out->accel);
    out->force_rows = rows ? malloc(rows * sizeof *out->force_rows) : NULL;
    Status status =
        out->accel && (!rows || out->force_rows) ? STATUS_OK : fail_memory(err, read->n, "samples of a motion");
    if (status == STATUS_OK) {
        copy_values(read->n, read->accel, out->accel);
        copy_values(rows, read->force_rows, out->force_rows);
        status = motion_scale(out, record, err);
    }
    if (status != STATUS_OK)
        motion_free(out);
    return status;
}

Status scenario_open(Scenario *w, const SceneOptions *o, const MotionOptions *record, const Motion *read, Err *err)
{
    memset(w, 0, sizeof *w);
    w->options = *o;
    w->record = *record;
    TRY(motion_scale_copy(&w->motion, read, record, err));
    const Status status = scene_create(&w->scene, &w->options, &w->motion, err);
    if (status != STATUS_OK)
        scenario_close(w);
    return status;
}

void scenario_close(Scenario *w)
{
    scene_free(w->scene);
    w->scene = NULL;
    motion_free(&w->motion);
}

int estimate_options(const SimOptions *o, SimOptions *finer)
{
    const double steps = sim_steps_per_contact(o);
    *finer = *o;
    finer->steps_per_contact = 2 * (steps > 0 ? steps : fast_tolerances(o->accuracy).steps_per_contact);
    return o->engine == ENGINE_FAST;
}
