/* sim/flow.h -- the exact flow of one mode under a load that is quadratic in time.
 *
 *   q'' + 2 zeta w q' + w^2 q = P0 + P1 x + P2 x^2,   x = t/h in [0, 1]
 *
 * Everything follows from the impulse response g(t) and its repeated integrals:
 *   y0 = g',  y1 = g,  y_{k+1}(h) = int_0^h y_k dt,      y_{k+2} = (h^k/k! - y_k - 2 zeta w y_{k+1}) / w^2
 * Holds for every damping ratio (0, below, at and above 1) and for w = 0. Where w h is small the recursion would lose
 * its digits and a power series stands in.
 * Threads  no state */
#pragma once

#include <stddef.h>

/* Rows of coefficients; each result is  Q q + V q' + C0 P0 + C1 P1 + C2 P2. */
enum {
    FLOW_Q = 0,  /* q(h)                          */
    FLOW_V = 5,  /* q'(h)                         */
    FLOW_I = 10, /* (1/h) int q dt    over the step */
    FLOW_K = 15, /* (1/h) int x q dt  over the step */
    FLOW_ROWS = 20
};

enum { FLOW_INTEGRALS = 7 };

/* y0..y6 at h > 0. */
void flow_integrals(double omega, double zeta, double h, double y[FLOW_INTEGRALS]);

/* Coefficients of n modes for the step h: coef (FLOW_ROWS, stride). */
void flow_coefficients(size_t n, const double omega[], const double zeta[], double h, double coef[], size_t stride);
