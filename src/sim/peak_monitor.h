/* sim/peak_monitor.h -- peaks over continuous time from the points of a step-by-step integration.
 *
 * Points that follow each other without a break lie on one smooth arc: one step of an integrator with dense output, or
 * equal steps between two changes of contact. A parabola goes through every three successive ones of an arc and gives
 * a peak wherever its vertex lies within their span; they need not be equidistant. Error about (w h)^4 / 400 of a
 * component of frequency w sampled every h. Across a kink, or from one step to another of quite a different length, the
 * vertex says nothing: peak_monitor_break.
 *
 * Threads  no state */
#pragma once

#include "sim/model.h"

typedef enum {
    PEAK_DISPLACEMENT, /* u_j [m] */
    PEAK_DRIFT,        /* u_j - u_{j-1}, u_0 = 0 [m] */
    PEAK_ACCELERATION, /* u_j'' + a [m/s2] */
    PEAK_RELATIVE,     /* u_j - v_j [m] */
    PEAK_KINDS
} PeakKind;

typedef struct {
    double t;
    double of[PEAK_KINDS][POINTS_MAX];
} PeakPoint;

typedef struct {
    int n, count, arc; /* points of the model; points so far, of them on the present arc */
    PeakPoint ring[3];
    double peak[PEAK_KINDS][POINTS_MAX];
} PeakMonitor;

/* Where the caller writes the next point; peak_monitor_add takes it in and computes its interstorey drifts. */
static inline PeakPoint *peak_monitor_next(PeakMonitor *p)
{
    return &p->ring[p->count % 3];
}

/* Raises peaks to the vertex of the parabola through a, b and c, where its slopes at a and c differ in sign. */
static inline void peak_monitor_refine(PeakMonitor *p, const PeakPoint *a, const PeakPoint *b, const PeakPoint *c)
{
    const double h1 = b->t - a->t, h2 = c->t - b->t, span = h1 + h2, r1 = 1 / (h1 * span), r2 = 1 / (h2 * span);
    for (int kind = 0; kind < PEAK_KINDS; kind++)
        for (int j = 0; j < p->n; j++) {
            const double y = b->of[kind][j], d1 = (y - a->of[kind][j]) * r1, d2 = (c->of[kind][j] - y) * r2;
            const double curvature = d2 - d1, slope = h2 * d1 + h1 * d2; /* y + slope x + curvature x^2 */
            if ((slope - 2 * h1 * curvature) * (slope + 2 * h2 * curvature) < 0)
                p->peak[kind][j] = fmax(p->peak[kind][j], fabs(y - 0.25 * slope * slope / curvature));
        }
}

/* A point that is not later than the one before, or hardly, is dropped: it would give a slope of rounding errors. */
static inline void peak_monitor_add(PeakMonitor *p)
{
    PeakPoint *now = peak_monitor_next(p);
    const PeakPoint *before = &p->ring[(p->count + 2) % 3], *oldest = &p->ring[(p->count + 1) % 3];
    if (p->count > 0 && !(now->t > before->t * (1 + 1e-12)))
        return;
    for (int j = 0; j < p->n; j++)
        now->of[PEAK_DRIFT][j] = now->of[PEAK_DISPLACEMENT][j] - (j ? now->of[PEAK_DISPLACEMENT][j - 1] : 0.0);
    for (int kind = 0; kind < PEAK_KINDS; kind++)
        for (int j = 0; j < p->n; j++)
            if (fabs(now->of[kind][j]) > p->peak[kind][j])
                p->peak[kind][j] = fabs(now->of[kind][j]);
    if (p->arc > 1)
        peak_monitor_refine(p, oldest, before, now);
    p->count++;
    p->arc++;
}

/* Another arc begins: at the last point, or after it. */
static inline void peak_monitor_break(PeakMonitor *p, int at_last)
{
    p->arc = at_last && p->count > 0;
}
