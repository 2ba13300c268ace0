/* motion/spectrum.h -- response spectrum and intensity measures of a ground motion.
 *
 *   u'' + 2 zeta w u' + w^2 u = -a(t):   Sd = max |u|,  PSv = w Sd,  PSa = w^2 Sd     w = 2 pi / T
 *
 * by the closed form for an acceleration that is linear between samples (Nigam and Jennings, Bull. Seism. Soc. Am. 59
 * (1969) 909-922), maxima over continuous time, free vibration after the end included for half a period.
 *   Arias = pi / (2 g) int a^2 dt  [m/s],  CAV = int |a| dt  [m/s],  D5-95 = time from 5 % to 95 % of Arias  [s]
 *
 * Threads  no state */
#pragma once

#include "motion/motion.h"

/* PSa [m/s2] at n periods T [s]; damping ratio zeta in [0, 1). */
void spectrum_psa(const Motion *m, double zeta, size_t n, const double T[], double psa[]);

typedef struct {
    double pga_m_s2, pgv_m_s, pgd_m; /* velocity and displacement by exact integration, no baseline correction */
    double duration_s, arias_m_s, cav_m_s, d5_95_s;
} MotionFigures;
void motion_figures(const Motion *m, MotionFigures *out);

/* At each sample, all (n): velocity [m/s], displacement [m] and Husid's curve, the share 0..1 of Arias so far. */
void motion_histories(const Motion *m, double velocity[], double displacement[], double husid[]);
