/* sim/fast/glide.h -- several sampling intervals at once while the building sways too little to matter: no wall can be
 * reached and no peak raised, so that the modes and their energy books are all there is to do.
 * Part of the kernel: static functions, compiled once per instruction set. See fast.h for the method.
 *
 * From a state (q, q') on, under a ground acceleration a(t) over a window,
 *
 *   |q(t)| <= A + G,   A^2 = q^2 + ((q' + zeta w q) / w_d)^2,   G = |gamma| / w_d int |a| dt
 *
 * since |g(t)| <= 1 / w_d for the impulse response g of a mode below critical damping, and
 * |2 zeta w q' + w^2 q| <= (1 + 2 zeta) w^2 (A + G). */
#ifndef IMTET_SIM_FAST_GLIDE_H
#define IMTET_SIM_FAST_GLIDE_H

#include "sim/fast/flight.h"

/* Intervals of the first glide, twice as many after each that succeeds. */
enum { GLIDE_LEAST = 4, GLIDE_MOST = 64 };

/* Largest displacement and acceleration of every mode over the window: bound, bound_a. */
static void glide_bounds(FastWork *k, double impulse)
{
    for (int i = 0; i < k->mf; i++) {
        const vec q = k->q[i], xd = (k->v[i] + 0.5 * k->decay[i] * q) * k->wd_inverse[i];
        k->bound[i] = vec_hypot_above(q, xd) + impulse * vec_abs(k->gamma[i]) * k->wd_inverse[i];
        k->bound_a[i] = k->omega[i] * (k->omega[i] + k->decay[i]) * k->bound[i];
    }
}

/* Is a wall out of reach and every peak, whatever the modes do within glide_bounds? The floors' u0, u1 and a0, which
 * belong to flights, hold the reach of displacement, drift and acceleration. */
static int glides(FastWork *k, double impulse)
{
    const vec *R_abs = (const vec *)k->R_abs;
    const int core = k->nb_pad;
    glide_bounds(k, impulse);
    const double *const bounds[2] = {scalars_const(k->bound), scalars_const(k->bound_a)};
    vec *const reach[2] = {k->u0, k->a0}, *const reach_drift[1] = {k->u1}, *const reach_core[1] = {k->c0};
    rows_times(2, R_abs, k->nf, k->model->nb, bounds, reach);
    rows_times(1, (const vec *)k->D_abs, k->nf, k->model->nb, bounds, reach_drift);
    if (exceeds(k->u0, k->peak_u, k->nf) || exceeds(k->u1, k->peak_d, k->nf) || exceeds(k->a0, k->peak_a, k->nf))
        return 0;
    if (k->m_pad == core)
        return 1;
    const double *const core_bounds[1] = {bounds[0] + core};
    rows_times(1, R_abs + core * k->nf, k->nf, k->m_pad - core, core_bounds, reach_core);
    for (int f = 0; f < k->nf; f++)
        k->u0[f] += k->c0[f];
    return !exceeds(k->u0, k->gap, k->nf);
}

/* One interval of free flow. */
static void glide_interval(FastWork *k, const Level *l, double a0, double a1)
{
    for (int i = 0; i < k->mf; i++)
        flow_modes(k, l, i, -k->gamma[i] * a0, -k->gamma[i] * (a1 - a0));
    book_flight(k, l, a0, a1);
    swap(&k->q, &k->q1);
    swap(&k->v, &k->v1);
}

/* After a glide the speed of the gaps must be known again. */
static void glide_end(FastWork *k)
{
    const double *const state[1] = {scalars_const(k->v)};
    vec *const floors[1] = {k->wd};
    k->landed = 0;
    k->flight_level = 0;
    k->touch_level = LEVEL_MAX;
    if (k->m_pad == k->nb_pad)
        return;
    rows_times(1, (const vec *)k->R, k->nf, k->m_pad, state, floors);
    k->speed = largest(k->wd, k->nf);
}

#endif
