#include "base/filter.h"

#include "base/clones.h"

enum { VECTORS = 3 /* together: each waits for its own last row */ };

Status filter_butterworth(Filter *f, FilterKind kind, double cutoff_hz, double dt_s, Err *err)
{
    const double W = tan(M_PI * cutoff_hz * dt_s);
    if (!(cutoff_hz > 0 && dt_s > 0 && cutoff_hz * dt_s < 0.5))
        return bad_data(err, "a cutoff of %g Hz is not between 0 and half the sampling rate, %g Hz", cutoff_hz,
                        0.5 / dt_s);
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

typedef double v8 __attribute__((vector_size(64), aligned(8)));

/* One pass over VECTORS vectors of eight columns from row `first`, `step` being +1 or -1 rows. */
CLONED static void pass(const Filter *f, size_t n, size_t width, double *first, ptrdiff_t step)
{
    v8 s[VECTORS][FILTER_SECTIONS][2] = {0};
    double *row = first;
    for (size_t i = 0; i < n; i++, row += step * (ptrdiff_t)width)
#pragma GCC unroll 3
        for (int j = 0; j < VECTORS; j++) {
            v8 x = ((v8 *)row)[j];
            FILTER_STEP(f, x, s[j]);
            ((v8 *)row)[j] = x;
        }
}

/* The same over one column. */
static void pass_column(const Filter *f, size_t n, size_t width, double *first, ptrdiff_t step)
{
    double s[FILTER_SECTIONS][2] = {0};
    double *row = first;
    for (size_t i = 0; i < n; i++, row += step * (ptrdiff_t)width) {
        double x = *row;
        FILTER_STEP(f, x, s);
        *row = x;
    }
}

void filter_zero_phase(const Filter *f, size_t n, size_t width, double x[])
{
    enum { LANES = 8 * VECTORS };
    size_t at = 0;
    for (; n > 0 && at + LANES <= width; at += LANES) {
        pass(f, n, width, x + at, 1);
        pass(f, n, width, x + (n - 1) * width + at, -1);
    }
    for (; n > 0 && at < width; at++) {
        pass_column(f, n, width, x + at, 1);
        pass_column(f, n, width, x + (n - 1) * width + at, -1);
    }
}
