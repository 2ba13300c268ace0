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

/* contact_force at four points, with the slopes of force - hertz as far as the clamp does not hold; a point where p is
 * not positive has no force. */
typedef struct {
    v4 force, raw, hertz, dp, dv, loss_dp, loss_dv;
} ContactForce4;

static inline ContactForce4 contact_force4(const Contact *c, double mass, v4 p_any, v4 v, double v0)
{
    const double damping = c->a / v0;
    const v4 zero = {0}, p = v4_where(p_any <= zero, zero, p_any); /* keeps NaN */
    const v4 root = v4_sqrt(p), stiff = c->k * root, hertz = stiff * p, damped = damping * v;
    ContactForce4 f = {
        .raw = hertz + hertz * damped, .hertz = hertz, .loss_dp = 1.5 * stiff * damped, .loss_dv = hertz * damping};
    if (c->xi > 0) {
        const v4 dashpot = v4_where((v > zero) & (p > zero), 2 * c->xi * v4_sqrt(mass * stiff), zero);
        f.raw += dashpot * v;
        f.loss_dp += v4_where(p > zero, 0.25 * dashpot * v / p, zero);
        f.loss_dv += dashpot;
    }
    const m4 pulls = f.raw <= zero;
    f.force = v4_where(pulls, zero, f.raw);
    f.dp = v4_where(pulls, zero, f.loss_dp + 1.5 * stiff);
    f.dv = v4_where(pulls, zero, f.loss_dv);
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
    double lost_p, lost_v;         /* d lost / d p1, d p1' */
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
        if (fabs(x_new - x) < 1e-7) /* what is left is of its square */
            return x_new;
        x = x_new;
    }
    return x;
}

/* Turning points inside (0, 1), ascending; returns how many. */
static inline int path_turns(const Path *q, double x[2])
{
    const double a = 3 * q->c[3], b = q->c[2], c = q->c[1]; /* a x^2 + 2 b x + c */
    const double d = b * b - a * c, middle = c + b,
                 end = c + 2 * b + a; /* control points of the slope: c, middle, end */
    if ((c > 0 && middle > 0 && end > 0) || (c < 0 && middle < 0 && end < 0))
        return 0;
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

/* Four points of a path, what their p and p' owe to the end of it, and the weights of an integral over x. */
typedef struct {
    v4 p, v, weight;
    v4 p_p1, p_v1, v_p1, v_v1; /* d p / d p1, d p / d p1', d p' / d p1, d p' / d p1' */
} Points;

static inline void touch_sum(Touch *t, const Contact *c, double mass, double h, const Points *at, double v0)
{
    const ContactForce4 f = contact_force4(c, mass, at->p, at->v, v0);
    const v4 loss = at->weight * (f.raw - f.hertz), lost = loss * at->v;
    const v4 by_p = at->weight * f.loss_dp * at->v, by_v = at->weight * f.loss_dv * at->v + loss;
    const v4 sums = v4_sums(at->weight * f.force, at->weight * (f.dp * at->p_p1 + f.dv * at->v_p1),
                            at->weight * (f.dp * at->p_v1 + f.dv * at->v_v1), lost);
    const v4 more = v4_sums(at->weight * (f.force - f.raw) * at->v, (v4){0}, by_p * at->p_p1 + by_v * at->v_p1,
                            by_p * at->p_v1 + by_v * at->v_v1);
    t->mean += sums[0];
    t->mean_p += sums[1];
    t->mean_v += sums[2];
    t->lost += h * sums[3];
    t->clamped += h * more[0];
    t->lost_p += h * more[2];
    t->lost_v += h * more[3];
}

/* Gauss-Legendre on [0, 1]. */
#define GAUSS_WEIGHT ((v4){0.17392742256872692, 0.32607257743127307, 0.32607257743127307, 0.17392742256872692})
#define GAUSS_POINT  ((v4){0.06943184420297371, 0.33000947820757187, 0.6699905217924281, 0.9305681557970263})

/* Adds the part [xa, xb] of the path, on which p > 0: four points in y with x = xa + (xb - xa) s(y), s = y^2 after a
 * closing, y (2 - y) before an opening, y^2 (3 - 2 y) with both. */
static inline void touch_add(Touch *t, const Contact *c, double mass, const Path *q, double xa, double xb, double v0)
{
    const v4 y = GAUSS_POINT;
    const double length = xb - xa, per_h = 1 / q->h;
    const int closing = xa > 0, opening = xb < 1;
    v4 share = y, slope = {1, 1, 1, 1};
    if (closing && opening) {
        share = y * y * (3 - 2 * y);
        slope = 6 * y * (1 - y);
    } else if (closing) {
        share = y * y;
        slope = 2 * y;
    } else if (opening) {
        share = y * (2 - y);
        slope = 2 - 2 * y;
    }
    const v4 x = xa + length * share;
    const Points at = {
        .p = q->c[0] + x * (q->c[1] + x * (q->c[2] + x * q->c[3])),
        .v = (q->c[1] + x * (2 * q->c[2] + x * 3 * q->c[3])) * per_h,
        .weight = length * GAUSS_WEIGHT * slope,
        .p_p1 = x * x * (3 - 2 * x),
        .p_v1 = q->h * x * x * (x - 1),
        .v_p1 = 6 * x * (1 - x) * per_h,
        .v_v1 = x * (3 * x - 2),
    };
    touch_sum(t, c, mass, q->h, &at, v0);
}

/* The force at the end of a path that ends in contact. */
static inline void touch_end(Touch *t, const Contact *c, double mass, double p1, double v_1)
{
    const ContactForce f = contact_force(c, mass, p1, v_1, t->v0);
    t->end = f.force;
    t->end_p = f.dp;
    t->end_v = f.dv;
}

/* All of the path is in contact. */
static inline void touch_through(Touch *t, const Contact *c, double mass, double h, double p0, double v_0, double p1,
                                 double v_1, double v0)
{
    const v4 x = GAUSS_POINT, rise = x * x * (3 - 2 * x), steep = 6 * x * (1 - x);
    const double per_h = 1 / h;
    const Points at = {
        .p = p0 * (1 - rise) + p1 * rise + h * (v_0 * (x * (1 - x) * (1 - x)) + v_1 * (x * x * (x - 1))),
        .v = (p1 - p0) * per_h * steep + v_0 * (1 - x) * (1 - 3 * x) + v_1 * (x * (3 * x - 2)),
        .weight = GAUSS_WEIGHT,
        .p_p1 = rise,
        .p_v1 = h * (x * x * (x - 1)),
        .v_p1 = per_h * steep,
        .v_v1 = x * (3 * x - 2),
    };
    *t = (Touch){.v0 = v0};
    touch_sum(t, c, mass, h, &at, v0);
    touch_end(t, c, mass, p1, v_1);
}

/* closed: a contact is open at x = 0 with approach speed v0. */
static inline void touch_step(Touch *t, const Contact *c, double mass, double h, double p0, double v_0, double p1,
                              double v_1, int closed, double v0)
{
    const Path q = path_make(h, p0, v_0, p1, v_1);
    double knots[4] = {0}, turns[2];
    int n = 0;
    *t = (Touch){.v0 = v0};
    /* the control polygon encloses the path */
    const double b1 = p0 + q.c[1] / 3, b2 = p1 - h * v_1 / 3;
    if (p0 > 0 || b1 > 0 || b2 > 0 || p1 > 0) {
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
    if (p1 > 0)
        touch_end(t, c, mass, p1, v_1);
}

#endif
