#include "motion/motion.h"

#include "base/units.h"

Status motion_prepare(Motion *m, double pga_g, double stretch, Err *err)
{
    if (!(stretch > 0 && isfinite(stretch)))
        return bad_data(err, "motion.stretch is %g; a positive number is needed", stretch);
    if (!(pga_g >= 0 && isfinite(pga_g)))
        return bad_data(err, "motion.pga_g is %g; 0 (as recorded) or a positive number is needed", pga_g);
    const double peak = motion_peak(m);
    if (!(peak > 0))
        return bad_data(err, "%s: is zero throughout; that is no ground motion", m->name);
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

double motion_strong_part(const Motion *m, double period)
{
    static const double ARIAS = 0.995, PERIODS = 3;
    double whole = 0, sum = 0;
    size_t k = 0;
    if (m->n_force > 0)
        return motion_duration(m);
    for (size_t i = 0; i < m->n; i++)
        whole += m->accel[i] * m->accel[i];
    for (; k < m->n && sum < ARIAS * whole; k++)
        sum += m->accel[k] * m->accel[k];
    return (double)k * m->dt_s + PERIODS * period;
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
    free(m->force);
    free(m->force_rows);
    memset(m, 0, sizeof *m);
}
