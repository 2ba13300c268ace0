/* sim/fast/forces.h -- the contact forces of one step: the force law along the paths of all touching floors, by
 * Newton's method. Part of the kernel: static functions, compiled once per instruction set. See fast.h for the method.
 */
#ifndef IMTET_SIM_FAST_FORCES_H
#define IMTET_SIM_FAST_FORCES_H

#include <math.h>
#include <string.h>

#include "sim/fast/peaks.h"

/* What both walls do to one floor over a step; as Touch, in w instead of p. */
typedef struct {
    m22 slope;  /* d (end, mean) / d (w1, w1') */
    p2 lost_to; /* d lost / d (w1, w1') */
    double end, mean, v0, lost, clamped, closed_at, closed_with;
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

static inline void press_add(Press *out, const Touch *t, double s)
{
    out->end += s * t->end;
    out->mean += s * t->mean;
    out->slope += (m22){t->end_p, t->end_v, t->mean_p, t->mean_v};
    out->lost += t->lost;
    out->lost_to += s * p2_make(t->lost_p, t->lost_v);
    out->clamped += t->clamped;
}

/* The force law along the path of floor j to w1, w1', both walls: a path may leave one and reach the other. Forces push
 * the floor to the negative side. */
static __attribute__((noinline)) void press(FastWork *k, double h, int j, double w1, double w1d, Press *out)
{
    const double w0 = scalars(k->w)[j], w0d = scalars(k->wd)[j], gap = scalars(k->gap)[j], third = h / 3;
    const double b1 = w0 + third * w0d, b2 = w1 - third * w1d; /* with w0 and w1 they enclose the path */
    const double mass = k->model->mass_eff[j], v0 = larger(k->v0[j], k->model->contact.v0_floor);
    const int side = k->side[j];
    Touch t;
    *out = (Press){0};
    if (side && side * w0 > gap && side * b1 > gap && side * b2 > gap && side * w1 > gap) {
        touch_through(&t, &k->model->contact, mass, h, side * w0 - gap, side * w0d, side * w1 - gap, side * w1d, v0);
        press_add(out, &t, side);
        out->v0 = v0;
        k->forces++;
        return;
    }
    for (int s = 1; s >= -1; s -= 2) {
        if (s * w0 <= gap && s * b1 <= gap && s * b2 <= gap && s * w1 <= gap)
            continue;
        touch_step(&t, &k->model->contact, mass, h, s * w0 - gap, s * w0d, s * w1 - gap, s * w1d, side == s, v0);
        press_add(out, &t, s);
        k->forces++;
        out->closings += t.closings;
        out->floored += t.floored;
        if (t.closings) {
            out->closed_at = t.closed_at;
            out->closed_with = t.closed_with;
        }
        if (s * w1 > gap)
            out->v0 = t.v0;
    }
}

/* The floors that may touch in this step, and the small dense problem of their forces. With the pairs y_i = (w1_i,
 * w1_i') and x_i = (F_i, M_i), force at the end and mean force by the law along the path to y_i,
 *   y_i = free_i - sum_j g_ij x_j */
typedef struct {
    uint64_t listed; /* bit j: floor j is */
    int n, floor[FLOORS_PAD_MAX];
    Press press[FLOORS_PAD_MAX];
    p2 y[FLOORS_PAD_MAX], x[FLOORS_PAD_MAX];
    p2 scale[FLOORS_PAD_MAX];                /* what the step moves, inverted */
    m22 g[FLOORS_PAD_MAX * FLOORS_PAD_MAX];  /* (n, n) */
    m22 LU[FLOORS_PAD_MAX * FLOORS_PAD_MAX]; /* (n, n) of Newton's matrix, pivots inverted */
} Active;

static void list_floors(Active *active, uint64_t floors)
{
    active->listed |= floors;
    for (; floors; floors &= floors - 1)
        active->floor[active->n++] = __builtin_ctzll(floors);
}

/* Lists the floors whose path may leave the gap; returns whether any was new. */
static int find_closings(FastWork *k, const Level *l, Active *active)
{
    uint64_t out = 0;
    for (int f = 0; f < k->nf; f++)
        out |= (uint64_t)lane_bits(~(hull(k->w[f], k->wd[f], k->w1[f], k->wd1[f], l->h) <= k->gap[f])) << f * LANES;
    out &= k->floors & ~active->listed;
    list_floors(active, out);
    return out != 0;
}

/* L U of the matrix of blocks A (n, n), rows in their order: the matrix tends to the unit matrix as the step gets
 * shorter, and where a pivot vanishes Newton does not converge and the step gets shorter. */
INLINE void factorise(const int n, m22 *A)
{
#pragma GCC unroll 8
    for (int c = 0; c < n; c++) {
        const m22 inverse = A[c * n + c] = m22_inverse(A[c * n + c]);
#pragma GCC unroll 8
        for (int r = c + 1; r < n; r++) {
            const m22 f = A[r * n + c] = m22_times(A[r * n + c], inverse);
#pragma GCC unroll 8
            for (int j = c + 1; j < n; j++)
                A[r * n + j] -= m22_times(f, A[c * n + j]);
        }
    }
}

INLINE void substitute(const int n, const m22 *LU, p2 x[])
{
#pragma GCC unroll 8
    for (int r = 1; r < n; r++) {
        v4 sum = {0};
#pragma GCC unroll 8
        for (int c = 0; c < r; c++)
            sum += LU[r * n + c] * x[c];
        x[r] -= p2_sum(sum);
    }
#pragma GCC unroll 8
    for (int r = n - 1; r >= 0; r--) {
        v4 sum = {0};
#pragma GCC unroll 8
        for (int c = r + 1; c < n; c++)
            sum += LU[r * n + c] * x[c];
        x[r] = p2_sum(LU[r * n + r] * (x[r] - p2_sum(sum)));
    }
}

/* Takes in floors n_before..n-1, whose w1 and w1' are free of their own force, with a first guess of it: as it
 * was. */
static void take_in(FastWork *k, const Level *l, Active *a, int n_before)
{
    for (int i = n_before; i < a->n; i++) {
        const int j = a->floor[i];
        const double w0 = scalars(k->w)[j], v0 = scalars(k->wd)[j], gap = scalars(k->gap)[j];
        const double w1 = scalars(k->w1)[j], v1 = scalars(k->wd1)[j], moved = fabs(v0) + fabs(v1);
        a->scale[i] = 1 / p2_make(fabs(fabs(w0) - gap) + fabs(fabs(w1) - gap) + l->h * moved, moved);
        apply_force(k, l, j, scalars(k->f0)[j], 0);
    }
    for (int i = 0; i < a->n; i++) {
        const int j = a->floor[i];
        const double F = -scalars(k->f1)[j];
        a->y[i] = p2_make(scalars(k->w1)[j], scalars(k->wd1)[j]);
        a->x[i] = p2_make(F, (-scalars(k->fb)[j] - 3 * scalars(k->f0)[j] + 3 * F) / 6);
        for (int c = 0; c < a->n; c++)
            a->g[i * a->n + c] = l->reply[j * k->n + a->floor[c]];
    }
}

/* Newton's matrix 1 + (slopes of the law) g, factorised. */
INLINE void take_slopes(Active *a, const int n)
{
#pragma GCC unroll 8
    for (int i = 0; i < n; i++) {
#pragma GCC unroll 8
        for (int j = 0; j < n; j++)
            a->LU[i * n + j] = m22_times(a->press[i].slope, a->g[i * n + j]);
        a->LU[i * n + i] += (m22){1, 0, 0, 1};
    }
    factorise(n, a->LU);
}

/* One step of Newton's method on n floors, with the matrix of this state or (not fresh) of an earlier one. Returns the
 * largest change of w1 and w1' relative to what the step moves; it is not a number where there is none. */
INLINE double improve(FastWork *k, double h, Active *a, int fresh, const int n)
{
    p2 x[FLOORS_PAD_MAX];
    v4 change = {0};
    for (int i = 0; i < n; i++) {
        press(k, h, a->floor[i], a->y[i][0], a->y[i][1], &a->press[i]);
        x[i] = a->x[i] - p2_make(a->press[i].end, a->press[i].mean);
    }
    if (fresh)
        take_slopes(a, n);
    substitute(n, a->LU, x);
#pragma GCC unroll 8
    for (int i = 0; i < n; i++) {
        v4 sum = {0};
#pragma GCC unroll 8
        for (int j = 0; j < n; j++)
            sum += a->g[i * n + j] * x[j];
        const p2 dy = p2_sum(sum), c = v4_abs(dy * a->scale[i]);
        a->y[i] += dy;
        a->x[i] -= x[i];
        a->press[i].lost += p2_dot(a->press[i].lost_to, dy);
        change = v4_larger(change, c);
    }
    return v4_larger(change, __builtin_shufflevector(change, change, 1, 0, 3, 2))[0];
}

/* The common numbers of floors get code of their own, unrolled. */
static double improve_forces(FastWork *k, double h, Active *a, int fresh)
{
    switch (a->n) {
    case 1:
        return improve(k, h, a, fresh, 1);
    case 2:
        return improve(k, h, a, fresh, 2);
    case 3:
        return improve(k, h, a, fresh, 3);
    case 4:
        return improve(k, h, a, fresh, 4);
    default:
        return improve(k, h, a, fresh, a->n);
    }
}

static int closes(const Active *active)
{
    for (int i = 0; i < active->n; i++)
        if (active->press[i].closings)
            return 1;
    return 0;
}

/* The forces to the floors. Where the last change of w1 closed a contact its v0 is looked for again. */
static void hand_out(FastWork *k, const Level *l, Active *a)
{
    for (int i = 0; i < a->n; i++) {
        const int j = a->floor[i];
        if (a->press[i].v0 == 0 && fabs(a->y[i][0]) > scalars(k->gap)[j])
            press(k, l->h, j, a->y[i][0], a->y[i][1], &a->press[i]);
        apply_force(k, l, j, -a->x[i][0], -(6 * a->x[i][1] + 3 * scalars(k->f0)[j] - 3 * a->x[i][0]));
    }
}

/* Of a step in which a gap closes, so many times as much is left. */
static const double CLOSING_TOLERANCE = 0.05;

/* The forces of all floors at once by Newton's method; 0 when they cannot be had at this step length. */
static int solve_contacts(FastWork *k, const Level *l, double tolerance, Active *active)
{
    enum { MOST = 40 };
    active->listed = 0;
    active->n = 0;
    list_floors(active, k->touching);
    int before = 0, fresh = 1;
    double last = 1;
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
        /* of Newton's method, of one with an old matrix; v0 does not follow the last change as force and loss do */
        const double left = change * (fresh ? change : change / last);
        const double allowed = closes(active) ? CLOSING_TOLERANCE * tolerance : tolerance;
        fresh = change > 0.1 * last; /* an old matrix serves while it gains a digit a step */
        last = change;
        if (left > allowed)
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

#endif
