/* sim/contact.h -- the force between a floor and the core while they are in contact.
 *
 *   F = k p^1.5 (1 + a p'/v0) + c p',  F >= 0,  p > 0 indentation [m],  v0 approach speed at the onset of contact [m/s]
 *   k = 2 E sqrt(R) / (3 (1 - nu^2)),  nu = 0.3                                                           [N/m^1.5]
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
 * With a bumper, a spring k_b on the face that is hit, p = p_h + p_b is shared between steel and bumper so that
 *
 *   F_el = k p_h^1.5 = k_b p_b,   F = F_el (1 + (a s + a_b (1 - s)) p'/v0) + s c p',   s = dp_h/dp = k_b / (k_b + 1.5
 *   k sqrt(p_h))
 *
 * with c from F_el/p in place of k sqrt(p), and a_b such that a bumper alone rebounds like a linear spring and
 * dashpot of damping ratio zeta_b, e = exp(-pi zeta_b / sqrt(1 - zeta_b^2)). Each part loses its own share of the
 * energy that passes through it; the force has no state of its own, begins at zero and is never tensile.
 * docs/theory.md says why.
 *
 * The law would be tensile when separation is faster than v0/a: tension is clamped at zero, and the energy that the
 * clamp removes is reported. v0 is never taken smaller than v0_floor.
 * Source   Hunt and Crossley, J. Appl. Mech. 42 (1975) 440-445; Marhefka and Orin, IEEE Trans. SMC-A 29 (1999) 566-572
 *          (rebound equation); S. A. Anagnostopoulos, Earthquake Eng. Struct. Dyn. 16 (1988) 443-456 (e of zeta_b)
 * Threads  no state */
#pragma once

#include "base/status.h"
#include "sim/options.h"

typedef struct {
    double k;        /* [N/m^1.5] */
    double a;        /* [-] */
    double xi;       /* [-] of a dashpot */
    double xi_above; /* [m/s] it acts where p' is larger: 0, closing; -INFINITY: both ways */
    double v0_floor; /* [m/s] */
    double bumper;   /* [N/m] k_b; 0: none */
    double bumper_a; /* [-] a_b */
} Contact;

static const double PLANE_STRAIN = 1 - 0.3 * 0.3; /* [-] 1 - nu^2 */

/* With the bumper of the options. */
Status contact_make(Contact *c, const ContactOptions *o, Err *err);

/* Rebound over approach speed of an isolated impact, e(a): 1 at a = 0, falling to 0. */
double contact_rebound(double a);

/* Its inverse: a(e) for 0 < e <= 1. */
double contact_damping(double e);

/* Hertz, no damping: largest indentation [m] and duration [s] of an impact of mass m [kg] at speed v [m/s]. */
double contact_hertz_indentation(double k, double m, double v);
double contact_hertz_duration(double k, double m, double v);

/* pi sqrt(m/k_b) [s], of an impact on the bumper alone; 0 without a bumper. */
double contact_bumper_duration(const Contact *c, double m);

/* How the approach p > 0 [m] and its increments are shared between steel and bumper. */
typedef struct {
    double root;  /* [sqrt(m)] of the indentation p_h of the steel */
    double force; /* [N] elastic */
    double hertz; /* [N/m] 1.5 k sqrt(p_h), slope of the steel alone */
    double share; /* [-] dp_h/dp */
} ContactShare;
ContactShare contact_share(const Contact *c, double p);

/* Indentation of the steel [m] at approach p; the bumper has the rest. */
static inline double contact_indentation(const Contact *c, double p)
{
    if (!(c->bumper > 0 && p > 0))
        return p;
    const double root = contact_share(c, p).root;
    return root * root;
}

typedef struct {
    double force, raw, elastic; /* [N] clamped, as the law says, its elastic part */
    double dp, dv;              /* d force/d p [N/m], d force/d p' [N s/m] */
} ContactForce;

/* contact_force and contact_stored of a contact with a bumper. */
ContactForce contact_bumper_force(const Contact *c, double mass, double p, double p_dot, double v0);
double contact_bumper_stored(const Contact *c, double p);

/* p > 0; v0 not below v0_floor; mass [kg]: the effective mass of the contact. */
static inline ContactForce contact_force(const Contact *c, double mass, double p, double p_dot, double v0)
{
    if (c->bumper > 0)
        return contact_bumper_force(c, mass, p, p_dot, v0);
    const double root = sqrt(p), hertz = c->k * p * root, damping = c->a / v0, loss = 1.0 + damping * p_dot;
    ContactForce f = {.raw = hertz * loss, .elastic = hertz, .dp = 1.5 * c->k * root * loss, .dv = hertz * damping};
    if (c->xi > 0 && p_dot > c->xi_above) {
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

/* Elastic energy 2/5 k p_h^2.5 + k_b p_b^2 / 2 [J]. */
static inline double contact_stored(const Contact *c, double p)
{
    if (c->bumper > 0)
        return contact_bumper_stored(c, p);
    return p > 0 ? 0.4 * c->k * p * p * sqrt(p) : 0.0;
}
