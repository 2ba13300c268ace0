/* sim/device.h -- a device between two points of a scene: a dashpot, a spring with one.
 *
 *   d = B . q [m] how far the points are apart,  F = k d + c d' (d'^2 + v_r^2)^((a - 1) / 2)
 *
 * F pulls them together. a = 1: a linear dashpot; else F = c |d'|^a but for rates below v_r = 1 mm/s, where that has no
 * slope; a = 0: friction of the force c, with v_r = 1 cm/s: what sticks creeps, at 1 mm/s under c / 10.
 *
 * The mat of a core that lifts is one more, F by scene/uplift.h.
 *
 * Energy  int F d' dt = k d^2 / 2 (held) + lost
 *
 * Threads  pure functions
 * Source   power law: T. T. Soong, M. C. Constantinou (eds), Passive and Active Structural Vibration Control in Civil
 *          Engineering (1994) */
#pragma once

#include "scene/uplift.h"

typedef struct {
    int floor;                /* from 0, on which it acts; -1: the foundation, whose mat lifts: */
    Uplift lifts;             /* d [rad], F [N m] */
    double stiffness;         /* [N/m] k; 0: none */
    double damping, exponent; /* [N (s/m)^a] c, [-] a */
} Device;

/* The part of the rate v [m/s]; *slope: dF/dv. */
static inline double device_viscous(const Device *e, double v, double *slope)
{
    const double turn = e->exponent == 0 ? 1e-4 : 1e-6, square = v * v + turn;
    const double power = e->exponent == 1 ? 1 : pow(square, 0.5 * (e->exponent - 1));
    *slope = e->damping * power * (e->exponent * v * v + turn) / square;
    return e->damping * power * v;
}
