#include "scene/motion.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/units.h"

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

void motion_free(Motion *m)
{
    free(m->accel);
    memset(m, 0, sizeof *m);
}
