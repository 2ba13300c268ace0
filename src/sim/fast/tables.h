/* sim/fast/tables.h -- the tables of one step length, a design in the engine's own layout, and the state of rest.
 * Part of the kernel: static functions, compiled once per instruction set. See fast.h for the method. */
#ifndef IMTET_SIM_FAST_TABLES_H
#define IMTET_SIM_FAST_TABLES_H

#include <math.h>
#include <string.h>

#include "sim/fast/kernel.h"

/* Above this w h a mode is bounded by its amplitude, below it the Hermite cubic follows it. */
static const double FAST_MODE = 1.5;

/* The greater; b where a is not a number. Faster than fmax, which must look at both. */
static inline double larger(double a, double b)
{
    return a > b ? a : b;
}

static double *scalars(vec *p)
{
    return (double *)p;
}

static const double *scalars_const(const vec *p)
{
    return (const double *)p;
}

static void swap(vec **a, vec **b)
{
    vec *t = *a;
    *a = *b;
    *b = t;
}

static double largest(const vec *a, int nf)
{
    vec most = vec_abs(a[0]);
    for (int f = 1; f < nf; f++)
        most = vec_max(most, vec_abs(a[f]));
    return lanes_max(most);
}

/* Largest distance of a free vibration, amplitude 1, from the Hermite cubic through its ends, and from the parabola
 * through both ends and the cubic's middle; wh = w h. Where w h is large: what the mode moves and the curve may swing.
 */
static double cubic_misses(double wh)
{
    return fmin(wh * wh * wh * wh / 384, 2 + 0.25 * wh);
}

static double parabola_misses(double wh)
{
    return fmin(wh * wh * (0.00802 * wh + wh * wh / 384), 2.25 + 0.25 * wh);
}

/* From this damping ratio on a mode is bounded by its energy. */
static const double STIFFLY_DAMPED = 0.99;

/* A free vibration x of damping ratio zeta and a = sqrt(x^2 + ((x' + zeta w x) / w_d)^2) at its start: from then on
 * |x| <= amplitude a, its fourth derivative <= fourth amplitude w^4 a; 2 zeta w x' + w^2 x, which vibrates alike, has
 * acceleration w^2 times these bounds. Below critical damping a is the amplitude and the roots lie at distance w from
 * 0. Else e^2 = x^2 + (x' / w)^2 never grows, e <= (2 + zeta) a with w in place of w_d, and each derivative costs 2
 * zeta w of the last one and w^2 of the one before. */
typedef struct {
    double amplitude, acceleration, fourth;
} Decay;

static Decay decay_of(double zeta)
{
    if (zeta <= STIFFLY_DAMPED)
        return (Decay){1, 1 + 2 * zeta, 1};
    return (Decay){2 + zeta, 2 + 4 * zeta * (1 + zeta), 1 + 4 * zeta * (1 + zeta * (1 + 2 * zeta))};
}

static void level_flow(FastWork *k, Level *l)
{
    const double *omega = scalars_const(k->omega), *zeta = scalars_const(k->zeta);
    flow_coefficients((size_t)k->m_pad, omega, zeta, l->h, scalars(l->coef), (size_t)k->m_pad);
    for (int i = 0; i < k->m_pad; i++) {
        const Decay d = decay_of(zeta[i]);
        const double wh = omega[i] * l->h, error = d.fourth * wh * wh * wh * wh / 384;
        const int slow = wh * (zeta[i] > STIFFLY_DAMPED ? 2 * zeta[i] : 1) < FAST_MODE;
        const double bound = (slow ? error : 1) * d.amplitude;
        scalars(l->slow)[i] = slow;
        scalars(l->kappa)[i] = bound;
        scalars(l->kappa_accel)[i] = bound * omega[i] * omega[i] * d.acceleration;
        const double damped = wh * (1 + 2 * zeta[i]);
        scalars(l->cubic)[i] = d.amplitude * cubic_misses(damped) * scalars(k->most)[i];
        scalars(l->parabola)[i] = d.amplitude * parabola_misses(damped);
        scalars(l->parabola_accel)[i] = scalars(l->parabola)[i] * omega[i] * omega[i] * d.acceleration;
    }
    l->has_flow = 1;
}

