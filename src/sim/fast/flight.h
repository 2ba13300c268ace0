/* sim/fast/flight.h -- one step without contact, taken only if it is certain that no gap closes and no peak hides in
 * it. Part of the kernel: static functions, compiled once per instruction set. See fast.h for the method. */
#ifndef IMTET_SIM_FAST_FLIGHT_H
#define IMTET_SIM_FAST_FLIGHT_H

#include "sim/fast/peaks.h"

static void flight_modes(FastWork *k, const Level *l, double a0, double a1)
{
    const double rate = (a1 - a0) / l->h;
    for (int i = 0; i < k->mf; i++) {
        const vec q = k->q[i], v = k->v[i], p0 = -k->gamma[i] * a0, p1 = -k->gamma[i] * (a1 - a0);
        flow_modes(k, l, i, p0, p1);
        /* quasi-static answer to the linear load, and the free vibration around it */
        const vec flex = k->flex[i], decay = k->decay[i], stiff = k->omega[i] * k->omega[i], slow = l->slow[i];
        const vec static_v = -k->gamma[i] * rate * flex, static_0 = (p0 - decay * static_v) * flex,
                  static_1 = static_0 + l->h * static_v;
        const vec x = q - static_0, xd = (v - static_v + 0.5 * decay * x) * k->wd_inverse[i];
        k->amplitude[i] = vec_hypot_above(x, xd);
        k->qa[i] = static_0 + slow * x;
        k->va[i] = static_v + slow * (v - static_v);
        k->qb[i] = static_1 + slow * (k->q1[i] - static_1);
        k->vb[i] = static_v + slow * (k->v1[i] - static_v);
        k->za[i] = -decay * k->va[i] - stiff * k->qa[i];
        k->zb[i] = -decay * k->vb[i] - stiff * k->qb[i];
        k->ja[i] = -decay * (p0 + k->za[i]) - stiff * k->va[i];
        k->jb[i] = -decay * (p0 + p1 + k->zb[i]) - stiff * k->vb[i];
    }
}

static void flight_floors(FastWork *k, const Level *l)
{
    const vec *R = (const vec *)k->R, *R_abs = (const vec *)k->R_abs;
    const int core = k->nb_pad, core_count = k->m_pad - k->nb_pad;
    const double *const state[4] = {scalars_const(k->qa), scalars_const(k->va), scalars_const(k->qb),
                                    scalars_const(k->vb)};
    vec *const floors[4] = {k->u0, k->u0d, k->u1, k->u1d};
    rows_times(4, R, k->nf, k->model->nb, state, floors);
    for (int i = 0; i < k->mf; i++) {
        k->bound[i] = l->kappa[i] * k->amplitude[i];
        k->bound_a[i] = hull(k->za[i], k->ja[i], k->zb[i], k->jb[i], l->h) + l->kappa_accel[i] * k->amplitude[i];
    }
    const double *const bounds[2] = {scalars_const(k->bound), scalars_const(k->bound_a)};
    vec *const errors[2] = {k->e_u, k->reach_a};
    rows_times(2, R_abs, k->nf, k->model->nb, bounds, errors);
    if (core_count == 0)
        return;
    const double *const core_state[4] = {state[0] + core, state[1] + core, state[2] + core, state[3] + core};
    vec *const core_floors[4] = {k->c0, k->c0d, k->c1, k->c1d};
    rows_times(4, R + core * k->nf, k->nf, core_count, core_state, core_floors);
    const double *const core_bound[1] = {bounds[0] + core};
    vec *const core_error[1] = {k->e_w};
    rows_times(1, R_abs + core * k->nf, k->nf, core_count, core_bound, core_error);
}

static void flight_accelerations(FastWork *k, const Level *l)
{
    const double *const accel[4] = {scalars_const(k->za), scalars_const(k->ja), scalars_const(k->zb),
                                    scalars_const(k->jb)};
    vec *const accels[4] = {k->a0, k->a0d, k->a1, k->a1d};
    rows_times(4, (const vec *)k->R, k->nf, k->model->nb, accel, accels);
    for (int i = 0; i < k->bf; i++)
        k->bound_a[i] = l->kappa_accel[i] * k->amplitude[i];
    const double *const bound[1] = {scalars_const(k->bound_a)};
    vec *const error[1] = {k->e_a};
    rows_times(1, (const vec *)k->R_abs, k->nf, k->model->nb, bound, error);
}

