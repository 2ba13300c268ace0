#include "motion/motion_scale.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#include "base/units.h"
#include "motion/spectrum.h"

static const double DAMPING = 0.05;

/* ---- code spectra ------------------------------------------------------------------------------------------------ */

static double eurocode8(const MotionOptions *o, double T)
{
    const double plateau = 2.5 * o->ec8_ag_g * o->ec8_s;
    if (T < o->ec8_tb_s)
        return plateau / 2.5 * (1 + 1.5 * T / o->ec8_tb_s);
    if (T <= o->ec8_tc_s)
        return plateau;
    return T <= o->ec8_td_s ? plateau * o->ec8_tc_s / T : plateau * o->ec8_tc_s * o->ec8_td_s / (T * T);
}

static double asce7(const MotionOptions *o, double T)
{
    const double ts = o->asce7_sd1_g / o->asce7_sds_g, t0 = 0.2 * ts;
    if (T < t0)
        return o->asce7_sds_g * (0.4 + 0.6 * T / t0);
    if (T <= ts)
        return o->asce7_sds_g;
    return T <= o->asce7_tl_s ? o->asce7_sd1_g / T : o->asce7_sd1_g * o->asce7_tl_s / (T * T);
}

double target_psa(const MotionOptions *o, double T)
{
    switch (o->target) {
    case TARGET_EUROCODE8:
        return GRAVITY * eurocode8(o, T);
    case TARGET_ASCE7:
        return GRAVITY * asce7(o, T);
    case TARGET_NONE:
        break;
    }
    return 0;
}

/* ln(target / PSa) over the range: its mean, and the root of its mean square. */
static void compare(const Motion *m, const MotionOptions *o, double *mean, double *rms)
{
    double T[TARGET_PERIODS], psa[TARGET_PERIODS];
    *mean = *rms = 0;
    for (int i = 0; i < TARGET_PERIODS; i++)
        T[i] = o->target_from_s * pow(o->target_to_s / o->target_from_s, (double)i / (TARGET_PERIODS - 1));
    spectrum_psa(m, DAMPING, TARGET_PERIODS, T, psa);
    for (int i = 0; i < TARGET_PERIODS; i++) {
        const double ratio = log(target_psa(o, T[i]) / psa[i]);
        *mean += ratio / TARGET_PERIODS;
        *rms += ratio * ratio / TARGET_PERIODS;
    }
    *rms = sqrt(*rms);
}

double target_misfit(const Motion *m, const MotionOptions *o)
{
    double mean, rms;
    compare(m, o, &mean, &rms);
    return rms;
}

/* ---- scaling ----------------------------------------------------------------------------------------------------- */

static double factor_of(const Motion *m, const MotionOptions *o)
{
    double psa, mean, rms;
    if (o->sa_g > 0) {
        spectrum_psa(m, DAMPING, 1, &o->sa_period_s, &psa);
        return o->sa_g * GRAVITY / psa;
    }
    if (o->target != TARGET_NONE) {
        compare(m, o, &mean, &rms);
        return exp(mean);
    }
    return o->factor;
}

/* Behind what the reader has to say. */
static void warn_of_scale(Motion *m)
{
    const size_t used = strlen(m->warning);
    if (m->scale > SCALE_PLAUSIBLE || m->scale < 1 / SCALE_PLAUSIBLE)
        snprintf(m->warning + used, sizeof m->warning - used,
                 "%sscaled by %.3g; records are scaled by %g to %g as a rule", used ? "; " : "", m->scale,
                 1 / SCALE_PLAUSIBLE, SCALE_PLAUSIBLE);
}

/* A record that must be multiplied by so much is not what it is taken for. A factor of one's own may convert units. */
static Status check_scale(const Motion *m, const MotionOptions *o, double peak_g, Err *err)
{
    char scaling[SCALINGS_TEXT_MAX];
    if (o->factor != 1 || m->scale <= SCALE_MAX)
        return STATUS_OK;
    motion_scalings(o, scaling);
    return fail(
        err, STATUS_BAD_DATA,
        "%s: %s would multiply it by %.3g, for it peaks at %.3g g%s%s; beyond %g its unit is wrong, or nothing is "
        "left of it",
        m->name, scaling, m->scale, peak_g, m->processed[0] ? " after this: " : "", m->processed, SCALE_MAX);
}

Status motion_scale(Motion *m, const MotionOptions *o, Err *err)
{
    const double peak_g = motion_peak(m) / GRAVITY;
    TRY(motion_prepare(m, o->pga_g, o->stretch, err));
    const double factor = factor_of(m, o);
    if (!(factor > 0 && isfinite(factor)))
        return fail(err, STATUS_BAD_DATA, "%s: cannot be scaled to a response spectrum: it moves no such oscillator",
                    m->name);
    for (size_t i = 0; i < m->n && factor != 1; i++)
        m->accel[i] *= factor;
    m->scale *= factor;
    warn_of_scale(m);
    return check_scale(m, o, peak_g, err);
}

int motion_scalings(const MotionOptions *o, char text[SCALINGS_TEXT_MAX])
{
    char each[4][64] = {"", "", "", ""};
    int n = 0;
    if (o->pga_g > 0)
        snprintf(each[n++], sizeof each[0], "motion.pga_g = %g", o->pga_g);
    if (o->factor != 1)
        snprintf(each[n++], sizeof each[0], "motion.factor = %g", o->factor);
    if (o->sa_g > 0)
        snprintf(each[n++], sizeof each[0], "motion.sa_g = %g", o->sa_g);
    if (o->target != TARGET_NONE)
        snprintf(each[n++], sizeof each[0], "motion.target = %s", o->target == TARGET_ASCE7 ? "asce7" : "eurocode8");
    text[0] = 0;
    for (int i = 0; i < n; i++)
        snprintf(text + strlen(text), SCALINGS_TEXT_MAX - strlen(text), "%s%s", i ? ", " : "", each[i]);
    return n;
}

void motion_unscale(MotionOptions *o)
{
    o->pga_g = o->sa_g = 0;
    o->factor = 1;
    o->target = TARGET_NONE;
}
