#include "bench/stability/oracle.h"

enum { Q, V, INPUT, DAMPED, LOST, CLAMP, SIZE };

typedef struct {
    const Bob *bob;
    const Contact *contact;
    int side; /* 0: open */
    double v0;
    double a, slope; /* ground: a + slope t, t from the start of the step */
} Side;

static ContactForce force_at(const Side *s, const double y[SIZE])
{
    const double p = s->side * y[Q] - s->bob->gap;
    if (!s->side || p <= 0)
        return (ContactForce){0};
    return contact_force(s->contact, s->bob->mass, p, s->side * y[V], s->v0);
}

static void slopes(const Side *s, double t, const double y[SIZE], double d[SIZE])
{
    const double m = s->bob->mass, w = s->bob->omega, ground = s->a + s->slope * t;
    const ContactForce f = force_at(s, y);
    d[Q] = y[V];
    d[V] = -2 * s->bob->zeta * w * y[V] - w * w * y[Q] - ground - s->side * f.force / m;
    d[INPUT] = -m * ground * y[V];
    d[DAMPED] = m * 2 * s->bob->zeta * w * y[V] * y[V];
    d[LOST] = (f.raw - f.elastic) * s->side * y[V];
    d[CLAMP] = (f.force - f.raw) * s->side * y[V];
}

/* One classical step from x to x + h of dy/dx = y' dt/dx; t = x, or t = x^2 when `square`. */
static void rk4(const Side *s, int square, double x, double h, const double y[SIZE], double out[SIZE])
{
    static const double NODE[4] = {0, 0.5, 0.5, 1}, WEIGHT[4] = {1.0 / 6, 1.0 / 3, 1.0 / 3, 1.0 / 6};
    double d[SIZE] = {0}, at[SIZE], sum[SIZE] = {0};
    for (int k = 0; k < 4; k++) {
        const double xk = x + NODE[k] * h;
        for (int i = 0; i < SIZE; i++)
            at[i] = y[i] + NODE[k] * h * d[i];
        slopes(s, square ? xk * xk : xk, at, d);
        for (int i = 0; i < SIZE; i++) {
            d[i] *= square ? 2 * xk : 1;
            sum[i] += WEIGHT[k] * d[i];
        }
    }
    for (int i = 0; i < SIZE; i++)
        out[i] = y[i] + h * sum[i];
}

static void step(const Side *s, int fresh, double h, const double y[SIZE], double out[SIZE])
{
    enum { PARTS = 16 };
    if (!fresh) {
        rk4(s, 0, 0, h, y, out);
        return;
    }
    double from[SIZE];
    memcpy(from, y, sizeof from);
    for (int k = 0; k < PARTS; k++) {
        rk4(s, 1, sqrt(h) * k / PARTS, sqrt(h) / PARTS, from, out);
        memcpy(from, out, sizeof from);
    }
}

/* The share of the step after which side q - gap (or, with `speed`, v) changes sign. */
static double bisect(const Side *s, int fresh, double h, const double y[SIZE], int side, int speed, double at[SIZE])
{
    double low = 0, high = h;
    step(s, fresh, h, y, at);
    const int sign = speed ? at[V] > 0 : side * at[Q] - s->bob->gap > 0;
    for (int i = 0; i < 80 && high - low > 1e-17 * h; i++) {
        const double mid = 0.5 * (low + high);
        step(s, fresh, mid, y, at);
        if ((speed ? at[V] > 0 : side * at[Q] - s->bob->gap > 0) == sign)
            high = mid;
        else
            low = mid;
    }
    step(s, fresh, high, y, at);
    return high;
}

static void note(Oracle *o, const Side *s, const double y[SIZE])
{
    const double w = s->bob->omega, f = s->side * force_at(s, y).force;
    o->peak_u = fmax(o->peak_u, fabs(y[Q]));
    o->peak_a = fmax(o->peak_a, fabs(f / s->bob->mass + w * (w * y[Q] + 2 * s->bob->zeta * y[V])));
    o->penetration = fmax(o->penetration, fabs(y[Q]) - s->bob->gap);
    o->turnover = fmax(o->turnover, fmax(fabs(y[INPUT]), y[LOST]));
}

/* One step of at most h; returns the time gone. */
static double advance(Oracle *o, Side *s, int *fresh, double h, double y[SIZE])
{
    double end[SIZE], top[SIZE];
    const int was_fresh = *fresh;
    step(s, was_fresh, h, y, end);
    *fresh = 0;
    if (s->side && s->side * end[Q] - s->bob->gap <= 0) {
        h = bisect(s, was_fresh, h, y, s->side, 0, end);
        s->side = 0;
        o->opened = h;
    } else if (!s->side && fabs(end[Q]) > s->bob->gap) {
        const int side = end[Q] > 0 ? 1 : -1;
        if (side * y[Q] - s->bob->gap < 0)
            h = bisect(s, 0, h, y, side, 0, end);
        else if (side * y[V] < 0) { /* leaving, rounding aside */
            memcpy(y, end, sizeof end);
            return h;
        } else {
            h = 0;
            memcpy(end, y, sizeof end);
        }
        s->side = side;
        s->v0 = fmax(side * end[V], s->contact->v0_floor);
        o->impacts++;
        *fresh = 1;
    }
    if (h > 0 && y[V] * end[V] < 0) {
        Side before = *s;
        before.side = *fresh ? 0 : s->side;
        bisect(&before, was_fresh, h, y, 0, 1, top);
        note(o, &before, top);
    }
    memcpy(y, end, sizeof end);
    note(o, s, y);
    return h;
}

void oracle_run(Oracle *o, const Bob *bob, const Contact *contact, const Motion *motion, double duration,
                double free_step, double contact_step)
{
    memset(o, 0, sizeof *o);
    Side s = {.bob = bob, .contact = contact};
    double y[SIZE] = {0}, t = 0, opened = 0;
    int fresh = 0;
    o->penetration = -HUGE_VAL;
    for (size_t k = 0; t < duration; k++) {
        const int shaking = k + 1 < motion->n;
        const double from = (double)k * motion->dt_s, dt = shaking ? motion->dt_s : duration;
        const double slope = shaking ? (motion->accel[k + 1] - motion->accel[k]) / dt : 0;
        const double until = fmin(from + dt, duration);
        while (t < until) {
            s.slope = slope;
            s.a = shaking ? motion->accel[k] + slope * (t - from) : 0;
            const double left = until - t, h = fmin(left, s.side ? contact_step : free_step);
            o->opened = -1;
            const double gone = advance(o, &s, &fresh, h, y);
            if (o->opened >= 0)
                opened = t + o->opened;
            t = gone == left ? until : t + gone;
        }
    }
    o->q = y[Q];
    o->v = y[V];
    o->input = y[INPUT];
    o->damped = y[DAMPED];
    o->lost = y[LOST];
    o->clamp = y[CLAMP];
    o->opened = opened;
    o->penetration = fmax(o->penetration, 0);
    o->kinetic_strain = 0.5 * bob->mass * (y[V] * y[V] + bob->omega * bob->omega * y[Q] * y[Q]);
    if (s.side)
        o->stored = contact_stored(contact, s.side * y[Q] - bob->gap);
}
