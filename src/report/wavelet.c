#include "report/wavelet.h"

#include <math.h>

static double amplitude_at(size_t n, double dt, const double u[], double f, double t)
{
    const double s = WAVELET_CYCLES / (2 * M_PI * f);
    const long first = (long)ceil((t - 4 * s) / dt), last = (long)floor((t + 4 * s) / dt);
    double re = 0, im = 0, weight = 0;
    for (long k = first; k <= last; k++) {
        const double since = (double)k * dt - t, g = exp(-0.5 * (since / s) * (since / s));
        weight += g;
        if (k < 0 || (size_t)k >= n)
            continue;
        re += g * u[k] * cos(2 * M_PI * f * since);
        im -= g * u[k] * sin(2 * M_PI * f * since);
    }
    return weight > 0 ? 2 * hypot(re, im) / weight : 0;
}

void wavelet(size_t n, double dt, const double u[], size_t n_f, const double f[], size_t n_t, const double t[],
             double amplitude[])
{
#pragma omp parallel for schedule(dynamic, 1)
    for (size_t i = 0; i < n_f; i++)
        for (size_t k = 0; k < n_t; k++)
            amplitude[i * n_t + k] = amplitude_at(n, dt, u, f[i], t[k]);
}