static int gaps_stay_open(FastWork *k, double h)
{
    if (k->m_pad == k->nb_pad)
        return 1;
    mask closed = {0};
    for (int f = 0; f < k->nf; f++) {
        const vec w0 = k->u0[f] + k->c0[f], w0d = k->u0d[f] + k->c0d[f], w1 = k->u1[f] + k->c1[f],
                  w1d = k->u1d[f] + k->c1d[f];
        closed |= ~(hull(w0, w0d, w1, w1d, h) + k->e_u[f] + k->e_w[f] < k->gap[f]);
    }
    return !any(closed);
}

static int accelerations_in_flight(FastWork *k, const Level *l, double tolerance)
{
    flight_accelerations(k, l);
    return raise_peaks(k->peak_a, k->nf, k->a0, k->a0d, k->a1, k->a1d, k->e_a, l->h, tolerance);
}

static int peaks_in_flight(FastWork *k, const Level *l, double tolerance)
{
    const double h = l->h;
    vec d0[FLOORS_PAD_MAX / LANES], d0d[FLOORS_PAD_MAX / LANES], d1[FLOORS_PAD_MAX / LANES],
        d1d[FLOORS_PAD_MAX / LANES], e[FLOORS_PAD_MAX / LANES];
    storeys(k, k->u0, d0);
    storeys(k, k->u0d, d0d);
    storeys(k, k->u1, d1);
    storeys(k, k->u1d, d1d);
    storeys(k, k->e_u, e);
    for (int j = 1; j < k->n; j++)
        scalars(e)[j] += 2 * scalars(k->e_u)[j - 1];
    return raise_peaks(k->peak_u, k->nf, k->u0, k->u0d, k->u1, k->u1d, k->e_u, h, tolerance) &&
           raise_peaks(k->peak_d, k->nf, d0, d0d, d1, d1d, e, h, tolerance) &&
           (!exceeds(k->reach_a, k->peak_a, k->nf) || accelerations_in_flight(k, l, tolerance));
}

/* Work of the ground over the step: [p q] - int p' q dt, mode by mode. */
static void book_flight(FastWork *k, const Level *l, double a0, double a1)
{
    const vec *c = l->coef;
    const int mf = k->mf;
    for (int i = 0; i < mf; i++) {
        const vec p0 = -k->gamma[i] * a0, p1 = -k->gamma[i] * (a1 - a0);
        const vec mean = c[FLOW_I * mf + i] * k->q[i] + c[(FLOW_I + 1) * mf + i] * k->v[i] +
                         c[(FLOW_I + 2) * mf + i] * p0 + c[(FLOW_I + 3) * mf + i] * p1;
        k->ground[i] += (p0 + p1) * k->q1[i] - p0 * k->q[i] - p1 * mean;
        k->drift[i] += momentum_gap(k, l->h, i, k->q1[i] - k->q[i], k->v1[i] - k->v[i], mean, p0 + 0.5 * p1);
    }
}

/* One step without contact; 0 when it cannot be certified and nothing has changed. */
static int flight(FastWork *k, const Level *l, double a0, double a1)
{
    k->flights++;
    flight_modes(k, l, a0, a1);
    flight_floors(k, l);
    if (!gaps_stay_open(k, l->h) || !peaks_in_flight(k, l, k->knobs->peak_tolerance))
        return 0;
    book_flight(k, l, a0, a1);
    swap(&k->q, &k->q1);
    swap(&k->v, &k->v1);
    for (int f = 0; f < k->nf && k->m_pad > k->nb_pad; f++)
        k->wd[f] = k->u1d[f] + k->c1d[f];
    k->speed = k->m_pad > k->nb_pad ? largest(k->wd, k->nf) : 0;
    k->landed = 0;
    return 1;
}

#endif
