#include "sim/contact.h"

/* Zero when e is the rebound that belongs to a; falls with e. */
static double mismatch(double a, double e)
{
    return a * (1 + e) - log1p(a) + log1p(-a * e);
}

/* The root of mismatch in e: between 0, where it is positive, and min(1, 1/a), where it is negative. */
double contact_rebound(double a)
{
    if (a < 1e-9)
        return 1 - 2.0 / 3.0 * a;
    double low = 0, high = a > 1 ? 1 / a : 1;
    for (int i = 0; i < 200 && high - low > 1e-16 * high; i++) {
        const double e = 0.5 * (low + high);
        if (mismatch(a, e) > 0)
            low = e;
        else
            high = e;
    }
    return 0.5 * (low + high);
}

double contact_damping(double e)
{
    double low = 0, high = 1 / e;
    for (int i = 0; i < 200 && high - low > 1e-16 * high; i++) {
        const double a = 0.5 * (low + high);
        if (contact_rebound(a) > e)
            low = a;
        else
            high = a;
    }
    return 0.5 * (low + high);
}

double contact_hertz_indentation(double k, double m, double v)
{
    return pow(1.25 * m * v * v / k, 0.4);
}

double contact_hertz_duration(double k, double m, double v)
{
    return 2.943275184 * contact_hertz_indentation(k, m, v) / v; /* 2 int_0^1 dx / sqrt(1 - x^2.5) */
}

Status contact_make(Contact *c, const ContactOptions *o, Err *err)
{
    const double r = o->restitution, nu = o->poisson;
    const ContactLaw law = o->law;
    if (r < 0.01 && (law == LAW_EXACT || law == LAW_FLORES || law == LAW_JANKOWSKI))
        return fail(
            err, STATUS_BAD_DATA,
            "contact.restitution: %g cannot be had with this contact.law (its damping grows without bound); use "
            "0.01 or more, or contact.law = paper",
            r);
    c->k = 2 * o->youngs_modulus_pa * sqrt(o->radius_m) / (3 * (1 - nu * nu));
    c->a = c->xi = 0;
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
    c->v0_floor = o->v0_min_m_s;
    return STATUS_OK;
}
