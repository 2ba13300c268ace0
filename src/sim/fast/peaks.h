/* sim/fast/peaks.h -- maxima over continuous time: in flight from the Hermite cubic, in contact from three steps.
 * Part of the kernel: static functions, compiled once per instruction set. See fast.h for the method. */
#ifndef IMTET_SIM_FAST_PEAKS_H
#define IMTET_SIM_FAST_PEAKS_H

#include "sim/fast/tables.h"
#include "sim/fast/touch.h"

/* Largest |value| of the cubic through both ends anywhere in the step: its Bezier control points enclose it. */
static vec hull(vec y0, vec d0, vec y1, vec d1, double h)
{
    const double third = h / 3;
    return vec_max(vec_max(vec_abs(y0), vec_abs(y0 + third * d0)), vec_max(vec_abs(y1 - third * d1), vec_abs(y1)));
}

static double largest_on_cubic(double h, double y0, double d0, double y1, double d1)
{
    const Path q = path_make(h, y0, d0, y1, d1);
    double turns[2], most = fmax(fabs(y0), fabs(y1));
    const int n = path_turns(&q, turns);
    for (int i = 0; i < n; i++)
        most = fmax(most, fabs(path_at(&q, turns[i])));
    return most;
}

/* Raises peak where the step may exceed it; 0: the error bound hides what the peak is. */
static int raise_peaks(vec *peak, int n, int nf, const vec *y0, const vec *d0, const vec *y1, const vec *d1,
                       const vec *e, double h, double tolerance)
{
    for (int f = 0; f < nf; f++) {
        const vec reach = hull(y0[f], d0[f], y1[f], d1[f], h) + e[f];
        if (!any(reach > peak[f]))
            continue;
        for (int lane = 0; lane < LANES && f * LANES + lane < n; lane++) {
            if (!(reach[lane] > peak[f][lane]))
                continue;
            const double most = largest_on_cubic(h, y0[f][lane], d0[f][lane], y1[f][lane], d1[f][lane]);
            if (!(most + e[f][lane] > peak[f][lane]))
                continue;
            if (!(e[f][lane] <= tolerance * fmax(peak[f][lane], most)))
                return 0;
            if (most > peak[f][lane])
                peak[f][lane] = most;
        }
    }
    return 1;
}

static int exceeds(const vec *reach, const vec *peak, int nf)
{
    mask over = {0};
    for (int f = 0; f < nf; f++)
        over |= ~(reach[f] <= peak[f]);
    return any(over);
}

/* Interstorey differences of floor values, the ground being 0. */
static void storeys(const FastWork *k, const vec *u, vec *d)
{
    const double *from = scalars_const(u);
    double *to = scalars(d);
    to[0] = from[0];
    for (int j = 1; j < k->n; j++)
        to[j] = from[j] - from[j - 1];
    for (int j = k->n; j < k->n_pad; j++)
        to[j] = 0;
}

static void outputs(FastWork *k, const vec *q, const vec *v, vec *u, vec *drift, vec *accel)
{
    vec *z = k->za;
    for (int i = 0; i < k->bf; i++)
        z[i] = k->load[i] - k->decay[i] * v[i] - k->omega[i] * k->omega[i] * q[i];
    const double *const state[2] = {scalars_const(q), scalars_const(z)};
    vec *const floors[2] = {u, accel};
    rows_times(2, (const vec *)k->R, k->nf, k->nb_pad, state, floors);
    storeys(k, u, drift);
}

/* Extremum of the parabola through three samples, the middle one being the largest. */
static double parabola_top(double h0, double h1, double y0, double y1, double y2)
{
    const double left = (y1 - y0) / h0, right = (y2 - y1) / h1;
    const double curvature = (right - left) / (h0 + h1), slope = (left * h1 + right * h0) / (h0 + h1);
    return curvature != 0 ? y1 - slope * slope / (4 * curvature) : y1;
}

static void peaks_in_contact(FastWork *k, double h)
{
    vec *oldest[3];
    for (int y = 0; y < 3; y++) { /* the newest samples go where the oldest were */
        oldest[y] = k->seen[2][y];
        k->seen[2][y] = k->seen[1][y];
        k->seen[1][y] = k->seen[0][y];
        k->seen[0][y] = oldest[y];
    }
    k->seen_h[1] = k->seen_h[0];
    k->seen_h[0] = h;
    outputs(k, k->q, k->v, k->seen[0][0], k->seen[0][1], k->seen[0][2]);
    if (k->n_seen < 3)
        k->n_seen++;
    vec *const peaks[3] = {k->peak_u, k->peak_d, k->peak_a};
    for (int y = 0; y < 3; y++)
        for (int f = 0; f < k->nf; f++) {
            const vec now = vec_abs(k->seen[0][y][f]), middle = vec_abs(k->seen[1][y][f]);
            peaks[y][f] = vec_max(now, peaks[y][f]);
            if (k->n_seen < 3)
                continue;
            const vec first = vec_abs(k->seen[2][y][f]);
            const mask top = (middle > now) & (middle >= first) & (middle * 1.25 > peaks[y][f]);
            if (!any(top))
                continue;
            for (int lane = 0; lane < LANES; lane++)
                if (top[lane]) {
                    const double most = fabs(parabola_top(k->seen_h[1], k->seen_h[0], k->seen[2][y][f][lane],
                                                          k->seen[1][y][f][lane], k->seen[0][y][f][lane]));
                    if (most > peaks[y][f][lane])
                        peaks[y][f][lane] = most;
                }
        }
}

#endif
