/* sim/fast/touch.h -- one contact over one step, given its penetration at both ends.
 *
 * Inside the step the penetration is the cubic p(x) through p0, p0', p1, p1' (Hermite; error O(h^4)), x = t/h. Where it
 * is positive the force law is integrated by Gauss points, spaced by x ~ y^2 next to a closing or an opening where
 * F ~ t^1.5 would spoil their order. Closings inside the step are located on the cubic and set v0.
 *
 * The result is what the modes need: the force at the end and its mean over the step, with derivatives for Newton's
 * method, and the energy books along the same path. */
#ifndef IMTET_SIM_FAST_TOUCH_H
#define IMTET_SIM_FAST_TOUCH_H

#include "sim/contact.h"
#include "sim/fast/vec.h"

/* contact_force at four points; a point where p is not positive has no force. */
typedef struct {
    v4 force, raw, hertz, dp, dv;
} ContactForce4;

static inline ContactForce4 contact_force4(const Contact *c, double mass, v4 p_any, v4 v, double v0)
{
    const v4 zero = {0}, p = v4_where(p_any <= zero, zero, p_any); /* keeps NaN */
    const v4 root = v4_sqrt(p), hertz = c->k * p * root, loss = 1.0 + c->a / v0 * v;
    ContactForce4 f = {.raw = hertz * loss, .hertz = hertz, .dp = 1.5 * c->k * root * loss, .dv = hertz * (c->a / v0)};
    if (c->xi > 0) {
        const v4 dashpot = v4_where((v > zero) & (p > zero), 2 * c->xi * v4_sqrt(mass * c->k * root), zero);
        f.raw += dashpot * v;
        f.dp += v4_where(p > zero, 0.25 * dashpot * v / p, zero);
        f.dv += dashpot;
    }
    const m4 pulls = f.raw <= zero;
    f.force = v4_where(pulls, zero, f.raw);
    f.dp = v4_where(pulls, zero, f.dp);
    f.dv = v4_where(pulls, zero, f.dv);
    return f;
}

typedef struct {
    double end, mean;              /* [N] force at x = 1; int_0^1 F dx */
    double end_p, end_v;           /* d end / d p1, d p1' */
    double mean_p, mean_v;         /* d mean / d p1, d p1' */
    double v0;                     /* [m/s] of the contact that is open at x = 1 */
    int closings, floored;         /* new contacts in this step, those whose v0 was below the floor */
    double closed_at, closed_with; /* x and speed [m/s] of the last of them */
    double lost, clamped;          /* [J] int k p^1.5 a p'^2/v0 dt, int (F - F_raw) p' dt */
} Touch;

typedef struct {
    double c[4]; /* p(x) = c0 + c1 x + c2 x^2 + c3 x^3 */
    double h;
} Path;

static inline Path path_make(double h, double p0, double v0, double p1, double v1)
{
    return (Path){{p0, h * v0, 3 * (p1 - p0) - h * (2 * v0 + v1), 2 * (p0 - p1) + h * (v0 + v1)}, h};
}

static inline double path_at(const Path *q, double x)
{
    return q->c[0] + x * (q->c[1] + x * (q->c[2] + x * q->c[3]));
}

/* dp/dx */
static inline double path_slope(const Path *q, double x)
{
    return q->c[1] + x * (2 * q->c[2] + x * 3 * q->c[3]);
}

/* The root of a monotone piece with a change of sign: Newton from the chord, kept inside the bracket. */
static inline double path_root(const Path *q, double low, double high)
{
    const double p_low = path_at(q, low), p_high = path_at(q, high);
    const int rising = p_low < p_high;
    double x = low + (high - low) * (p_low / (p_low - p_high));
    for (int i = 0; i < 60; i++) {
        const double p = path_at(q, x);
        if ((p > 0) == rising)
            high = x;
        else
            low = x;
        const double next = x - p / path_slope(q, x);
        const double x_new = next > low && next < high ? next : 0.5 * (low + high);
        if (fabs(x_new - x) < 1e-9) /* what is left is of its square */
            return x_new;
        x = x_new;
    }
    return x;
}

/* Turning points inside (0, 1), ascending; returns how many. */
static inline int path_turns(const Path *q, double x[2])
{
    const double a = 3 * q->c[3], b = q->c[2], c = q->c[1]; /* a x^2 + 2 b x + c */
    const double d = b * b - a * c;
    if (!(d > 0))
        return 0;
    const double w = -(b + copysign(sqrt(d), b));
    double r1 = w / a, r2 = c / w;
    if (r1 > r2) {
        const double t = r1;
        r1 = r2;
        r2 = t;
    }
    int n = 0;
    if (r1 > 0 && r1 < 1)
        x[n++] = r1;
    if (r2 > 0 && r2 < 1)
        x[n++] = r2;
    return n;
}

