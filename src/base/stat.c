#include "base/stat.h"

#include <stdlib.h>

void mean_and_sd(size_t n, double (*value)(size_t i, const void *user), const void *user, double *mean, double *sd)
{
    double square = 0.0;
    *mean = n > 0 ? 0.0 : NAN;
    for (size_t i = 0; i < n; i++)
        *mean += value(i, user) / (double)n;
    for (size_t i = 0; sd && i < n; i++)
        square += pow(value(i, user) - *mean, 2.0);
    if (sd)
        *sd = n > 1 ? sqrt(square / (double)(n - 1)) : NAN;
}

static double element(size_t i, const void *user)
{
    return ((const double *)user)[i];
}

void mean_and_sd_of(size_t n, const double v[], double *mean, double *sd)
{
    mean_and_sd(n, element, v, mean, sd);
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
