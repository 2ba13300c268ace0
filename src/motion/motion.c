#include "motion/motion.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/units.h"
#include "motion/builtin.h"
#include "motion/motion_read.h"
#include "motion/motion_scale.h"

Status motion_prepare(Motion *m, double pga_g, double stretch, Err *err)
{
    if (!(stretch > 0 && isfinite(stretch)))
        return fail(err, STATUS_BAD_DATA, "motion.stretch is %g; a positive number is needed", stretch);
    if (!(pga_g >= 0 && isfinite(pga_g)))
        return fail(err, STATUS_BAD_DATA, "motion.pga_g is %g; 0 (as recorded) or a positive number is needed", pga_g);
    const double peak = motion_peak(m);
    if (!(peak > 0))
        return fail(err, STATUS_BAD_DATA, "%s: is zero throughout; that is no ground motion", m->name);
    const double scale = pga_g > 0 ? pga_g * GRAVITY / peak : 1.0;
    for (size_t i = 0; i < m->n; i++)
        m->accel[i] *= scale;
    m->dt_s *= stretch;
    m->scale = scale;
    m->stretch = stretch;
    return STATUS_OK;
}

double motion_peak(const Motion *m)
{
    double peak = 0;
    for (size_t i = 0; i < m->n; i++)
        peak = fmax(peak, fabs(m->accel[i]));
    return peak;
}

void motion_peak_text(const Motion *m, char text[MOTION_PEAK_TEXT_MAX])
{
    const double peak_g = motion_peak(m) / GRAVITY;
    const int is_as_recorded = !(m->scale > 0) || (m->scale == 1 && m->stretch == 1);
    if (is_as_recorded)
        snprintf(text, MOTION_PEAK_TEXT_MAX, "peak %.4g g", peak_g);
    else
        snprintf(text, MOTION_PEAK_TEXT_MAX, "peak %.4g g (%.4g g x %.4g, time x %.4g)", peak_g, peak_g / m->scale,
                 m->scale, m->stretch);
}

void motion_free(Motion *m)
{
    free(m->accel);
    memset(m, 0, sizeof *m);
}

static Status load(Motion *m, const char *source, const MotionHow *how, Err *err)
{
    static const char *const MOTIONS[] = {BUILTIN_MOTION_LIST(CHOICE_WORD)};
    if (builtin_name(source))
        return builtin_motion(m, builtin_name(source), err); /* in m/s2, one channel, whatever is said of files */
    const Status status = motion_read(m, source, how, err);
    const char *near =
        status == STATUS_MISSING ? nearest_word(source, MOTIONS, sizeof MOTIONS / sizeof MOTIONS[0]) : NULL;
    return near ? fail_sub(err, status, SUB_SUGGESTS, "%s: there is no such file; did you mean %s?", source, near) : status;
}

Status motion_load(Motion *m, const char *source, MotionUnit unit, Err *err)
{
    return load(m, source, &(MotionHow){.unit = unit}, err);
}

Status motion_open(Motion *m, const MotionOptions *o, Err *err)
{
    MotionHow how = {.channel = o->channel, .dt_s = o->dt_s};
    TRY(motion_unit_parse(o->unit, &how.unit, &how.counts_per_m_s2, err));
    TRY(load(m, o->record, &how, err));
    const Status status = motion_process(m, o, err);
    if (status != STATUS_OK)
        motion_free(m);
    return status;
}
