/* sim/reference/tally.h -- what the step-by-step engines note on their way: peaks over continuous time, and the books.
 *
 *   peaks     a parabola through three successive points wherever the middle one is the largest by magnitude; the
 * points need not be equidistant. Error about (w h)^4 / 400 of a component of frequency w noted every h. books input =
 * kinetic + strain + damped + contacts (stored + lost + clamp)
 *
 * Threads  no state */
#ifndef IMTET_SIM_REFERENCE_TALLY_H
#define IMTET_SIM_REFERENCE_TALLY_H

#include <math.h>
#include <stdio.h>

#include "base/units.h"
#include "sim/sim.h"

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
    int n, count; /* floors; points noted so far */
    PeakPoint ring[3];
    double peak[PEAK_KINDS][FLOORS_MAX];
} Peaks;

/* Where the caller writes the next point; peaks_note takes it in. Drifts are filled in here. */
static inline PeakPoint *peaks_next(Peaks *p)
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

static inline void peaks_refine(Peaks *p, const PeakPoint *a, const PeakPoint *b, const PeakPoint *c)
{
    for (int kind = 0; kind < PEAK_KINDS; kind++)
        for (int j = 0; j < p->n; j++) {
            const double ya = a->of[kind][j], yb = b->of[kind][j], yc = c->of[kind][j];
            if (fabs(yb) >= fabs(ya) && fabs(yb) >= fabs(yc))
                p->peak[kind][j] = fmax(p->peak[kind][j], parabola_peak(b->t - a->t, c->t - b->t, ya, yb, yc));
        }
}

/* A point that is not later than the one before is dropped. */
static inline void peaks_note(Peaks *p)
{
    PeakPoint *now = peaks_next(p);
    const PeakPoint *before = &p->ring[(p->count + 2) % 3], *oldest = &p->ring[(p->count + 1) % 3];
    if (p->count > 0 && !(now->t > before->t))
        return;
    for (int j = 0; j < p->n; j++)
        now->of[PEAK_DRIFT][j] = now->of[PEAK_DISPLACEMENT][j] - (j ? now->of[PEAK_DISPLACEMENT][j - 1] : 0.0);
    for (int kind = 0; kind < PEAK_KINDS; kind++)
        for (int j = 0; j < p->n; j++)
            if (fabs(now->of[kind][j]) > p->peak[kind][j])
                p->peak[kind][j] = fabs(now->of[kind][j]);
    if (p->count > 1)
        peaks_refine(p, oldest, before, now);
    p->count++;
}

static inline void peaks_report(const Peaks *p, SimResult *result)
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

/* From the joules already in result (input, kinetic_strain, contacts) and damped[nb + nc], building modes first. With
 * no energy put in every share is zero. */
static inline void books_close(SimResult *result, int nb, int nc, const double damped[])
{
    double building = 0, core = 0;
    const double input = result->input_energy_j, percent = input > 0 ? 100 / input : 0;
    for (int i = 0; i < nb; i++) {
        building += damped[i];
        result->mode_share_pct[i] = percent * damped[i];
        if (i >= 4 && i < 10)
            result->ed5_10_pct += percent * damped[i];
    }
    for (int i = nb; i < nb + nc; i++)
        core += damped[i];
    result->damped_building_j = building;
    result->damped_core_j = core;
    result->ed1_pct = result->mode_share_pct[0];
    result->edcs_pct = percent * core;
    const double out = result->kinetic_strain_j + building + core + result->contact_stored_j + result->contact_loss_j +
                       result->clamp_j;
    result->energy_residual = fabs(input - out) / energy_books_scale(input, out);
    if (!isfinite(input - out)) {
        result->outcome = RUN_NOT_FINITE;
        snprintf(result->reason, sizeof result->reason, "the energies are not finite at the end of the run");
    }
}

#endif