/* w at the end of the step answers a ramp x and a bubble x (1 - x) of force at floor j with column j of these. */
static void level_response(FastWork *k, Level *l)
{
    const double *coef = scalars_const(l->coef);
    const int size = k->n * k->n_pad;
    memset(l->response, 0, sizeof(double) * (size_t)(RESPONSES * size));
    for (int i = 0; i < k->m_pad; i++) {
        const double *row = k->R + i * k->n_pad;
        const double w1 = coef[(FLOW_Q + 3) * k->m_pad + i], w2 = coef[(FLOW_Q + 4) * k->m_pad + i];
        const double v1 = coef[(FLOW_V + 3) * k->m_pad + i], v2 = coef[(FLOW_V + 4) * k->m_pad + i];
        const double unit[RESPONSES] = {[RAMP_W] = w1, [BUBBLE_W] = w1 - w2, [RAMP_V] = v1, [BUBBLE_V] = v1 - v2};
        for (int r = 0; r < RESPONSES; r++)
            for (int j = 0; j < k->n; j++) {
                const double c = unit[r] * row[j];
                double *out = l->response + r * size + j * k->n_pad;
                for (int f = 0; f < k->n_pad; f++)
                    out[f] += c * row[f];
            }
    }
    for (int i = 0; i < k->n; i++)
        for (int j = 0; j < k->n; j++) {
            const double *r = l->response + i * k->n_pad + j, w = r[BUBBLE_W * size], v = r[BUBBLE_V * size];
            l->reply[i * k->n + j] = (v4){r[RAMP_W * size] - 3 * w, 6 * w, r[RAMP_V * size] - 3 * v, 6 * v};
        }
    l->has_response = 1;
}

static Level *level_ready(FastWork *k, int index, int with_response)
{
    Level *l = &k->level[index];
    if (!l->has_flow) {
        l->h = ldexp(k->base, -index);
        level_flow(k, l);
    }
    if (with_response && !l->has_response)
        level_response(k, l);
    return l;
}

static void set_base(FastWork *k, double base)
{
    if (base == k->base)
        return;
    k->base = base;
    for (int i = 0; i <= LEVEL_MAX; i++) {
        k->level[i].has_flow = k->level[i].has_response = 0;
        /* a contact lasts shortest_at_1 speed^-0.2 */
        k->level[i].speed_max = pow(k->shortest_at_1 / (ldexp(base, -i) * k->knobs->steps_per_contact), 5);
    }
}

static void copy_mode(FastWork *k, const SimModel *model, int from, int to)
{
    scalars(k->omega)[to] = model->omega[from];
    scalars(k->zeta)[to] = model->zeta[from];
    scalars(k->gamma)[to] = model->gamma[from];
    for (int j = 0; j < k->n_pad; j++) {
        const double r = model->R[from * model->n_pad + j];
        k->R[to * k->n_pad + j] = k->RT[j * k->m_pad + to] = r;
        k->R_abs[to * k->n_pad + j] = fabs(r);
        k->D_abs[to * k->n_pad + j] = j < k->n ? fabs(r - (j > 0 ? model->R[from * model->n_pad + j - 1] : 0)) : 0;
    }
}

/* How much softer the core modes from nc on, left out, would make a contact at 1 m/s: the worst floor's static
 * flexibility sum R^2 / w^2 over that of the contact at its deepest, 1 / (1.5 k sqrt(p)). */
static double flexibility_left_out(const SimModel *model, int nc)
{
    double worst = 0;
    for (int j = 0; j < model->n; j++) {
        const double depth = contact_hertz_penetration(model->contact.k, model->mass_eff[j], 1.0);
        double sum = 0;
        for (int i = model->nb + nc; i < model->m; i++) {
            const double r = model->R[i * model->n_pad + j] / model->omega[i];
            sum += r * r;
        }
        worst = fmax(worst, sum * 1.5 * model->contact.k * sqrt(depth));
    }
    return worst;
}

/* The fewest core modes that will do; whole vectors, since a part of one costs as much. */
static int core_modes_needed(const SimModel *model, double allowed)
{
    int nc = model->nc < PAD ? model->nc : PAD;
    while (nc < model->nc && !(flexibility_left_out(model, nc) <= allowed))
        nc = nc + PAD < model->nc ? nc + PAD : model->nc;
    return nc;
}

static void find_most(FastWork *k)
{
    for (int i = 0; i < k->m_pad; i++) {
        double most = 0, most_drift = 0;
        for (int j = 0; j < k->n; j++) {
            most = larger(k->R_abs[i * k->n_pad + j], most);
            most_drift = larger(k->D_abs[i * k->n_pad + j], most_drift);
        }
        scalars(k->most)[i] = most;
        scalars(k->most_drift)[i] = most_drift;
    }
}

