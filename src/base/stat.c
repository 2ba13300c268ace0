#include "base/stat.h"

#include <stdlib.h>

void mean_and_sd_of(size_t n, const double v[], double *mean, double *sd)
{
    double square = 0.0;
    *mean = n > 0 ? 0.0 : NAN;
    for (size_t i = 0; i < n; i++)
        *mean += v[i] / (double)n;
    for (size_t i = 0; i < n; i++)
        square += pow(v[i] - *mean, 2.0);
    *sd = n > 1 ? sqrt(square / (double)(n - 1)) : NAN;
}

static int ascending(const void *a, const void *b)
{
    const double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

void sort_values(size_t n, double v[])
{
    qsort(v, n, sizeof *v, ascending);
}
