/* base/rprop.h -- resilient back-propagation: the step of each variable follows the signs of its derivative alone.
 *
 * A step grows by 1.2 while the derivative keeps its sign and is halved where it changes; then the variable stays for
 * once, and the derivative counts as 0 next time.
 *
 * Threads  no state but the caller's
 * Source   Riedmiller and Braun, ICNN 1993, 586-591 (both factors) */
#pragma once

/* By how much a variable with derivative g moves against it; *last is its derivative of the step before, 0 at first. */
static inline double rprop_move(double g, double *last, double *step)
{
    const double same_sign = g * *last;
    *step *= same_sign > 0.0 ? 1.2 : same_sign < 0.0 ? 0.5 : 1.0;
    *last = same_sign < 0.0 ? 0.0 : g;
    return *last > 0.0 ? -*step : *last < 0.0 ? *step : 0.0;
}
