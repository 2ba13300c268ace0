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
    double end, mean, end_w, end_v, mean_w, mean_v, v0, lost, clamped, closed_at, closed_with;
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
static __attribute__((noinline)) void press(FastWork *k, double h, int j, double w1, double w1d, Press *out)
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
        if (t.closings) {
            out->closed_at = t.closed_at;
            out->closed_with = t.closed_with;
        }
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
    Reply g[FLOORS_PAD_MAX * FLOORS_PAD_MAX];           /* (n, n) */
    vec J[4 * FLOORS_PAD_MAX * FLOORS_PAD_MAX / LANES]; /* (2n, row_width) Newton's matrix, then its U */
    double L[4 * FLOORS_PAD_MAX * FLOORS_PAD_MAX];      /* (2n, 2n) */
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

/* Rows of Newton's matrix for n floors are so far apart. */
static inline int row_width(int n)
{
    return (2 * n + LANES - 1) / LANES * LANES;
}

/* A = L U of (n, n), rows in their order: the matrix tends to the unit matrix as the step gets shorter, and where a
 * pivot vanishes Newton does not converge and the step gets shorter. U takes the place of A, of which rows are `width`
 * apart, its pivots inverted; L (n, n), without its ones, has the columns as rows. */
INLINE void factorise(const int n, const int width, double *A, double *L)
{
#pragma GCC unroll 8
    for (int c = 0; c < n; c++) {
        const double *pivot_row = A + c * width;
        const double inverse = 1 / pivot_row[c];
#pragma GCC unroll 8
        for (int r = c + 1; r < n; r++) {
            double *row = A + r * width;
            const double f = L[c * n + r] = row[c] * inverse;
            for (int j = c / LANES * LANES; j < width; j += LANES)
                *(vec *)(row + j) -= f * *(const vec *)(pivot_row + j);
        }
        A[c * width + c] = inverse;
    }
}

INLINE void substitute(const int n, const int width, const double *U, const double *L, double x[])
{
#pragma GCC unroll 8
    for (int c = 0; c < n; c++)
#pragma GCC unroll 8
        for (int r = c + 1; r < n; r++)
            x[r] -= L[c * n + r] * x[c];
#pragma GCC unroll 8
    for (int r = n - 1; r >= 0; r--) {
#pragma GCC unroll 8
        for (int c = n - 1; c > r; c--)
            x[r] -= U[r * width + c] * x[c];
        x[r] *= U[r * width + r];
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
            a->g[i * a->n + c] = (Reply){r[RAMP_W * size] - 3 * w_b, 6 * w_b, r[RAMP_V * size] - 3 * v_b, 6 * v_b};
        }
    }
}

/* Newton's matrix I + (slopes of the law) (replies of w1, w1'), factorised. */
INLINE void take_slopes(Active *a, const int n)
{
    const int width = row_width(n);
    for (int i = 0; i < n; i++) {
        const Press *t = &a->press[i];
        double *row = (double *)a->J + 2 * i * width;
        for (int j = 0; j < n; j++, row += 2) {
            const Reply *g = &a->g[i * n + j];
            row[0] = t->end_w * g->w_end + t->end_v * g->v_end + (i == j);
            row[1] = t->end_w * g->w_mean + t->end_v * g->v_mean;
            row[width] = t->mean_w * g->w_end + t->mean_v * g->v_end;
            row[width + 1] = t->mean_w * g->w_mean + t->mean_v * g->v_mean + (i == j);
        }
    }
    factorise(2 * n, width, (double *)a->J, a->L);
}

/* One step of Newton's method on n floors, with the matrix of this state or (not fresh) of an earlier one. Returns the
 * largest change of w1 and w1' relative to what the step moves; it is not a number where there is none. */
INLINE double improve(FastWork *k, double h, Active *a, int fresh, const int n)
{
    double x[2 * FLOORS_PAD_MAX], change = 0;
    for (int i = 0; i < n; i++) {
        press(k, h, a->floor[i], a->w1[i], a->wd1[i], &a->press[i]);
        x[2 * i] = a->F[i] - a->press[i].end;
        x[2 * i + 1] = a->M[i] - a->press[i].mean;
    }
    if (fresh)
        take_slopes(a, n);
    substitute(2 * n, row_width(n), (const double *)a->J, a->L, x);
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

#endif
