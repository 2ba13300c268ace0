/* sim/fast/contact_step.h -- one step with contacts: predict, solve for the forces, let the modes take them, keep the
 * books. Part of the kernel: static functions, compiled once per instruction set. See fast.h for the method. */
#ifndef IMTET_SIM_FAST_CONTACT_STEP_H
#define IMTET_SIM_FAST_CONTACT_STEP_H

#include "sim/fast/forces.h"

/* From flight to contact steps: w and w' exactly, and a first sample for the peaks. */
static void land(FastWork *k)
{
    const double *const state[2] = {scalars_const(k->q), scalars_const(k->v)};
    vec *const floors[2] = {k->w, k->wd};
    rows_times(2, (const vec *)k->R, k->nf, k->m_pad, state, floors);
    see_start(k);
    k->landed = 1;
}

static void contact_predict(FastWork *k, const Level *l, double a0, double a1)
{
    for (int i = 0; i < k->mf; i++)
        flow_modes(k, l, i, k->load[i] - k->gamma[i] * a0, -k->gamma[i] * (a1 - a0) - k->load[i]);
    const double *const state[2] = {scalars_const(k->q1), scalars_const(k->v1)};
    vec *const floors[2] = {k->w1, k->wd1};
    rows_times(2, (const vec *)k->R, k->nf, k->m_pad, state, floors);
}

/* What interpolation over the step misses of the first mf vectors of modes, bound, and of their acceleration, bound_a;
 * returns what it misses of w [m], whatever the floor. Amplitudes are those around the quasi-static answer to the load.
 */
static double contact_bounds(FastWork *k, const Level *l, int mf, double a0, double a1)
{
    const double rate = (a1 - a0) / l->h;
    vec missed = {0};
    for (int i = 0; i < mf; i++) {
        const vec flex = k->flex[i];
        const vec x = k->q[i] - flex * (k->load[i] - k->gamma[i] * a0);
        const vec xd = (k->v[i] + flex * k->gamma[i] * rate + 0.5 * k->decay[i] * x) * k->wd_inverse[i];
        const vec amplitude = vec_hypot_above(x, xd);
        missed += l->cubic[i] * amplitude;
        k->bound[i] = l->parabola[i] * amplitude;
        k->bound_a[i] = l->parabola_accel[i] * amplitude;
    }
    return lanes_sum(missed);
}

/* May a floor that is not part of the solution have touched within the step? */
static int others_reach(const FastWork *k, const Active *active, double h, double missed)
{
    uint64_t reached = 0;
    for (int f = 0; f < k->nf; f++) {
        const mask near = ~(hull(k->w[f], k->wd[f], k->w1[f], k->wd1[f], h) + missed < k->gap[f]);
        reached |= (uint64_t)lane_bits(near) << f * LANES;
    }
    return (reached & k->floors & ~active->listed) != 0;
}

/* Displacement and acceleration of building modes i in the middle of a step, qb and zb, and at its end, za. The part
 * that the load does not make follows the Hermite cubic. start, end: the load there; load1, bubble: of the contacts. */
static inline void middle_of_step(FastWork *k, double h, int i, vec q1, vec v1, vec start, vec end, vec load1,
                                  vec bubble)
{
    const vec q = k->q[i], v = k->v[i], decay = k->decay[i], stiff = k->omega[i] * k->omega[i];
    const vec z0 = -decay * v - stiff * q, z1 = -decay * v1 - stiff * q1;
    const vec j0 = -decay * (start + z0) - stiff * v, j1 = -decay * (end + z1) - stiff * v1;
    k->qb[i] = 0.5 * (q + q1) + 0.125 * h * (v - v1);
    k->zb[i] = 0.5 * (z0 + z1 + k->load[i] + load1) + 0.125 * h * (j0 - j1) + 0.25 * bubble;
    k->za[i] = load1 + z1;
}

