/* sim/contact.h -- the force between a floor and the core while they touch.
 *
 *   F = k p^1.5 (1 + a p'/v0),  p > 0 penetration [m],  v0 approach speed when this contact closed [m/s],  F >= 0
 *   k = 2 E sqrt(R) / (3 (1 - nu^2))                                            [N/m^1.5]
 *
 *   paper   a = 1.5 (1 - r). An isolated impact then rebounds not with r but with e from a (1+e) = ln((1+a)/(1-a e)).
 *   exact   a solves that equation for e = r, so that an isolated impact rebounds with r.
 *
 * The law would pull when separation is faster than v0/a: such tension is clamped at zero and what the clamp removes is
 * booked. v0 is never taken smaller than v0_floor. Source: Hunt and Crossley, J. Appl. Mech. 42 (1975) 440-445; Marhefka
 * and Orin, IEEE Trans. SMC-A 29 (1999) 566-572 (rebound equation).
 * Threads  no state */
#ifndef IMTET_SIM_CONTACT_H
#define IMTET_SIM_CONTACT_H

#include <math.h>

#include "base/settings.h"

typedef struct {
    double k;        /* [N/m^1.5] */
    double a;        /* [-] */
    double v0_floor; /* [m/s] */
} Contact;

Status contact_make(Contact *c, const Settings *s, Err *err);

/* Rebound over approach speed of an isolated impact, e(a): 1 at a = 0, falling to 0. */
double contact_rebound(double a);

/* Its inverse: a(e) for 0 < e <= 1. */
double contact_damping(double e);

/* Hertz, no damping: largest penetration [m] and duration [s] of an impact of mass m [kg] at speed v [m/s]. */
double contact_hertz_penetration(double k, double m, double v);
double contact_hertz_duration(double k, double m, double v);

typedef struct {
    double force, raw, hertz; /* [N] clamped, as the law says, its elastic part k p^1.5 */
    double dp, dv;            /* d force/d p [N/m], d force/d p' [N s/m] */
} ContactForce;

/* p > 0; v0 already floored. */
static inline ContactForce contact_force(const Contact *c, double p, double p_dot, double v0)
{
    const double root = sqrt(p), hertz = c->k * p * root, loss = 1.0 + c->a * p_dot / v0;
    ContactForce f = {.raw = hertz * loss, .hertz = hertz, .dp = 1.5 * c->k * root * loss, .dv = hertz * c->a / v0};
    f.force = f.raw;
    if (!(f.raw > 0) && loss <= 0) /* keeps NaN */
        f.force = f.dp = f.dv = 0;
    return f;
}

/* Elastic energy 2/5 k p^2.5 [J]. */
static inline double contact_stored(const Contact *c, double p)
{
    return p > 0 ? 0.4 * c->k * p * p * sqrt(p) : 0.0;
}

#endif
