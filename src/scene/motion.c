#include "scene/motion.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/units.h"
#include "scene/builtin.h"
#include "scene/motion_read.h"

static Status load(Motion *m, const char *source, const MotionHow *how, Err *err)
{
    static const char prefix[] = "builtin:";
    static const char *const MOTIONS[] = {"builtin:kobe-like", "builtin:elcentro-like", "builtin:sylmar-like"};
    if (strncmp(source, prefix, sizeof prefix - 1) == 0)
        return builtin_motion(m, source + sizeof prefix - 1, err); /* in m/s2, one channel, whatever is said of files */
    const Status status = motion_read(m, source, how, err);
    const char *near = status == STATUS_MISSING ? nearest_word(source, MOTIONS, 3) : NULL;
    return near ? fail(err, status, "%s: there is no such file; did you mean %s?", source, near) : status;
}

Status motion_load(Motion *m, const char *source, MotionUnit unit, Err *err)
{
    return load(m, source, &(MotionHow){.unit = unit}, err);
}

Status motion_open(Motion *m, const Settings *s, Err *err)
{
    const MotionHow how = {.unit = (MotionUnit)s->motion.unit,
                           .channel = s->motion.channel,
                           .dt_s = s->motion.dt_s,
                           .resample_dt_s = s->motion.resample_dt_s};
    return load(m, s->motion.record, &how, err);
}

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
    return STATUS_OK;
}

double motion_peak(const Motion *m)
{
    double peak = 0;
    for (size_t i = 0; i < m->n; i++)
        peak = fmax(peak, fabs(m->accel[i]));
    return peak;
}

void motion_free(Motion *m)
{
    free(m->accel);
    memset(m, 0, sizeof *m);
}
