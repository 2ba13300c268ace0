/* report/wavelet.h -- Morlet amplitude spectrum of a signal over time.
 *
 *   A(f, t) = |2 sum_k g_k u_k exp(-2 pi i f (t_k - t))| / sum_k g_k,   g_k = exp(-(t_k - t)^2 / (2 s^2)),
 *   s = WAVELET_CYCLES / (2 pi f),   |t_k - t| <= 4 s
 *
 * Morlet's wavelet, scaled so that a steady swing of amplitude a at frequency f shows as a. Before its first and after
 * its last sample the signal is taken as zero. Threads  no state */
#ifndef IMTET_REPORT_WAVELET_H
#define IMTET_REPORT_WAVELET_H

#include <stddef.h>

static const double WAVELET_CYCLES = 6;

/* u (n) every dt [s]; f (n_f) [Hz] below 1/(2 dt); t (n_t) [s]; amplitude (n_f, n_t) in the unit of u. */
void wavelet(size_t n, double dt, const double u[], size_t n_f, const double f[], size_t n_t, const double t[],
             double amplitude[]);

#endif