static void take_model(FastWork *k, const SimModel *model, double base)
{
    k->model = model;
    k->nc = core_modes_needed(model, k->knobs->flexibility_left_out);
    k->nb_pad = (model->nb + PAD - 1) / PAD * PAD;
    k->m_pad = k->nb_pad + (k->nc + PAD - 1) / PAD * PAD;
    k->nf = k->n_pad / LANES;
    k->bf = k->nb_pad / LANES;
    k->mf = k->m_pad / LANES;
    memset(k->R, 0, sizeof(double) * (size_t)(k->m_pad * k->n_pad));
    memset(k->R_abs, 0, sizeof(double) * (size_t)(k->m_pad * k->n_pad));
    memset(k->D_abs, 0, sizeof(double) * (size_t)(k->m_pad * k->n_pad));
    memset(k->RT, 0, sizeof(double) * (size_t)(k->m_pad * k->n_pad));
    for (int i = 0; i < k->m_pad; i++) {
        scalars(k->omega)[i] = 1;
        scalars(k->zeta)[i] = 0.5;
        scalars(k->gamma)[i] = 0;
    }
    for (int i = 0; i < model->nb; i++)
        copy_mode(k, model, i, i);
    for (int i = 0; i < k->nc; i++)
        copy_mode(k, model, model->nb + i, k->nb_pad + i);
    find_most(k);
    k->may_glide = 1;
    for (int i = 0; i < k->m_pad; i++) {
        const double omega = scalars(k->omega)[i], zeta = scalars(k->zeta)[i];
        scalars(k->decay)[i] = 2 * zeta * omega;
        scalars(k->wd_inverse)[i] = omega == 0              ? base
                                    : zeta > STIFFLY_DAMPED ? 1 / omega
                                                            : 1 / (omega * sqrt(1 - zeta * zeta));
        scalars(k->flex)[i] = omega > 0 ? 1 / (omega * omega) : 0;
        k->may_glide = k->may_glide && omega > 0 && zeta <= STIFFLY_DAMPED;
    }
    memcpy(k->gap, model->gap, sizeof(double) * (size_t)k->n_pad);
}

/* The integral of mode i's equation of motion over a step, dv + 2 zeta w dq + w^2 int q dt - int p dt [sqrt(J)]: zero
 * but for rounding where the coefficients of q, q' and int q agree. mean: of q; load: mean of p. */
static inline vec momentum_gap(const FastWork *k, double h, int i, vec dq, vec dv, vec mean, vec load)
{
    return dv + k->decay[i] * dq + h * (k->omega[i] * k->omega[i] * mean - load);
}

/* Vector i of modes at the end of a step, q1 and v1, under the load p0 + p1 x. */
static inline void flow_modes(FastWork *k, const Level *l, int i, vec p0, vec p1)
{
    const vec *c = l->coef, q = k->q[i], v = k->v[i];
    const int mf = k->mf;
    k->q1[i] = c[FLOW_Q * mf + i] * q + c[(FLOW_Q + 1) * mf + i] * v + c[(FLOW_Q + 2) * mf + i] * p0 +
               c[(FLOW_Q + 3) * mf + i] * p1;
    k->v1[i] = c[FLOW_V * mf + i] * q + c[(FLOW_V + 1) * mf + i] * v + c[(FLOW_V + 2) * mf + i] * p0 +
               c[(FLOW_V + 3) * mf + i] * p1;
}

static void start_at_rest(FastWork *k)
{
    const vec zero = {0};
    for (int i = 0; i < k->mf; i++)
        k->q[i] = k->v[i] = k->load[i] = k->work[i] = k->ground[i] = k->drift[i] = zero;
    for (int f = 0; f < k->nf; f++)
        k->w[f] = k->wd[f] = k->f0[f] = k->f1[f] = k->fb[f] = k->peak_u[f] = k->peak_d[f] = k->peak_a[f] = zero;
    for (int j = k->n; j < k->n_pad; j++)
        scalars(k->peak_u)[j] = scalars(k->peak_d)[j] = scalars(k->peak_a)[j] = 1e300;
    memset(k->side, 0, sizeof k->side);
    k->touching = 0;
    k->floors = UINT64_MAX >> (64 - k->n);
    k->landed = 0;
    k->speed = 0;
    k->contact_lost = k->contact_clamped = k->deepest = 0;
    k->impacts = k->floored = k->steps = k->flights = k->forces = 0;
}

#endif