/* Adds the part [xa, xb] of the path, on which p > 0: Gauss-Legendre, four points at once, in y with x = xa + (xb - xa)
 * s(y), s = y^2 after a closing, y (2 - y) before an opening, y^2 (3 - 2 y) with both. */
static inline void touch_add(Touch *t, const Contact *c, double mass, const Path *q, double xa, double xb, double v0)
{
    static const v4 WEIGHT = {0.17392742256872692, 0.32607257743127307, 0.32607257743127307, 0.17392742256872692};
    static const v4 Y = {0.06943184420297371, 0.33000947820757187, 0.6699905217924281, 0.9305681557970263};
    const double length = xb - xa;
    const int closing = xa > 0, opening = xb < 1;
    v4 share = Y, slope = {1, 1, 1, 1};
    if (closing && opening) {
        share = Y * Y * (3 - 2 * Y);
        slope = 6 * Y * (1 - Y);
    } else if (closing) {
        share = Y * Y;
        slope = 2 * Y;
    } else if (opening) {
        share = Y * (2 - Y);
        slope = 2 - 2 * Y;
    }
    const v4 x = xa + length * share, weight = length * WEIGHT * slope;
    const v4 p = q->c[0] + x * (q->c[1] + x * (q->c[2] + x * q->c[3]));
    const double per_h = 1 / q->h;
    const v4 v = (q->c[1] + x * (2 * q->c[2] + x * 3 * q->c[3])) * per_h;
    const ContactForce4 f = contact_force4(c, mass, p, v, v0);
    t->mean += v4_sum(weight * f.force);
    /* dp/dp1 = x^2 (3 - 2x), dp/dp1' = h x^2 (x - 1) and their slopes */
    t->mean_p += v4_sum(weight * (f.dp * x * x * (3 - 2 * x) + f.dv * 6 * x * (1 - x) * per_h));
    t->mean_v += v4_sum(weight * (f.dp * q->h * x * x * (x - 1) + f.dv * x * (3 * x - 2)));
    t->lost += q->h * v4_sum(weight * (f.raw - f.hertz) * v);
    t->clamped += q->h * v4_sum(weight * (f.force - f.raw) * v);
}

/* closed: a contact is open at x = 0 with approach speed v0. */
static inline void touch_step(Touch *t, const Contact *c, double mass, double h, double p0, double v_0, double p1,
                              double v_1, int closed, double v0)
{
    const Path q = path_make(h, p0, v_0, p1, v_1);
    double knots[4] = {0}, turns[2];
    int n = 0;
    *t = (Touch){.v0 = v0};
    /* the control polygon encloses the path: all of it positive or negative settles the common cases */
    const double b1 = p0 + q.c[1] / 3, b2 = p1 - h * v_1 / 3;
    if (closed && p0 > 0 && b1 > 0 && b2 > 0 && p1 > 0) {
        touch_add(t, c, mass, &q, 0, 1, v0);
    } else if (p0 > 0 || b1 > 0 || b2 > 0 || p1 > 0) {
        const int n_turns = path_turns(&q, turns);
        for (int i = 0; i < n_turns; i++)
            knots[++n] = turns[i];
        knots[++n] = 1;
        double from = 0;
        int touching = closed && p0 > 0;
        for (int i = 0; i < n; i++) {
            const double low = knots[i], high = knots[i + 1];
            const int above = (i + 1 == n ? p1 : path_at(&q, high)) > 0;
            if (above == touching)
                continue;
            const double x = (path_at(&q, low) > 0) == above ? low : path_root(&q, low, high);
            if (touching) {
                touch_add(t, c, mass, &q, from, x, t->v0);
            } else {
                const double speed = fabs(path_slope(&q, x) / h);
                t->closings++;
                t->floored += speed < c->v0_floor;
                t->v0 = fmax(speed, c->v0_floor);
                t->closed_at = x;
                t->closed_with = speed;
                from = x;
            }
            touching = !touching;
        }
        if (touching)
            touch_add(t, c, mass, &q, from, 1, t->v0);
    }
    if (p1 > 0) {
        const ContactForce f = contact_force(c, mass, p1, v_1, t->v0);
        t->end = f.force;
        t->end_p = f.dp;
        t->end_v = f.dv;
    }
}

#endif