/* What the modes would be with the forces that were found; returns the work [J] that they did on all modes. */
static double contact_update(FastWork *k, const Level *l, const Active *active, double a0, double a1)
{
    const vec *c = l->coef, zero = {0};
    const int mf = k->mf;
    vec *load1 = k->qa, *bubble = k->va, taken = zero;
    for (int i = 0; i < mf; i++)
        load1[i] = bubble[i] = zero;
    for (int n = 0; n < active->n; n++) {
        const vec *row = (const vec *)k->RT + active->floor[n] * mf;
        const double f1 = scalars(k->f1)[active->floor[n]], fb = scalars(k->fb)[active->floor[n]];
        for (int i = 0; i < mf; i++) {
            load1[i] += row[i] * f1;
            bubble[i] += row[i] * fb;
        }
    }
    for (int i = 0; i < mf; i++) {
        const vec q = k->q[i], v = k->v[i], load = k->load[i], b = bubble[i];
        const vec q1 = k->q1[i] + c[(FLOW_Q + 3) * mf + i] * (load1[i] + b) - c[(FLOW_Q + 4) * mf + i] * b;
        const vec v1 = k->v1[i] + c[(FLOW_V + 3) * mf + i] * (load1[i] + b) - c[(FLOW_V + 4) * mf + i] * b;
        const vec g0 = -k->gamma[i] * a0, g1 = -k->gamma[i] * (a1 - a0), rise = load1[i] - load + b;
        const vec p0 = g0 + load, p1 = g1 + rise;
        const vec mean = c[FLOW_I * mf + i] * q + c[(FLOW_I + 1) * mf + i] * v + c[(FLOW_I + 2) * mf + i] * p0 +
                         c[(FLOW_I + 3) * mf + i] * p1 - c[(FLOW_I + 4) * mf + i] * b;
        const vec first = c[FLOW_K * mf + i] * q + c[(FLOW_K + 1) * mf + i] * v + c[(FLOW_K + 2) * mf + i] * p0 +
                          c[(FLOW_K + 3) * mf + i] * p1 - c[(FLOW_K + 4) * mf + i] * b;
        const vec work = load1[i] * q1 - load * q - rise * mean + 2 * b * first;
        k->work1[i] = k->work[i] + work;
        k->ground1[i] = k->ground[i] + (g0 + g1) * q1 - g0 * q - g1 * mean;
        k->drift1[i] = k->drift[i] + momentum_gap(k, l->h, i, q1 - q, v1 - v, mean, p0 + 0.5 * p1 - b * (1.0 / 3));
        if (i < k->bf)
            middle_of_step(k, l->h, i, q1, v1, p0, p0 + p1 - b, load1[i], b);
        k->q1[i] = q1;
        k->v1[i] = v1;
        taken += work;
    }
    return lanes_sum(taken);
}

/* How far the energy that the modes gave to the contacts, by their exact motion, is from what the force law took along
 * its cubic paths: zero but for the error of the step. handled: the energy that the contacts held or lost. */
static double step_mismatch(const FastWork *k, const Active *active, double work, double *handled)
{
    double taken = 0;
    *handled = 0;
    for (int i = 0; i < active->n; i++) {
        const int j = active->floor[i];
        const double gap = scalars_const(k->gap)[j], lost = active->press[i].lost + active->press[i].clamped;
        const double start = contact_stored(&k->model->contact, fabs(scalars_const(k->w)[j]) - gap);
        const double end = contact_stored(&k->model->contact, fabs(scalars_const(k->w1)[j]) - gap);
        taken += lost + end - start;
        *handled += start + end + fabs(lost);
    }
    return fabs(work + taken);
}

/* Share x of a step: what the force that was solved for, a parabola, misses of the law along the path of floor j [N].
 */
static double force_missed(const FastWork *k, const Press *t, int j, const Path *path, double x)
{
    const double w = path_at(path, x), side = w > 0 ? 1 : -1, p = side * w - scalars_const(k->gap)[j];
    const double v0 = larger(t->closings ? t->closed_with : k->v0[j], k->model->contact.v0_floor);
    const double solved =
        (1 - x) * scalars_const(k->f0)[j] + x * scalars_const(k->f1)[j] + x * (1 - x) * scalars_const(k->fb)[j];
    const double law =
        p > 0 ? contact_force(&k->model->contact, k->model->mass_eff[j], p, side * path_slope(path, x) / path->h, v0)
                    .force
              : 0;
    return fabs(solved + side * law);
}

/* Are the forces so well known that the largest acceleration is? */
static int forces_are_followed(const FastWork *k, const Active *active, double h)
{
    for (int i = 0; i < active->n; i++) {
        const int j = active->floor[i];
        const double *row = k->RT + j * k->m_pad;
        const Path path = path_make(h, scalars_const(k->w)[j], scalars_const(k->wd)[j], scalars_const(k->w1)[j],
                                    scalars_const(k->wd1)[j]);
        double missed = 0, per_force = 0; /* [N], [1/kg] of the floor without the core */
        for (int mode = 0; mode < k->model->nb; mode++)
            per_force += row[mode] * row[mode];
        for (int quarter = 1; quarter < 4; quarter++)
            missed = larger(force_missed(k, &active->press[i], j, &path, 0.25 * quarter), missed);
        const double peak = larger(fabs(scalars_const(k->seen[1][2])[j]), scalars_const(k->peak_a)[j]);
        if (!(missed * per_force <= ACCELERATION_SLACK * k->knobs->peak_tolerance * peak))
            return 0;
    }
    return 1;
}

/* Does an acceleration come near its peak, as far as a force that may be wrong tells? */
static int blow_matters(const FastWork *k)
{
    mask near = {0};
    for (int f = 0; f < k->nf; f++)
        near |= 2 * parabola_reach(k->seen[0][2][f], k->seen[1][2][f], k->seen[2][2][f]) > k->peak_a[f];
    return any(near);
}

