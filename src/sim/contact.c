#include "sim/contact.h"

/* Zero when e is the rebound that belongs to a; falls with e. */
static double mismatch(double a, double e)
{
    return a * (1 + e) - log1p(a) + log1p(-a * e);
}

/* The root of mismatch by bisection from 0, where it is positive, to `high`, where it is negative: in e for a given a,
 * in a for a given e. NAN: the one that is looked for. */
static double mismatch_root(double a, double e, double high)
{
    double low = 0;
    for (int i = 0; i < 200 && high - low > 1e-16 * high; i++) {
        const double x = 0.5 * (low + high);
        if (mismatch(isnan(a) ? x : a, isnan(e) ? x : e) > 0)
            low = x;
        else
            high = x;
    }
    return 0.5 * (low + high);
}

double contact_rebound(double a)
{
    return a < 1e-9 ? 1 - 2.0 / 3.0 * a : mismatch_root(a, NAN, a > 1 ? 1 / a : 1);
}

/* Above 0, where both sides vanish, mismatch is positive and falls without bound towards 1/e. Near e = 1 it is of third
 * order in a, and lost in rounding. */
double contact_damping(double e)
{
    return 1 - e < 1e-5 ? 1.5 * (1 - e) : mismatch_root(NAN, e, 1 / e);
}

double contact_hertz_indentation(double k, double m, double v)
{
    return pow(1.25 * m * v * v / k, 0.4);
}

double contact_hertz_duration(double k, double m, double v)
{
    return 2.943275184 * contact_hertz_indentation(k, m, v) / v; /* 2 int_0^1 dx / sqrt(1 - x^2.5) */
}

double contact_bumper_duration(const Contact *c, double m)
{
    return c->bumper > 0 ? M_PI * sqrt(m / c->bumper) : 0;
}

ContactShare contact_share(const Contact *c, double p)
{
    /* y > 0 with y^3 + y^2 = q by Halley's method, which here converges from any start: sqrt(p_h) in units of k_b/k. */
    const double ratio = c->k / c->bumper, q = p * ratio * ratio;
    double y = sqrt(q / (1 + sqrt(sqrt(q))));
    for (int i = 0; i < 20; i++) {
        const double g = y * y * (y + 1) - q, slope = y * (3 * y + 2);
        const double step = 2 * g * slope / (2 * slope * slope - g * (6 * y + 2));
        y -= step;
        if (!(fabs(step) > 1e-6 * y)) /* what is left is of its cube */
            break;
    }
    const double root = y / ratio, hertz = 1.5 * c->k * root;
    return (ContactShare){
        .root = root, .force = c->k * root * root * root, .hertz = hertz, .share = c->bumper / (hertz + c->bumper)};
}

ContactForce contact_bumper_force(const Contact *c, double mass, double p, double p_dot, double v0)
{
    const ContactShare s = contact_share(c, p);
    const double slope = s.share * s.hertz, apart = (c->a - c->bumper_a) / v0;
    const double damping = c->bumper_a / v0 + apart * s.share;
    /* F d share/dp, with d hertz/dp = share hertz / (2 p_h) */
    const double share_slope = -s.share * s.share * s.share * s.hertz * s.hertz / (3 * c->bumper);
    ContactForce f = {.raw = s.force * (1 + damping * p_dot),
                      .elastic = s.force,
                      .dp = slope * (1 + damping * p_dot) + apart * share_slope * p_dot,
                      .dv = s.force * damping};
    if (c->xi > 0 && p_dot > c->xi_above) {
        const double dashpot = 2 * c->xi * s.share * sqrt(mass * s.force / p);
        f.raw += dashpot * p_dot;
        f.dp += dashpot * p_dot * (share_slope / (s.share * s.force) + 0.5 * (slope / s.force - 1 / p));
        f.dv += dashpot;
    }
    f.force = f.raw;
    if (f.raw <= 0) /* keeps NaN */
        f.force = f.dp = f.dv = 0;
    return f;
}

double contact_bumper_stored(const Contact *c, double p)
{
    if (!(p > 0))
        return 0;
    const ContactShare s = contact_share(c, p);
    return s.force * (0.4 * s.root * s.root + 0.5 * s.force / c->bumper);
}

Status contact_make(Contact *c, const ContactOptions *o, Err *err)
{
    const double r = o->restitution;
    const ContactLaw law = o->law;
    if (r < 0.01 && (law == LAW_EXACT || law == LAW_FLORES || law == LAW_JANKOWSKI))
        return bad_data(
            err,
            "contact.restitution: %g cannot be had with this contact.law (its damping grows without bound); use "
            "0.01 or more, or contact.law = paper",
            r);
    c->k = 2 * o->youngs_modulus_pa * sqrt(o->radius_m) / (3 * PLANE_STRAIN);
    c->a = c->xi = c->xi_above = 0;
    switch (law) {
    case LAW_PAPER:
        c->a = 1.5 * (1 - r);
        break;
    case LAW_EXACT:
        c->a = contact_damping(r);
        break;
    case LAW_LANKARANI_NIKRAVESH:
        c->a = 0.75 * (1 - r * r);
        break;
    case LAW_FLORES:
        c->a = 1.6 * (1 - r) / r;
        break;
    case LAW_JANKOWSKI:
        c->xi = 4.5 * sqrt(5.0) * (1 - r * r) / (r * (r * (9 * M_PI - 16) + 16));
        break;
    }
    c->v0_floor = 1e-3; /* a tenth of it changes no digit of a tower (docs/measured/contact-v0.csv) */
    c->bumper = o->bumper_stiffness_n_m;

    /* A bumper rebounds like a linear spring and dashpot of damping ratio zeta, from contact to contact. */
    const double zeta = o->bumper_damping;
    c->bumper_a = zeta > 0 ? contact_damping(exp(-M_PI * zeta / sqrt(1 - zeta * zeta))) : 0;
    return STATUS_OK;
}
