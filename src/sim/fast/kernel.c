/* Compiled once per instruction set with FAST_KERNEL naming the entry; see fast.h for the method. */
#include "sim/fast/kernel.h"

#include <math.h>
#include <string.h>

#include "sim/fast/touch.h"

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

/* ---- tables of one step length ------------------------------------------------------------------------------- */

static void level_flow(FastWork *k, Level *l)
{
    const double *omega = scalars_const(k->omega), *zeta = scalars_const(k->zeta);
    flow_coefficients((size_t)k->m_pad, omega, zeta, l->h, scalars(l->coef), (size_t)k->m_pad);
    for (int i = 0; i < k->m_pad; i++) {
        const double over = zeta[i] > 0.99 ? zeta[i] + sqrt(fmax(zeta[i] * zeta[i] - 1, 0)) : 1;
        const double wh = omega[i] * over * l->h, error = wh * wh * wh * wh / 384;
        const int slow = wh < FAST_MODE;
        /* overdamped: |x| + |x' + zeta w x| t instead of the amplitude of a sine, at most sqrt(2) times its root */
        const double bound = (slow ? error : 1) * (over > 1 ? sqrt(2.0) : 1);
        scalars(l->slow)[i] = slow;
        scalars(l->kappa)[i] = bound;
        scalars(l->kappa_accel)[i] = bound * omega[i] * omega[i] * (1 + 2 * zeta[i]);
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

/* ---- a design's modes and a state of rest --------------------------------------------------------------------- */

static void copy_mode(FastWork *k, const SimModel *model, int from, int to)
{
    scalars(k->omega)[to] = model->omega[from];
    scalars(k->zeta)[to] = model->zeta[from];
    scalars(k->gamma)[to] = model->gamma[from];
    for (int j = 0; j < k->n_pad; j++) {
        const double r = model->R[from * model->n_pad + j];
        k->R[to * k->n_pad + j] = k->RT[j * k->m_pad + to] = r;
        k->R_abs[to * k->n_pad + j] = fabs(r);
    }
}

static void take_model(FastWork *k, const SimModel *model, double base)
{
    k->model = model;
    k->nb_pad = (model->nb + PAD - 1) / PAD * PAD;
    k->m_pad = k->nb_pad + (model->nc + PAD - 1) / PAD * PAD;
    k->nf = k->n_pad / LANES;
    k->bf = k->nb_pad / LANES;
    k->mf = k->m_pad / LANES;
    memset(k->R, 0, sizeof(double) * (size_t)(k->m_pad * k->n_pad));
    memset(k->R_abs, 0, sizeof(double) * (size_t)(k->m_pad * k->n_pad));
    memset(k->RT, 0, sizeof(double) * (size_t)(k->m_pad * k->n_pad));
    for (int i = 0; i < k->m_pad; i++) {
        scalars(k->omega)[i] = 1;
        scalars(k->zeta)[i] = 0.5;
        scalars(k->gamma)[i] = 0;
    }
    for (int i = 0; i < model->nb; i++)
        copy_mode(k, model, i, i);
    for (int i = 0; i < model->nc; i++)
        copy_mode(k, model, model->nb + i, k->nb_pad + i);
    for (int i = 0; i < k->m_pad; i++) {
        const double omega = scalars(k->omega)[i], zeta = scalars(k->zeta)[i];
        scalars(k->decay)[i] = 2 * zeta * omega;
        scalars(k->wd_inverse)[i] = zeta > 0.99 || omega == 0 ? base : 1 / (omega * sqrt(1 - zeta * zeta));
        scalars(k->flex)[i] = omega > 0 ? 1 / (omega * omega) : 0;
    }
    memcpy(k->gap, model->gap, sizeof(double) * (size_t)k->n_pad);
}

static void start_at_rest(FastWork *k)
{
    const vec zero = {0};
    for (int i = 0; i < k->mf; i++)
        k->q[i] = k->v[i] = k->load[i] = k->work[i] = k->ground[i] = zero;
    for (int f = 0; f < k->nf; f++)
        k->w[f] = k->wd[f] = k->f0[f] = k->f1[f] = k->fb[f] = k->f_before[f] = k->fb_before[f] = k->peak_u[f] = k->peak_d[f] = k->peak_a[f] = zero;
    memset(k->side, 0, sizeof k->side);
    k->n_touching = 0;
    k->n_seen = -1;
    k->speed = 0;
    k->contact_lost = k->contact_clamped = k->deepest = 0;
    k->impacts = k->floored = k->steps = k->flights = k->forces = 0;
}

/* ---- flight ------------------------------------------------------------------------------------------------- */

static void flight_modes(FastWork *k, const Level *l, double a0, double a1)
{
    const vec *c = l->coef;
    const int mf = k->mf;
    const double rate = (a1 - a0) / l->h;
    for (int i = 0; i < mf; i++) {
        const vec q = k->q[i], v = k->v[i], p0 = -k->gamma[i] * a0, p1 = -k->gamma[i] * (a1 - a0);
        k->q1[i] = c[FLOW_Q * mf + i] * q + c[(FLOW_Q + 1) * mf + i] * v + c[(FLOW_Q + 2) * mf + i] * p0 +
                   c[(FLOW_Q + 3) * mf + i] * p1;
        k->v1[i] = c[FLOW_V * mf + i] * q + c[(FLOW_V + 1) * mf + i] * v + c[(FLOW_V + 2) * mf + i] * p0 +
                   c[(FLOW_V + 3) * mf + i] * p1;
        /* quasi-static answer to the linear load, and the free vibration around it */
        const vec flex = k->flex[i], decay = k->decay[i], stiff = k->omega[i] * k->omega[i], slow = l->slow[i];
        const vec static_v = -k->gamma[i] * rate * flex, static_0 = (p0 - decay * static_v) * flex,
                 static_1 = static_0 + l->h * static_v;
        const vec x = q - static_0, xd = (v - static_v + 0.5 * decay * x) * k->wd_inverse[i];
        k->amplitude[i] = vec_sqrt(x * x + xd * xd);
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

/* Largest |value| of the cubic through both ends anywhere in the step: its Bezier control points enclose it. */
static vec hull(vec y0, vec d0, vec y1, vec d1, double h)
{
    const double third = h / 3;
    return vec_max(vec_max(vec_abs(y0), vec_abs(y0 + third * d0)), vec_max(vec_abs(y1 - third * d1), vec_abs(y1)));
}

static void flight_floors(FastWork *k, const Level *l)
{
    const vec *R = (const vec *)k->R, *R_abs = (const vec *)k->R_abs;
    const int core = k->nb_pad, core_count = k->m_pad - k->nb_pad;
    const double *const state[4] = {scalars_const(k->qa), scalars_const(k->va), scalars_const(k->qb),
                                    scalars_const(k->vb)};
    vec *const floors[4] = {k->u0, k->u0d, k->u1, k->u1d};
    rows_times(4, R, k->nf, core, state, floors);
    for (int i = 0; i < k->mf; i++) {
        k->bound[i] = l->kappa[i] * k->amplitude[i];
        k->bound_a[i] = hull(k->za[i], k->ja[i], k->zb[i], k->jb[i], l->h) + l->kappa_accel[i] * k->amplitude[i];
    }
    const double *const bounds[2] = {scalars_const(k->bound), scalars_const(k->bound_a)};
    vec *const errors[2] = {k->e_u, k->reach_a};
    rows_times(2, R_abs, k->nf, core, bounds, errors);
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
    rows_times(4, (const vec *)k->R, k->nf, k->nb_pad, accel, accels);
    for (int i = 0; i < k->bf; i++)
        k->bound_a[i] = l->kappa_accel[i] * k->amplitude[i];
    const double *const bound[1] = {scalars_const(k->bound_a)};
    vec *const error[1] = {k->e_a};
    rows_times(1, (const vec *)k->R_abs, k->nf, k->nb_pad, bound, error);
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
static int raise_peaks(vec *peak, int n, int nf, const vec *y0, const vec *d0, const vec *y1, const vec *d1, const vec *e,
                       double h, double tolerance)
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

static int accelerations_in_flight(FastWork *k, const Level *l, double tolerance)
{
    flight_accelerations(k, l);
    return raise_peaks(k->peak_a, k->n, k->nf, k->a0, k->a0d, k->a1, k->a1d, k->e_a, l->h, tolerance);
}

static int exceeds(const vec *reach, const vec *peak, int nf)
{
    mask over = {0};
    for (int f = 0; f < nf; f++)
        over |= ~(reach[f] <= peak[f]);
    return any(over);
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
    return raise_peaks(k->peak_u, k->n, k->nf, k->u0, k->u0d, k->u1, k->u1d, k->e_u, h, tolerance) &&
           raise_peaks(k->peak_d, k->n, k->nf, d0, d0d, d1, d1d, e, h, tolerance) &&
           (!exceeds(k->reach_a, k->peak_a, k->nf) || accelerations_in_flight(k, l, tolerance));
}

static double largest(const vec *a, int nf)
{
    vec most = vec_abs(a[0]);
    for (int f = 1; f < nf; f++)
        most = vec_max(most, vec_abs(a[f]));
    double m = 0;
    for (int lane = 0; lane < LANES; lane++)
        m = fmax(m, most[lane]);
    return m;
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
    }
}

static void swap(vec **a, vec **b)
{
    vec *t = *a;
    *a = *b;
    *b = t;
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
    k->n_seen = -1;
    return 1;
}

/* ---- contact ------------------------------------------------------------------------------------------------ */

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

/* From flight to contact steps: w and w' exactly, and a first sample for the peaks. */
static void land(FastWork *k)
{
    const double *const state[2] = {scalars_const(k->q), scalars_const(k->v)};
    vec *const floors[2] = {k->w, k->wd};
    rows_times(2, (const vec *)k->R, k->nf, k->m_pad, state, floors);
    outputs(k, k->q, k->v, k->seen[0][0], k->seen[0][1], k->seen[0][2]);
    k->n_seen = 1;
    k->h_before = 1;
}

static void contact_predict(FastWork *k, const Level *l, double a0, double a1)
{
    const vec *c = l->coef;
    const int mf = k->mf;
    for (int i = 0; i < mf; i++) {
        const vec q = k->q[i], v = k->v[i], p0 = k->load[i] - k->gamma[i] * a0,
                 p1 = -k->gamma[i] * (a1 - a0) - k->load[i];
        k->q1[i] = c[FLOW_Q * mf + i] * q + c[(FLOW_Q + 1) * mf + i] * v + c[(FLOW_Q + 2) * mf + i] * p0 +
                   c[(FLOW_Q + 3) * mf + i] * p1;
        k->v1[i] = c[FLOW_V * mf + i] * q + c[(FLOW_V + 1) * mf + i] * v + c[(FLOW_V + 2) * mf + i] * p0 +
                   c[(FLOW_V + 3) * mf + i] * p1;
    }
    const double *const state[2] = {scalars_const(k->q1), scalars_const(k->v1)};
    vec *const floors[2] = {k->w1, k->wd1};
    rows_times(2, (const vec *)k->R, k->nf, k->m_pad, state, floors);
}

/* What both walls do to one floor over a step; as Touch, in w instead of p. */
typedef struct {
    double end, mean, end_w, end_v, mean_w, mean_v, v0, lost, clamped;
    int closings, floored;
} Press;

/* Gives floor j the force f1 at the end and the bubble fb; w1 and w1' of all floors follow. */
static void apply_force(FastWork *k, const Level *l, int j, double f1, double fb)
{
    const int nf = k->nf, size = k->n * nf;
    const vec *r = (const vec *)l->response + j * nf;
    const double d1 = f1 - scalars(k->f1)[j], db = fb - scalars(k->fb)[j];
    for (int f = 0; f < nf; f++) {
        k->w1[f] += r[RAMP_W * size + f] * d1 + r[BUBBLE_W * size + f] * db;
        k->wd1[f] += r[RAMP_V * size + f] * d1 + r[BUBBLE_V * size + f] * db;
    }
    scalars(k->f1)[j] = f1;
    scalars(k->fb)[j] = fb;
}

/* The force law along the path of floor j to w1, w1', both walls: a path may leave one and reach the other. Forces push
 * the floor to the negative side. */
static void press(FastWork *k, double h, int j, double w1, double w1d, Press *out)
{
    const double w0 = scalars(k->w)[j], w0d = scalars(k->wd)[j], gap = scalars(k->gap)[j], third = h / 3;
    const double b1 = w0 + third * w0d, b2 = w1 - third * w1d; /* with w0 and w1 they enclose the path */
    *out = (Press){0};
    for (int wall = 0; wall < 2; wall++) {
        const double s = wall == 0 ? 1 : -1;
        if (s * w0 <= gap && s * b1 <= gap && s * b2 <= gap && s * w1 <= gap)
            continue;
        Touch t;
        touch_step(&t, &k->model->contact, k->model->mass_eff[j], h, s * w0 - gap, s * w0d, s * w1 - gap, s * w1d,
                   k->side[j] == s, larger(k->v0[j], k->model->contact.v0_floor));
        k->forces++;
        out->end += s * t.end;
        out->mean += s * t.mean;
        out->end_w += t.end_p;
        out->end_v += t.end_v;
        out->mean_w += t.mean_p;
        out->mean_v += t.mean_v;
        out->lost += t.lost;
        out->clamped += t.clamped;
        out->closings += t.closings;
        out->floored += t.floored;
        if (s * w1 > gap)
            out->v0 = t.v0;
    }
}

/* The floors that may touch in this step, and the small dense problem of their forces:
 *   w1_i  = free_i  - sum_j (g[i][j].w_end F_j + .w_mean M_j),   w1_i' with .v_end, .v_mean,
 *   (F_i, M_i) = force at the end and mean force by the law along the path to w1_i, w1_i' */
typedef struct {
    double w_end, w_mean, v_end, v_mean;
} Reply;

typedef struct {
    int n, floor[FLOORS_PAD_MAX];
    unsigned char listed[FLOORS_PAD_MAX];
    double w1[FLOORS_PAD_MAX], wd1[FLOORS_PAD_MAX], F[FLOORS_PAD_MAX], M[FLOORS_PAD_MAX];
    double scale_w[FLOORS_PAD_MAX], scale_v[FLOORS_PAD_MAX]; /* what the step moves */
    Press press[FLOORS_PAD_MAX];
    Reply g[FLOORS_PAD_MAX * FLOORS_PAD_MAX];                /* (n, n) */
    double J[4 * FLOORS_PAD_MAX * FLOORS_PAD_MAX];           /* (2n, 2n) factors of Newton's matrix */
    int order[2 * FLOORS_PAD_MAX];
} Active;

/* Lists the floors whose path may leave the gap; returns how many were new. */
static int find_closings(FastWork *k, const Level *l, Active *active)
{
    int found = 0;
    for (int f = 0; f < k->nf; f++) {
        const mask out = ~(hull(k->w[f], k->wd[f], k->w1[f], k->wd1[f], l->h) <= k->gap[f]);
        if (!any(out))
            continue;
        for (int lane = 0; lane < LANES; lane++) {
            const int j = f * LANES + lane;
            if (!out[lane] || active->listed[j] || j >= k->n)
                continue;
            active->listed[j] = 1;
            active->floor[active->n++] = j;
            found++;
        }
    }
    return found;
}

static void list_touching(FastWork *k, Active *active)
{
    active->n = 0;
    memset(active->listed, 0, sizeof active->listed);
    for (int j = 0; k->n_touching && j < k->n; j++)
        if (k->side[j]) {
            active->listed[j] = 1;
            active->floor[active->n++] = j;
        }
}

/* A (n, n) row-major := its factors L U with row exchange order[]; 0: singular or not finite. */
static int factorise(int n, double *A, int order[])
{
    for (int c = 0; c < n; c++) {
        int top = c;
        for (int r = c + 1; r < n; r++)
            if (fabs(A[r * n + c]) > fabs(A[top * n + c]))
                top = r;
        const double pivot = A[top * n + c];
        if (!(fabs(pivot) > 0) || !isfinite(pivot))
            return 0;
        order[c] = top;
        for (int j = 0; top != c && j < n; j++) {
            const double kept = A[c * n + j];
            A[c * n + j] = A[top * n + j];
            A[top * n + j] = kept;
        }
        const double inverse = 1 / pivot;
        for (int r = c + 1; r < n; r++) {
            const double f = A[r * n + c] *= inverse;
            if (f != 0)
                for (int j = c + 1; j < n; j++)
                    A[r * n + j] -= f * A[c * n + j];
        }
    }
    return 1;
}

static void substitute(int n, const double *A, const int order[], double x[])
{
    for (int c = 0; c < n; c++) {
        const double kept = x[c];
        x[c] = x[order[c]];
        x[order[c]] = kept;
    }
    for (int r = 1; r < n; r++)
        for (int c = 0; c < r; c++)
            x[r] -= A[r * n + c] * x[c];
    for (int r = n - 1; r >= 0; r--) {
        for (int c = r + 1; c < n; c++)
            x[r] -= A[r * n + c] * x[c];
        x[r] /= A[r * n + r];
    }
}

/* Takes in floors n_before..n-1, whose w1 and w1' are free of their own force, with a first guess of it: the polynomial
 * of the step before goes on. */
static void take_in(FastWork *k, const Level *l, Active *a, int n_before)
{
    const int size = k->n * k->n_pad;
    for (int i = n_before; i < a->n; i++) {
        const int j = a->floor[i];
        const double w0 = scalars(k->w)[j], v0 = scalars(k->wd)[j], gap = scalars(k->gap)[j];
        const double w1 = scalars(k->w1)[j], v1 = scalars(k->wd1)[j];
        a->scale_v[i] = fabs(v0) + fabs(v1);
        a->scale_w[i] = fabs(fabs(w0) - gap) + fabs(fabs(w1) - gap) + l->h * a->scale_v[i];
        const double f0 = scalars(k->f0)[j], r = l->h / k->h_before, b = scalars(k->fb_before)[j];
        const double f1 = f0 + r * (f0 - scalars(k->f_before)[j]) - b * r * (1 + r);
        if (f1 * f0 > 0)
            apply_force(k, l, j, f1, b * r * r);
        else
            apply_force(k, l, j, f0, 0);
    }
    for (int i = 0; i < a->n; i++) {
        const int j = a->floor[i];
        a->w1[i] = scalars(k->w1)[j];
        a->wd1[i] = scalars(k->wd1)[j];
        a->F[i] = -scalars(k->f1)[j];
        a->M[i] = (-scalars(k->fb)[j] - 3 * scalars(k->f0)[j] + 3 * a->F[i]) / 6;
        for (int c = 0; c < a->n; c++) {
            const double *r = l->response + j * k->n_pad + a->floor[c];
            const double w_b = r[BUBBLE_W * size], v_b = r[BUBBLE_V * size];
            a->g[i * a->n + c] =
                (Reply){r[RAMP_W * size] - 3 * w_b, 6 * w_b, r[RAMP_V * size] - 3 * v_b, 6 * v_b};
        }
    }
}

/* Newton's matrix I + (slopes of the law) (replies of w1, w1'), factorised; 0: singular. */
static int take_slopes(Active *a)
{
    const int n = a->n;
    for (int i = 0; i < n; i++) {
        const Press *t = &a->press[i];
        double *row = a->J + 4 * i * n;
        for (int j = 0; j < n; j++, row += 2) {
            const Reply *g = &a->g[i * n + j];
            row[0] = t->end_w * g->w_end + t->end_v * g->v_end + (i == j);
            row[1] = t->end_w * g->w_mean + t->end_v * g->v_mean;
            row[2 * n] = t->mean_w * g->w_end + t->mean_v * g->v_end;
            row[2 * n + 1] = t->mean_w * g->w_mean + t->mean_v * g->v_mean + (i == j);
        }
    }
    return factorise(2 * n, a->J, a->order);
}

/* One step of Newton's method, with the matrix of this state or (not fresh) of an earlier one. Returns the largest change
 * of w1 and w1' relative to what the step moves, or NaN when there is none. */
static double improve_forces(FastWork *k, double h, Active *a, int fresh)
{
    const int n = a->n;
    double x[2 * FLOORS_PAD_MAX], change = 0;
    for (int i = 0; i < n; i++) {
        press(k, h, a->floor[i], a->w1[i], a->wd1[i], &a->press[i]);
        x[2 * i] = a->F[i] - a->press[i].end;
        x[2 * i + 1] = a->M[i] - a->press[i].mean;
    }
    if (fresh && !take_slopes(a))
        return NAN;
    substitute(2 * n, a->J, a->order, x);
    for (int i = 0; i < n; i++) {
        double dw = 0, dv = 0;
        for (int j = 0; j < n; j++) {
            const Reply *g = &a->g[i * n + j];
            dw += g->w_end * x[2 * j] + g->w_mean * x[2 * j + 1];
            dv += g->v_end * x[2 * j] + g->v_mean * x[2 * j + 1];
        }
        a->w1[i] += dw;
        a->wd1[i] += dv;
        a->F[i] -= x[2 * i];
        a->M[i] -= x[2 * i + 1];
        const double c = larger(fabs(dw) / a->scale_w[i], fabs(dv) / a->scale_v[i]);
        if (!(c <= change))
            change = c;
    }
    return change;
}

static void hand_out(FastWork *k, const Level *l, const Active *a)
{
    for (int i = 0; i < a->n; i++) {
        const int j = a->floor[i];
        apply_force(k, l, j, -a->F[i], -(6 * a->M[i] + 3 * scalars(k->f0)[j] - 3 * a->F[i]));
    }
}

/* The forces of all floors at once by Newton's method; 0 when they cannot be had at this step length. */
static int solve_contacts(FastWork *k, const Level *l, double tolerance, Active *active)
{
    enum { MOST = 40 };
    list_touching(k, active);
    int before = 0, fresh = 1;
    double last = 0;
    if (active->n == 0 && !find_closings(k, l, active))
        return 1;
    for (int i = 0; i < MOST; i++) {
        if (active->n > before) {
            take_in(k, l, active, before);
            before = active->n;
            fresh = 1;
        }
        const double change = improve_forces(k, l->h, active, fresh);
        if (!(change >= 0))
            return 0;
        fresh = change > 0.1 * last; /* an old matrix serves while it gains a digit a step */
        last = change;
        if (change > tolerance)
            continue;
        hand_out(k, l, active);
        if (!find_closings(k, l, active))
            return 1;
    }
    return 0;
}

static void forget_forces(FastWork *k)
{
    const vec zero = {0};
    for (int f = 0; f < k->nf; f++)
        k->f1[f] = k->fb[f] = zero;
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
        k->q1[i] = q1;
        k->v1[i] = v1;
        taken += work;
    }
    return lanes_sum(taken);
}

/* How far the energy that the modes gave to the contacts, by their exact motion, is from what the force law took along
 * its cubic paths: zero but for the error of the step. */
static double step_mismatch(const FastWork *k, const Active *active, double work)
{
    double taken = 0;
    for (int i = 0; i < active->n; i++) {
        const int j = active->floor[i];
        const double gap = scalars_const(k->gap)[j];
        taken += active->press[i].lost + active->press[i].clamped;
        taken += contact_stored(&k->model->contact, fabs(scalars_const(k->w1)[j]) - gap) -
                 contact_stored(&k->model->contact, fabs(scalars_const(k->w)[j]) - gap);
    }
    return fabs(work + taken);
}

static void accept_contacts(FastWork *k, const Active *active, double h)
{
    k->n_touching = 0;
    for (int i = 0; i < active->n; i++) {
        const int j = active->floor[i];
        const Press *t = &active->press[i];
        const double w0 = scalars(k->w)[j], w1 = scalars(k->w1)[j], gap = scalars(k->gap)[j];
        k->contact_lost += t->lost;
        k->contact_clamped += t->clamped;
        k->impacts += t->closings;
        k->floored += t->floored;
        k->side[j] = w1 > gap ? 1 : -w1 > gap ? -1 : 0;
        k->v0[j] = t->v0;
        if (t->mean != 0)
            k->deepest =
                fmax(k->deepest, largest_on_cubic(h, w0, scalars(k->wd)[j], w1, scalars(k->wd1)[j]) - gap);
        k->n_touching += k->side[j] != 0;
    }
    swap(&k->q, &k->q1);
    swap(&k->v, &k->v1);
    swap(&k->load, &k->qa);
    swap(&k->work, &k->work1);
    swap(&k->ground, &k->ground1);
    swap(&k->w, &k->w1);
    swap(&k->wd, &k->wd1);
    vec *const free_slot = k->f_before;
    k->f_before = k->f0;
    k->f0 = k->f1;
    k->f1 = free_slot;
    swap(&k->fb, &k->fb_before);
    k->h_before = h;
    forget_forces(k);
    k->speed = largest(k->wd, k->nf);
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

static int closes(const Active *active)
{
    for (int i = 0; i < active->n; i++)
        if (active->press[i].closings)
            return 1;
    return 0;
}

/* One step with whatever contacts it holds; 0 when it must be shorter and nothing has changed. */
static int contact_step(FastWork *k, const Level *l, double a0, double a1, int finest)
{
    Active active;
    if (k->n_seen < 0)
        land(k);
    k->steps++;
    contact_predict(k, l, a0, a1);
    if (!solve_contacts(k, l, k->knobs->solver_tolerance, &active)) {
        forget_forces(k);
        return 0;
    }
    if (!finest && closes(&active)) {
        forget_forces(k);
        return 0;
    }
    const double work = contact_update(k, l, &active, a0, a1);
    const double mismatch = step_mismatch(k, &active, work), allowed = k->knobs->energy_tolerance * k->energy_scale;
    if (!finest && !(mismatch <= allowed)) {
        forget_forces(k);
        return 0;
    }
    k->may_grow = mismatch <= allowed / 32;
    accept_contacts(k, &active, l->h);
    peaks_in_contact(k, l->h);
    return 1;
}

/* ---- time --------------------------------------------------------------------------------------------------- */

/* The level whose step is the wanted share of the shortest Hertz contact at the present speed (or the finest). */
static int contact_level(const FastWork *k, double gain)
{
    const double speed = k->speed + gain;
    int level = 0;
    while (level < LEVEL_MAX && speed > k->level[level].speed_max)
        level++;
    return level;
}

/* Duration of the shortest contact at 1 m/s; it goes with speed^-0.2. */
static double shortest_contact(const SimModel *model)
{
    double least = 1e300;
    for (int j = 0; j < model->n; j++)
        least = fmin(least, contact_hertz_duration(model->contact.k, model->mass_eff[j], 1.0));
    return least;
}

/* What the energy of one step's error is measured by: the input so far. */
static double energy_scale(const FastWork *k)
{
    vec sum = {0};
    for (int i = 0; i < k->mf; i++)
        sum += k->ground[i];
    return fabs(lanes_sum(sum));
}

/* Will an open gap have closed after h at the present speed? */
static int closing_ahead(const FastWork *k, double h)
{
    mask ahead = {0};
    for (int f = 0; f < k->nf; f++)
        ahead |= (vec_abs(k->w[f] + h * k->wd[f]) > k->gap[f]) & (vec_abs(k->w[f]) <= k->gap[f]);
    return any(ahead);
}

/* One sampling interval, ground acceleration from a0 to a1; 0 when no step is short enough. */
static int interval(FastWork *k, double a0, double a1)
{
    const uint32_t whole = UINT32_C(1) << LEVEL_MAX;
    uint32_t at = 0;
    k->energy_scale = energy_scale(k);
    /* at rest for a moment is no reason for a step in which the ground makes speed again */
    const double gain = 0.1 * k->base * fmax(fabs(a0), fabs(a1));
    while (at < whole) {
        const int aligned = at ? LEVEL_MAX - __builtin_ctz(at) : 0;
        const int finest = k->m_pad > k->nb_pad ? contact_level(k, gain) : LEVEL_MAX;
        int level = k->flight_level > aligned ? k->flight_level : aligned, done = 0;
        for (; !done && !k->n_touching && level < finest; level++) {
            const uint32_t step = whole >> level;
            done = flight(k, level_ready(k, level, 0), a0 + (a1 - a0) * at / whole,
                          a0 + (a1 - a0) * (at + step) / whole);
            if (done) {
                at += step;
                k->flight_level = level > 0 ? level - 1 : 0;
                k->touch_level = LEVEL_MAX;
            }
        }
        if (done)
            continue;
        k->flight_level = finest > 0 ? finest - 1 : 0;
        if (k->touch_level > finest || k->knobs->energy_tolerance == 0)
            k->touch_level = finest;
        while (k->touch_level < finest && k->n_seen >= 0 && closing_ahead(k, ldexp(k->base, -k->touch_level)))
            k->touch_level++;
        for (level = k->touch_level > aligned ? k->touch_level : aligned; !done && level <= LEVEL_MAX; level++) {
            const uint32_t step = whole >> level;
            done = contact_step(k, level_ready(k, level, 1), a0 + (a1 - a0) * at / whole,
                                a0 + (a1 - a0) * (at + step) / whole, level >= finest);
            if (done) {
                at += step;
                k->touch_level = k->may_grow && level > 0 ? level - 1 : level;
            }
        }
        if (!done)
            return 0;
    }
    return 1;
}

static int state_is_finite(const FastWork *k)
{
    vec sum = {0};
    for (int i = 0; i < k->mf; i++)
        sum += k->q[i] * 0.0 + k->v[i] * 0.0;
    double all = 0;
    for (int lane = 0; lane < LANES; lane++)
        all += sum[lane];
    return all == 0;
}

static void show(const FastWork *k, double t)
{
    if (k->sample)
        k->sample(t, k->m_pad, scalars_const(k->omega), scalars_const(k->q), scalars_const(k->v), k->sample_user);
}

static int fly(FastWork *k, const Motion *motion, double duration)
{
    k->shortest_at_1 = shortest_contact(k->model);
    const long full = (long)floor(duration / motion->dt_s * (1 + 1e-14));
    const long samples = (long)motion->n;
    k->flight_level = 0;
    k->touch_level = LEVEL_MAX;
    set_base(k, 0);
    set_base(k, motion->dt_s);
    show(k, 0);
    for (long i = 0; i < full; i++) {
        const double a0 = i + 1 < samples ? motion->accel[i] : 0, a1 = i + 1 < samples ? motion->accel[i + 1] : 0;
        if (!interval(k, a0, a1) || !state_is_finite(k))
            return 0;
        show(k, (double)(i + 1) * motion->dt_s);
    }
    const double rest = duration - (double)full * motion->dt_s;
    if (rest > 1e-9 * motion->dt_s) {
        const double a0 = full + 1 < samples ? motion->accel[full] : 0;
        const double slope = full + 1 < samples ? (motion->accel[full + 1] - a0) / motion->dt_s : 0;
        set_base(k, rest);
        return interval(k, a0, a0 + slope * rest) && state_is_finite(k);
    }
    return 1;
}

/* ---- results ------------------------------------------------------------------------------------------------ */

static double still_stored(const FastWork *k)
{
    double stored = 0;
    for (int j = 0; j < k->n; j++)
        if (k->side[j])
            stored +=
                contact_stored(&k->model->contact, fabs(scalars_const(k->w)[j]) - scalars_const(k->gap)[j]);
    return stored;
}

static double share(double part, double whole)
{
    return whole > 0 ? 100 * part / whole : 0;
}

static void sum_energies(const FastWork *k, SimResult *r)
{
    double contact_work = 0;
    double damped[MODES_PAD_MAX + 2 * LANES];
    for (int i = 0; i < k->m_pad; i++) {
        const double q = scalars_const(k->q)[i], v = scalars_const(k->v)[i], w = scalars_const(k->omega)[i];
        const double energy = 0.5 * (v * v + w * w * q * q);
        const double ground = scalars_const(k->ground)[i], contact = scalars_const(k->work)[i];
        damped[i] = ground + contact - energy;
        r->input_energy_j += ground;
        contact_work += contact;
        r->kinetic_strain_j += energy;
        *(i < k->nb_pad ? &r->damped_building_j : &r->damped_core_j) += damped[i];
    }
    r->contact_loss_j = k->contact_lost;
    r->clamp_j = k->contact_clamped;
    r->contact_stored_j = still_stored(k);
    const double books = -contact_work - r->contact_loss_j - r->clamp_j - r->contact_stored_j;
    r->energy_residual = fabs(books) / energy_books_scale(r->input_energy_j, r->input_energy_j - books);
    for (int i = 0; i < k->model->nb; i++)
        r->mode_share_pct[i] = share(damped[i], r->input_energy_j);
    r->ed1_pct = r->mode_share_pct[0];
    for (int i = 4; i < 10 && i < k->model->nb; i++)
        r->ed5_10_pct += r->mode_share_pct[i];
    r->edcs_pct = share(r->damped_core_j, r->input_energy_j);
}

static void take_peaks(const FastWork *k, SimResult *r)
{
    for (int j = 0; j < k->n; j++) {
        r->peak_displacement_m[j] = scalars_const(k->peak_u)[j];
        r->peak_drift_m[j] = scalars_const(k->peak_d)[j];
        r->peak_acceleration_g[j] = scalars_const(k->peak_a)[j] / 9.81;
        r->j1_m = fmax(r->j1_m, r->peak_displacement_m[j]);
        r->j2_m = fmax(r->j2_m, r->peak_drift_m[j]);
        r->j3_g = fmax(r->j3_g, r->peak_acceleration_g[j]);
    }
}

FastKernel FAST_KERNEL;

void FAST_KERNEL(FastWork *k, const SimModel *model, const Motion *motion, double duration, const FastKnobs *knobs,
                 SimResult *result)
{
    k->knobs = knobs;
    memset(result, 0, sizeof *result);
    take_model(k, model, motion->dt_s);
    start_at_rest(k);
    const int arrived = fly(k, motion, duration);
    result->n_floors = model->n;
    result->n_modes = model->nb;
    if (!arrived)
        result->outcome = state_is_finite(k) ? RUN_OUT_OF_STEPS : RUN_NOT_FINITE;
    take_peaks(k, result);
    sum_energies(k, result);
    result->impacts = k->impacts;
    result->floored = k->floored;
    result->penetration_max_m = k->deepest;
    result->steps = k->steps + k->flights;
    result->force_evaluations = k->forces;
}
