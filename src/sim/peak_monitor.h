/* sim/peak_monitor.h -- peaks over continuous time from the points of a step-by-step integration.
 *
 * A parabola through three successive points gives the peak wherever the middle one is the largest by magnitude; the
 * points need not be equidistant. Error about (w h)^4 / 400 of a component of frequency w sampled every h. Where the
 * motion has a kink no parabola goes through it: peak_monitor_break.
 *
 * Threads  no state */
#pragma once

#include "base/units.h"
#include "sim/result.h"

typedef enum {
    PEAK_DISPLACEMENT, /* u_j [m] */
    PEAK_DRIFT,        /* u_j - u_{j-1}, u_0 = 0 [m] */
    PEAK_ACCELERATION, /* u_j'' + a [m/s2] */
    PEAK_RELATIVE,     /* u_j - v_j [m] */
    PEAK_KINDS
} PeakKind;

typedef struct {
    double t;
    double of[PEAK_KINDS][FLOORS_MAX];
} PeakPoint;

typedef struct {
    int n, count; /* floors; points so far */
    PeakPoint ring[3];
    double peak[PEAK_KINDS][FLOORS_MAX];
} PeakMonitor;

/* Where the caller writes the next point; peak_monitor_add takes it in and computes its interstorey drifts. */
static inline PeakPoint *peak_monitor_next(PeakMonitor *p)
{
    return &p->ring[p->count % 3];
}

/* Largest magnitude of the parabola through (0, y0), (h1, y1), (h1 + h2, y2), |y1| not below |y0|, |y2|. */
static inline double parabola_peak(double h1, double h2, double y0, double y1, double y2)
{
    const double d1 = (y1 - y0) / h1, d2 = (y2 - y1) / h2;
    const double curvature = (d2 - d1) / (h1 + h2), slope = d1 + curvature * h1; /* y1 + slope x + curvature x^2 */
    const double x = -slope / (2 * curvature);
    return x > -h1 && x < h2 ? fabs(y1 + 0.5 * slope * x) : fabs(y1);
}

static inline void peak_monitor_refine(PeakMonitor *p, const PeakPoint *a, const PeakPoint *b, const PeakPoint *c)
{
    for (int kind = 0; kind < PEAK_KINDS; kind++)
        for (int j = 0; j < p->n; j++) {
            const double ya = a->of[kind][j], yb = b->of[kind][j], yc = c->of[kind][j];
            if (fabs(yb) >= fabs(ya) && fabs(yb) >= fabs(yc))
                p->peak[kind][j] = fmax(p->peak[kind][j], parabola_peak(b->t - a->t, c->t - b->t, ya, yb, yc));
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
    if (p->count > 1)
        peak_monitor_refine(p, oldest, before, now);
    p->count++;
}

/* A kink at the last point. */
static inline void peak_monitor_break(PeakMonitor *p)
{
    if (p->count > 1)
        p->ring[0] = p->ring[(p->count - 1) % 3];
    p->count = p->count > 0;
}

static inline void peak_monitor_report(const PeakMonitor *p, SimResult *result)
{
    for (int j = 0; j < p->n; j++) {
        result->peak_displacement_m[j] = p->peak[PEAK_DISPLACEMENT][j];
        result->peak_drift_m[j] = p->peak[PEAK_DRIFT][j];
        result->peak_acceleration_g[j] = p->peak[PEAK_ACCELERATION][j] / GRAVITY;
        result->j1_m = fmax(result->j1_m, result->peak_displacement_m[j]);
        result->j2_m = fmax(result->j2_m, result->peak_drift_m[j]);
        result->j3_g = fmax(result->j3_g, result->peak_acceleration_g[j]);
    }
}
