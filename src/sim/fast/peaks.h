/* sim/fast/peaks.h -- maxima over continuous time: in flight from the Hermite cubic, in contact from the parabola
 * through start, middle and end of the step.
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
static int raise_peaks(vec *peak, int nf, const vec *y0, const vec *d0, const vec *y1, const vec *d1, const vec *e,
                       double h, double tolerance)
{
    for (int f = 0; f < nf; f++) {
        const vec reach = hull(y0[f], d0[f], y1[f], d1[f], h) + e[f];
        for (unsigned bits = lane_bits(reach > peak[f]); bits; bits &= bits - 1) {
            const int lane = __builtin_ctz(bits);
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

/* Interstorey differences of floor values, the ground being 0; padding is anything. */
static void storeys(const FastWork *k, const vec *u, vec *d)
{
    vec below = {0};
    for (int f = 0; f < k->nf; f++) {
        d[f] = u[f] - LANES_BEFORE(below, u[f]);
        below = u[f];
    }
}

/* Where a flight ends: u, drift and acceleration of the floors. */
static void see_start(FastWork *k)
{
    for (int i = 0; i < k->bf; i++)
        k->za[i] = k->load[i] - k->decay[i] * k->v[i] - k->omega[i] * k->omega[i] * k->q[i];
    const double *const state[2] = {scalars_const(k->q), scalars_const(k->za)};
    vec *const floors[2] = {k->seen[0][0], k->seen[0][2]};
    rows_times(2, (const vec *)k->R, k->nf, k->model->nb, state, floors);
    storeys(k, k->seen[0][0], k->seen[0][1]);
}

/* Largest |value| of the parabola through the start, the middle and the end of a step. */
static vec parabola_top(vec y0, vec ym, vec y1)
{
    const vec zero = {0}, slope = 4 * ym - 3 * y0 - y1, x = -0.25 * slope / (y0 + y1 - 2 * ym);
    const vec turn = (vec)((mask)vec_abs(y0 + 0.5 * x * slope) & (x > zero) & (x < zero + 1));
    return vec_max(turn, vec_max(vec_max(vec_abs(y0), vec_abs(y1)), vec_abs(ym)));
}

/* The control points enclose the parabola. */
static vec parabola_reach(vec y0, vec ym, vec y1)
{
    return vec_max(vec_max(vec_abs(y0), vec_abs(y1)), vec_abs(2 * ym - 0.5 * (y0 + y1)));
}

static void raise_in_contact(vec *peak, int nf, const vec *start, const vec *middle, const vec *end)
{
    for (int f = 0; f < nf; f++)
        peak[f] = vec_max(parabola_top(start[f], middle[f], end[f]), peak[f]);
}

/* Of accelerations, which are certain to less anyway, so many times as much may hide. */
static const double ACCELERATION_SLACK = 5;

/* Is there a floor where too much of peak y may hide between the parabola and what it misses: e? Where the motion sets
 * in every step is a peak: parts of `least` need not be known. */
static int hides_by(const FastWork *k, int y, const vec *peak, const vec *e, double least)
{
    const double tolerance = k->knobs->peak_tolerance * (y == 2 ? ACCELERATION_SLACK : 1);
    mask hidden = {0};
    for (int f = 0; f < k->nf; f++) {
        const vec reach = parabola_reach(k->seen[0][y][f], k->seen[1][y][f], k->seen[2][y][f]);
        hidden |= (reach + e[f] > peak[f]) & ~(e[f] <= tolerance * vec_max(vec_max(reach, peak[f]), (vec){0} + least));
    }
    return any(hidden);
}

/* The same, at first by what the parabola misses whatever the floor. ground: largest acceleration of the step. */
static int hides(FastWork *k, int y, const vec *peak, vec missed, double ground)
{
    const double sway = ground * scalars(k->flex)[0], least = y == 0 ? sway : y == 1 ? sway / k->n : ground;
    for (int f = 0; f < k->nf; f++)
        k->e_a[f] = missed;
    if (!hides_by(k, y, peak, k->e_a, least))
        return 0;
    const double *const bound[1] = {scalars_const(y == 2 ? k->bound_a : k->bound)};
    vec *const e[1] = {k->e_a};
    rows_times(1, (const vec *)(y == 1 ? k->D_abs : k->R_abs), k->nf, k->model->nb, bound, e);
    return hides_by(k, y, peak, k->e_a, least);
}

/* Do the curves through the step miss too much of a peak? First by bounds that hold for all floors, then floor by
 * floor. Notes which peaks may rise. */
static int peaks_are_certain(FastWork *k, double ground)
{
    vec *const peaks[3] = {k->peak_u, k->peak_d, k->peak_a}, sum[3] = {{0}};
    for (int i = 0; i < k->bf; i++) {
        sum[0] += k->most[i] * k->bound[i];
        sum[1] += k->most_drift[i] * k->bound[i];
        sum[2] += k->most[i] * k->bound_a[i];
    }
    for (int y = 0; y < 3; y++) {
        const vec missed = (vec){0} + lanes_sum(sum[y]);
        mask near = {0};
        for (int f = 0; f < k->nf; f++)
            near |= ~(parabola_reach(k->seen[0][y][f], k->seen[1][y][f], k->seen[2][y][f]) + missed <= peaks[y][f]);
        k->rises[y] = any(near);
        if (k->rises[y] && hides(k, y, peaks[y], missed, ground))
            return 0;
    }
    return 1;
}

/* Middle and end of a contact step, modal displacements qb, q1 and accelerations zb, za; 0: a peak may hide in it.
 * ground: the largest acceleration of the ground in the step. */
static int see_step(FastWork *k, double ground)
{
    const double *const state[4] = {scalars_const(k->qb), scalars_const(k->zb), scalars_const(k->q1),
                                    scalars_const(k->za)};
    vec *const floors[4] = {k->seen[1][0], k->seen[1][2], k->seen[2][0], k->seen[2][2]};
    rows_times(4, (const vec *)k->R, k->nf, k->model->nb, state, floors);
    storeys(k, k->seen[1][0], k->seen[1][1]);
    storeys(k, k->seen[2][0], k->seen[2][1]);
    return peaks_are_certain(k, ground);
}

static void peaks_in_contact(FastWork *k)
{
    vec *const peaks[3] = {k->peak_u, k->peak_d, k->peak_a};
    for (int y = 0; y < 3; y++) {
        if (k->rises[y])
            raise_in_contact(peaks[y], k->nf, k->seen[0][y], k->seen[1][y], k->seen[2][y]);
        swap(&k->seen[0][y], &k->seen[2][y]);
    }
}

#endif
