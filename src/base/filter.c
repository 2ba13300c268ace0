#include "base/filter.h"

#include <math.h>

enum { LANES = 8 };

Status filter_butterworth(Filter *f, FilterKind kind, double cutoff_hz, double dt_s, Err *err)
{
    const double W = tan(M_PI * cutoff_hz * dt_s);
    if (!(cutoff_hz > 0 && dt_s > 0 && cutoff_hz * dt_s < 0.5))
        return fail(err, STATUS_BAD_DATA, "a cutoff of %g Hz is not between 0 and half the sampling rate, %g Hz",
                    cutoff_hz, 0.5 / dt_s);
    f->cutoff_dt = cutoff_hz * dt_s;
    for (int k = 0; k < FILTER_SECTIONS; k++) {
        const double damping = 2 * cos(M_PI * (2 * k + 1) / (2 * FILTER_ORDER)); /* 1 / Q of this pair of poles */
        const double norm = 1 / (1 + damping * W + W * W), b = kind == FILTER_LOW_PASS ? W * W * norm : norm;
        f->section[k] = (Biquad){.b0 = b,
                                 .b1 = kind == FILTER_LOW_PASS ? 2 * b : -2 * b,
                                 .b2 = b,
                                 .a1 = 2 * (W * W - 1) * norm,
                                 .a2 = (1 - damping * W + W * W) * norm};
    }
    return STATUS_OK;
}

size_t filter_padding(const Filter *f)
{
    return (size_t)ceil(1.5 * FILTER_ORDER / f->cutoff_dt);
}

/* One pass over `lanes` of the columns from row `first`, `step` being +1 or -1 rows: the sections one after the other,
 * each with its two states (transposed direct form II). */
static void pass(const Filter *f, size_t n, size_t width, int lanes, double *first, ptrdiff_t step)
{
    double s[FILTER_SECTIONS][2][LANES] = {0};
    double *row = first;
    for (size_t i = 0; i < n; i++, row += step * (ptrdiff_t)width)
        for (int k = 0; k < FILTER_SECTIONS; k++) {
            const Biquad *q = &f->section[k];
            for (int j = 0; j < lanes; j++) {
                const double x = row[j], y = q->b0 * x + s[k][0][j];
                s[k][0][j] = q->b1 * x - q->a1 * y + s[k][1][j];
                s[k][1][j] = q->b2 * x - q->a2 * y;
                row[j] = y;
            }
        }
}

void filter_zero_phase(const Filter *f, size_t n, size_t width, double x[])
{
    for (size_t at = 0; n > 0 && at < width; at += LANES) {
        const int lanes = width - at < LANES ? (int)(width - at) : LANES;
        pass(f, n, width, lanes, x + at, 1);
        pass(f, n, width, lanes, x + (n - 1) * width + at, -1);
    }
}
