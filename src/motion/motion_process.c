#include "motion/motion_process.h"

#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/filter.h"
#include "base/units.h"

enum { PADDING_MAX = 10000000 };                        /* samples: 80 MB */
static const double HIGHPASS_PAD = 0.75 * FILTER_ORDER; /* [-] times 1 / fc, before and behind */

static __attribute__((format(printf, 2, 3))) void say(Motion *m, const char *format, ...)
{
    const size_t used = strlen(m->processed);
    va_list list;
    va_start(list, format);
    snprintf(m->processed + used, sizeof m->processed - used, "%s", used ? "; " : "");
    vsnprintf(m->processed + strlen(m->processed), sizeof m->processed - strlen(m->processed), format, list);
    va_end(list);
}

/* ---- base line --------------------------------------------------------------------------------------------------- */

enum { DEGREE_MAX = 2 };

/* Values at s of the first polynomials that are orthogonal over the points s_i = 2 i / (n - 1) - 1, i = 0..n-1. */
static void orthogonal(double s, double n, double p[DEGREE_MAX + 1])
{
    p[0] = 1;
    p[1] = s;
    p[2] = s * s - (n + 1) / (3 * (n - 1)); /* mean of s_i^2 */
}

static Status subtract_baseline(Motion *m, int degree, Err *err)
{
    static const char *const WORDS[] = {"mean", "straight line", "parabola"};
    const double n = (double)m->n;
    double p[DEGREE_MAX + 1], sum[DEGREE_MAX + 1] = {0}, square[DEGREE_MAX + 1] = {0}, largest = 0;
    if (m->n < (size_t)degree + 2)
        return fail(err, STATUS_BAD_DATA, "%s: %zu samples are too few for motion.baseline", m->name, m->n);
    for (size_t i = 0; i < m->n; i++) {
        orthogonal(2 * (double)i / (n - 1) - 1, n, p);
        for (int k = 0; k <= degree; k++) {
            sum[k] += p[k] * m->accel[i];
            square[k] += p[k] * p[k];
        }
    }
    for (size_t i = 0; i < m->n; i++) {
        double line = 0;
        orthogonal(2 * (double)i / (n - 1) - 1, n, p);
        for (int k = 0; k <= degree; k++)
            line += sum[k] / square[k] * p[k];
        m->accel[i] -= line;
        largest = fmax(largest, fabs(line));
    }
    say(m, "base line: %s subtracted, at most %.3g g", WORDS[degree], largest / GRAVITY);
    return STATUS_OK;
}

/* ---- filters ----------------------------------------------------------------------------------------------------- */

/* Zeros before and behind the record. */
static Status pad(Motion *m, size_t before, size_t behind, Err *err)
{
    double *wider = calloc(before + m->n + behind, sizeof *wider);
    if (!wider)
        return fail(err, STATUS_NO_MEMORY, "%s: no memory to filter it", m->name);
    memcpy(wider + before, m->accel, m->n * sizeof *wider);
    free(m->accel);
    m->accel = wider;
    m->n += before + behind;
    return STATUS_OK;
}

static Status open_filter(const Motion *m, Filter *f, FilterKind kind, const char *key, double cutoff_hz, Err *err)
{
    Err why = {0};
    const Status status = filter_butterworth(f, kind, cutoff_hz, m->dt_s, &why);
    return status == STATUS_OK ? STATUS_OK : fail(err, status, "%s: motion.%s: %s", m->name, key, why.text);
}

static Status high_pass(Motion *m, double cutoff_hz, Err *err)
{
    Filter f;
    TRY(open_filter(m, &f, FILTER_HIGH_PASS, "highpass_hz", cutoff_hz, err));
    const double length_s = HIGHPASS_PAD / cutoff_hz;
    const size_t padding = (size_t)ceil(length_s / m->dt_s);
    if (padding > PADDING_MAX)
        return fail(err, STATUS_BAD_DATA, "%s: motion.highpass_hz: %g Hz needs %zu samples of padding; at most %d",
                    m->name, cutoff_hz, padding, PADDING_MAX);
    TRY(pad(m, padding, padding, err));
    filter_zero_phase(&f, m->n, 1, m->accel);
    say(m, "high-pass %g Hz (4th order Butterworth, zero phase), %.4g s of zeros added at both ends", cutoff_hz,
        (double)padding * m->dt_s);
    return STATUS_OK;
}

static Status low_pass(Motion *m, double cutoff_hz, Err *err)
{
    Filter f;
    TRY(open_filter(m, &f, FILTER_LOW_PASS, "lowpass_hz", cutoff_hz, err));
    const size_t padding = filter_padding(&f);
    if (padding > PADDING_MAX)
        return fail(err, STATUS_BAD_DATA, "%s: motion.lowpass_hz: %g Hz needs %zu samples of padding; at most %d",
                    m->name, cutoff_hz, padding, PADDING_MAX);
    TRY(pad(m, 0, padding, err));
    filter_zero_phase(&f, m->n, 1, m->accel);
    m->n -= padding;
    say(m, "low-pass %g Hz (4th order Butterworth, zero phase)", cutoff_hz);
    return STATUS_OK;
}

Status motion_process(Motion *m, const MotionOptions *o, Err *err)
{
    if (o->baseline != BASELINE_NONE)
        TRY(subtract_baseline(m, (int)o->baseline - (int)BASELINE_MEAN, err));
    if (o->highpass_hz > 0)
        TRY(high_pass(m, o->highpass_hz, err));
    if (o->lowpass_hz > 0)
        TRY(low_pass(m, o->lowpass_hz, err));
    return STATUS_OK;
}

int motion_is_corrected(const MotionOptions *o)
{
    return o->baseline != BASELINE_NONE || o->highpass_hz > 0;
}