/* A blow too weak for the books of the run may still be the largest acceleration. mismatch of the energy [J] that the
 * contacts handled. */
static int blow_is_known(const FastWork *k, const Active *active, double h, double mismatch, double handled)
{
    static const double GROSSLY = 0.03;
    if (active->n == 0 || !blow_matters(k))
        return 1;
    if (!k->rises[2])
        return mismatch <= GROSSLY * handled;
    return mismatch <= ACCELERATION_SLACK * k->knobs->peak_tolerance * handled && forces_are_followed(k, active, h);
}

/* The control points enclose the path: only where they go deeper than before is its top looked for. */
static void go_deeper(FastWork *k, double h, double gap, double w0, double wd0, double w1, double wd1)
{
    const double limit = k->deepest + gap, third = h / 3;
    if (fabs(w0) > limit || fabs(w0 + third * wd0) > limit || fabs(w1 - third * wd1) > limit || fabs(w1) > limit)
        k->deepest = fmax(k->deepest, largest_on_cubic(h, w0, wd0, w1, wd1) - gap);
}

static void log_closing(FastWork *k, double h, int floor, const Press *t)
{
    OnsetLog *log = k->options->onsets;
    if (log && t->closings && log->n < log->n_max)
        log->at[log->n++] = (ContactOnset){.floor = floor, .t = k->now + h * t->closed_at, .speed = t->closed_with};
}

static void accept_contacts(FastWork *k, const Active *active, double h)
{
    k->touching = 0;
    for (int i = 0; i < active->n; i++) {
        const int j = active->floor[i];
        const Press *t = &active->press[i];
        const double w0 = scalars(k->w)[j], w1 = scalars(k->w1)[j], gap = scalars(k->gap)[j];
        k->contact_lost += t->lost;
        k->contact_clamped += t->clamped;
        k->impacts += t->closings;
        log_closing(k, h, j, t);
        k->floored += t->floored;
        k->side[j] = w1 > gap ? 1 : -w1 > gap ? -1 : 0;
        k->v0[j] = t->v0;
        if (t->mean != 0)
            go_deeper(k, h, gap, w0, scalars(k->wd)[j], w1, scalars(k->wd1)[j]);
        k->touching |= (uint64_t)(k->side[j] != 0) << j;
    }
    swap(&k->q, &k->q1);
    swap(&k->v, &k->v1);
    swap(&k->load, &k->qa);
    swap(&k->work, &k->work1);
    swap(&k->ground, &k->ground1);
    swap(&k->drift, &k->drift1);
    swap(&k->w, &k->w1);
    swap(&k->wd, &k->wd1);
    swap(&k->f0, &k->f1);
    forget_forces(k);
    k->speed = largest(k->wd, k->nf);
}

/* Steps whose books do not close are halved so often below the length that resolves the shortest contact. */
enum { HALVED_FOR_BOOKS = 4 };

/* Solves for the forces of a step with whatever contacts it holds, lets the modes take them, and looks at what comes of
 * it; 0 when the step must be shorter. below: levels below the one whose step resolves the shortest contact, from which
 * on gaps may close and others be reached. */
static int try_contacts(FastWork *k, const Level *l, double a0, double a1, int below, Active *active)
{
    const int finest = below >= 0, may_halve = below < (k->knobs->energy_tolerance > 0 ? HALVED_FOR_BOOKS : 0);
    const double allowed = k->knobs->energy_tolerance * k->energy_scale;
    double handled;
    contact_predict(k, l, a0, a1);
    const double missed = contact_bounds(k, l, finest ? k->bf : k->mf, a0, a1);
    if (!solve_contacts(k, l, k->knobs->solver_tolerance, active))
        return 0;
    if (!finest && (closes(active) || others_reach(k, active, l->h, missed)))
        return 0;
    const double work = contact_update(k, l, active, a0, a1);
    const double mismatch = step_mismatch(k, active, work, &handled);
    if (may_halve && !(mismatch <= allowed))
        return 0;
    k->may_grow = mismatch <= allowed / 32;
    return see_step(k, fmax(fabs(a0), fabs(a1))) && (!may_halve || blow_is_known(k, active, l->h, mismatch, handled));
}

/* One contact step; 0 when it must be shorter and nothing has changed. */
static int contact_step(FastWork *k, const Level *l, double a0, double a1, int below)
{
    Active active;
    if (!k->landed)
        land(k);
    k->steps++;
    if (!try_contacts(k, l, a0, a1, below, &active)) {
        forget_forces(k);
        return 0;
    }
    accept_contacts(k, &active, l->h);
    peaks_in_contact(k);
    return 1;
}

#endif
