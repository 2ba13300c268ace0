/* base/stat.h -- numbers in a row: copies, mean and standard deviation, order, whether all are finite.
 *
 *   mean = sum_i v_i / n        sd = root(sum_i (v_i - mean)^2 / (n - 1))        NAN: no value, less than two
 *
 * Threads  no state */
#pragma once

#include <math.h>
#include <stddef.h>
#include <string.h>

void mean_and_sd_of(size_t n, const double v[], double *mean, double *sd);

void sort_values(size_t n, double v[]); /* ascending */

/* The two may overlap; of n = 0 neither need be there. */
static inline void copy_values(size_t n, const double from[], double to[])
{
    if (n > 0)
        memmove(to, from, n * sizeof *to);
}

static inline int all_finite(size_t n, const double v[])
{
    size_t i = 0;
    while (i < n && isfinite(v[i]))
        i++;
    return i == n;
}
