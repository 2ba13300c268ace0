/* sim/contact.h -- the force between a floor and the core while they are in contact.
 *
 *   F = k p^1.5 (1 + a p'/v0) + c p',  F >= 0,  p > 0 indentation [m],  v0 approach speed at the onset of contact [m/s]
 *   k = 2 E sqrt(R) / (3 (1 - nu^2))                                                                      [N/m^1.5]
 *
 *   paper                a = 1.5 (1 - r). An isolated impact then rebounds not with r but with e from
 *                        a (1+e) = ln((1+a)/(1-a e)).
 *   exact                a solves that equation for e = r, so that an isolated impact rebounds with r.
 *   lankarani-nikravesh  a = 0.75 (1 - r^2)            J. Mech. Des. 112 (1990) 369-376
 *   flores               a = 1.6 (1 - r) / r           Flores et al., Multibody Syst. Dyn. 25 (2011) 357-375
 *   jankowski            a = 0, c = 2 xi sqrt(m k sqrt(p)) while p' > 0, else 0; m the effective mass of the contact,
 *                        xi = 9 sqrt(5)/2 (1 - r^2) / (r (r (9 pi - 16) + 16))
 *                        Earthquake Eng. Struct. Dyn. 34 (2005) 595-611; 35 (2006) 517-524
 *
 * The law would be tensile when separation is faster than v0/a: tension is clamped at zero, and the energy that the
 * clamp removes is reported. v0 is never taken smaller than v0_floor.
 * Source   Hunt and Crossley, J. Appl. Mech. 42 (1975) 440-445; Marhefka and Orin, IEEE Trans. SMC-A 29 (1999) 566-572
 *          (rebound equation)
 * Threads  no state */
#ifndef IMTET_SIM_CONTACT_H
#define IMTET_SIM_CONTACT_H

#include <math.h>

#include "base/status.h"
#include "sim/options.h"

typedef struct {
    double k;        /* [N/m^1.5] */
    double a;        /* [-] */
    double xi;       /* [-] */
    double v0_floor; /* [m/s] */
} Contact;

Status contact_make(Contact *c, const ContactOptions *o, Err *err);

/* Rebound over approach speed of an isolated impact, e(a): 1 at a = 0, falling to 0. */
double contact_rebound(double a);

/* Its inverse: a(e) for 0 < e <= 1. */
double contact_damping(double e);

/* Hertz, no damping: largest indentation [m] and duration [s] of an impact of mass m [kg] at speed v [m/s]. */
double contact_hertz_indentation(double k, double m, double v);
double contact_hertz_duration(double k, double m, double v);

typedef struct {
    double force, raw, hertz; /* [N] clamped, as the law says, its elastic part k p^1.5 */
    double dp, dv;            /* d force/d p [N/m], d force/d p' [N s/m] */
} ContactForce;

/* p > 0; v0 not below v0_floor; mass [kg]: the effective mass of the contact. */
static inline ContactForce contact_force(const Contact *c, double mass, double p, double p_dot, double v0)
{
    const double root = sqrt(p), hertz = c->k * p * root, damping = c->a / v0, loss = 1.0 + damping * p_dot;
    ContactForce f = {.raw = hertz * loss, .hertz = hertz, .dp = 1.5 * c->k * root * loss, .dv = hertz * damping};
    if (c->xi > 0 && p_dot > 0) {
        const double dashpot = 2 * c->xi * sqrt(mass * c->k * root);
        f.raw += dashpot * p_dot;
        f.dp += 0.25 * dashpot * p_dot / p;
        f.dv += dashpot;
    }
    f.force = f.raw;
    if (f.raw <= 0) /* keeps NaN */
        f.force = f.dp = f.dv = 0;
    return f;
}

/* Elastic energy 2/5 k p^2.5 [J]. */
static inline double contact_stored(const Contact *c, double p)
{
    return p > 0 ? 0.4 * c->k * p * p * sqrt(p) : 0.0;
}

#endif
