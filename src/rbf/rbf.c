#include "rbf/rbf.h"

#include <cblas.h>
#include <lapacke.h>
#include <math.h>
#include <omp.h>
#include <stdint.h>

#include "base/carve.h"

/* The inner loops once for any machine and once for those with wide vectors, chosen when the program starts. */
#if defined __x86_64__ && !defined __SANITIZE_THREAD__
#define WIDE __attribute__((target_clones("arch=x86-64-v3", "default")))
#else
#define WIDE
#endif

enum { TUNE_MAX = 250, TUNE_STEPS_FIRST = 16, TUNE_STEPS = 8, CHUNK = 64 };

static const double NUGGET_MIN = 1e-8, NUGGET_MAX = 1.0;
static const double THETA_MIN = 1e-4, THETA_MAX = 50.0;
/* Weak prior on log theta (mean log 1/n_dim): keeps the scale of a variable that the data say nothing about. */
static const double PRIOR_SPREAD = 2.0;

/* What the model keeps of one output. */
typedef struct {
    RbfForm form;
    size_t n_tail;      /* columns of the tail really used: fewer when there are too few centres */
    double mean, scale; /* of F: the surface is built on (f - mean) / scale */
    double explained;
    double *theta;         /* (n_dim) */
    double *tail;          /* (1 + 2 n_dim) coefficients b */
    double *weight;        /* (n_max) w */
    double *leave_one_out; /* (n_max) [unit of f] */
} Output;

/* What one thread needs to fit one output; matrices column-major as LAPACK likes them, lower triangles. */
typedef struct {
    double *C;                                                /* (n_dim, n_max) centres of the tuning choice */
    double *A;                                                /* (n, n) kernel matrix, its factor, its inverse */
    double *P;                                                /* (n, n_tail + 1) tail basis and data */
    double *M;                                                /* (n_tail, n_tail) normal matrix of the tail, factored */
    double *b;                                                /* (n_tail) */
    double *y, *w;                                            /* (n) data, weights */
    double *q;                                                /* (n) diagonal of the projected inverse */
    double *log_p, *best_p, *gradient, *last_gradient, *step; /* (n_dim + 1) log theta, log nugget */
    double *theta, *best_theta;                               /* (n_dim) */
    RbfForm best_form;
    double least_error;
} Worker;

struct Rbf {
    size_t n, n_max, n_dim, n_out, n_workers, n_tail_max;
    size_t n_tuned; /* calls of rbf_tune */
    double *C;      /* (n_dim, n_max) centres */
    double *F;      /* (n_out, n_max) */
    Output *output;
    Worker *worker;
    Status *status;
    void *store;
};

static void layout(Rbf *m, Carve *c)
{
    const size_t n = m->n_max, d = m->n_dim, t = m->n_tail_max;
    m->C = carve(c, d * n, sizeof(double));
    m->F = carve(c, m->n_out * n, sizeof(double));
    m->status = carve(c, m->n_out, sizeof(Status));
    m->output = carve(c, m->n_out, sizeof(Output));
    m->worker = carve(c, m->n_workers, sizeof(Worker));
    for (size_t k = 0; k < m->n_out; k++) {
        Output counted, *o = c->base ? &m->output[k] : &counted;
        o->theta = carve(c, d, sizeof(double));
        o->tail = carve(c, t, sizeof(double));
        o->weight = carve(c, n, sizeof(double));
        o->leave_one_out = carve(c, n, sizeof(double));
    }
    for (size_t k = 0; k < m->n_workers; k++) {
        Worker counted, *w = c->base ? &m->worker[k] : &counted;
        w->C = carve(c, d * n, sizeof(double));
        w->A = carve(c, n * n, sizeof(double));
        w->P = carve(c, n * (t + 1), sizeof(double));
        w->M = carve(c, t * t, sizeof(double));
        w->b = carve(c, t, sizeof(double));
        w->y = carve(c, n, sizeof(double));
        w->w = carve(c, n, sizeof(double));
        w->q = carve(c, n, sizeof(double));
        w->log_p = carve(c, d + 1, sizeof(double));
        w->best_p = carve(c, d + 1, sizeof(double));
        w->gradient = carve(c, d + 1, sizeof(double));
        w->last_gradient = carve(c, d + 1, sizeof(double));
        w->step = carve(c, d + 1, sizeof(double));
        w->theta = carve(c, d, sizeof(double));
        w->best_theta = carve(c, d, sizeof(double));
    }
}

Status rbf_create(Rbf **out, size_t n_max, size_t n_dim, size_t n_out, Err *err)
{
    const int threads = omp_get_max_threads();
    Rbf *m = calloc(1, sizeof *m);
    *out = m;
    if (!m)
        return fail(err, STATUS_NO_MEMORY, "no memory for a response surface");
    m->n_max = n_max;
    m->n_dim = n_dim;
    m->n_out = n_out;
    m->n_tail_max = 1 + 2 * n_dim;
    m->n_workers = n_out < (size_t)threads ? n_out : (size_t)threads;
    Carve c = {0};
    layout(m, &c);
    m->store = carve_store(&c);
    if (!m->store) {
        rbf_free(m);
        *out = NULL;
        return fail(err, STATUS_NO_MEMORY, "no memory for a response surface on %zu designs (%.1f GB)", n_max,
                    (double)c.used / 1e9);
    }
    layout(m, &(Carve){.base = m->store});
    for (size_t k = 0; k < n_out; k++) {
        m->output[k].form = (RbfForm){RBF_MATERN, RBF_LINEAR, NUGGET_MIN};
        for (size_t d = 0; d < n_dim; d++)
            m->output[k].theta[d] = 1.0 / (double)n_dim;
    }
    return STATUS_OK;
}

void rbf_free(Rbf *m)
{
    if (m)
        free(m->store);
    free(m);
}

/* exp(x) for x <= 0 within 2e-16 relative, without a branch or a call: x = k log 2 + r, |r| <= log(2) / 2, Taylor
 * series of r; k sits in the low bits of x / log 2 + 1.5 2^52. Below -700 as at -700. */
static inline double exp_down(double x)
{
    static const double SHIFT = 0x1.8p52, LOG2E = 0x1.71547652b82fep0, LN2_HIGH = 0x1.62e42fefa38p-1,
                        LN2_LOW = 0x1.ef35793c7673p-45;
    x = x < -700.0 ? -700.0 : x;
    const double shifted = x * LOG2E + SHIFT, k = shifted - SHIFT, r = (x - k * LN2_HIGH) - k * LN2_LOW;
    double sum = 1.0 / 6227020800.0;
    sum = sum * r + 1.0 / 479001600.0;
    sum = sum * r + 1.0 / 39916800.0;
    sum = sum * r + 1.0 / 3628800.0;
    sum = sum * r + 1.0 / 362880.0;
    sum = sum * r + 1.0 / 40320.0;
    sum = sum * r + 1.0 / 5040.0;
    sum = sum * r + 1.0 / 720.0;
    sum = sum * r + 1.0 / 120.0;
    sum = sum * r + 1.0 / 24.0;
    sum = sum * r + 1.0 / 6.0;
    sum = sum * r + 0.5;
    sum = sum * r + 1.0;
    sum = sum * r + 1.0;
    uint64_t bits;
    double power;
    memcpy(&bits, &shifted, sizeof bits);
    bits = (bits + 1023) << 52;
    memcpy(&power, &bits, sizeof power);
    return sum * power;
}

/* phi[i] of r2[i]; may be the same array. */
WIDE static void kernel_values(RbfKernel kernel, size_t n, const double r2[], double phi[])
{
    if (kernel == RBF_GAUSS) {
#pragma omp simd
        for (size_t i = 0; i < n; i++)
            phi[i] = exp_down(-r2[i]);
        return;
    }
#pragma omp simd
    for (size_t i = 0; i < n; i++) {
        const double a = sqrt(5.0 * r2[i]);
        phi[i] = (1.0 + a + a * a / 3.0) * exp_down(-a);
    }
}

/* v[i] = (w[i] w_j / s2 - v[i]) d phi / d (r^2) at r2[i]: the terms of the likelihood's gradient of one column. */
WIDE static void weigh_slopes(RbfKernel kernel, size_t n, const double r2[], const double w[], double w_j, double s2,
                              double v[])
{
#pragma omp simd
    for (size_t i = 0; i < n; i++) {
        const double a = sqrt(5.0 * r2[i]);
        const double slope = kernel == RBF_GAUSS ? -exp_down(-r2[i]) : -5.0 / 6.0 * (1.0 + a) * exp_down(-a);
        v[i] = (w[i] * w_j / s2 - v[i]) * slope;
    }
}

/* sum_i v[i] (c[i] - at)^2 */
WIDE static double moment(size_t n, const double v[], const double c[], double at)
{
    double sum = 0.0;
#pragma omp simd reduction(+ : sum)
    for (size_t i = 0; i < n; i++)
        sum += v[i] * (c[i] - at) * (c[i] - at);
    return sum;
}

/* sum_i q[i] (at - c[i]) */
WIDE static double offset_moment(size_t n, const double q[], const double c[], double at)
{
    double sum = 0.0;
#pragma omp simd reduction(+ : sum)
    for (size_t i = 0; i < n; i++)
        sum += q[i] * (at - c[i]);
    return sum;
}

/* r2[i] = squared scaled distance of x to centres first..first+count-1 of C (n_dim, stride). */
WIDE static void distances(size_t n_dim, size_t stride, const double C[], const double theta[], const double x[],
                           size_t x_stride, size_t first, size_t count, double r2[])
{
    for (size_t i = 0; i < count; i++)
        r2[i] = 0.0;
    size_t d = 0;
    for (; d + 4 <= n_dim; d += 4) { /* four variables at a time: r2 is loaded and stored a quarter as often */
        const double *c0 = C + d * stride + first, *c1 = c0 + stride, *c2 = c1 + stride, *c3 = c2 + stride;
        const double x0 = x[d * x_stride], x1 = x[(d + 1) * x_stride], x2 = x[(d + 2) * x_stride],
                     x3 = x[(d + 3) * x_stride];
        const double *t = theta + d;
#pragma omp simd
        for (size_t i = 0; i < count; i++)
            r2[i] += t[0] * (c0[i] - x0) * (c0[i] - x0) + t[1] * (c1[i] - x1) * (c1[i] - x1) +
                     t[2] * (c2[i] - x2) * (c2[i] - x2) + t[3] * (c3[i] - x3) * (c3[i] - x3);
    }
    for (; d < n_dim; d++) {
        const double *c = C + d * stride + first, xd = x[d * x_stride], t = theta[d];
#pragma omp simd
        for (size_t i = 0; i < count; i++)
            r2[i] += t * (c[i] - xd) * (c[i] - xd);
    }
}

/* Lower triangle of the kernel matrix, nugget on the diagonal. */
static void kernel_matrix(const Rbf *m, size_t n, const double C[], const double theta[], RbfKernel kernel,
                          double nugget, double A[])
{
    for (size_t j = 0; j < n; j++) {
        double *column = A + j * n;
        distances(m->n_dim, m->n_max, C, theta, C + j, m->n_max, j, n - j, column + j);
        kernel_values(kernel, n - j, column + j, column + j);
        column[j] += nugget;
    }
}

/* The tail's functions are centred in the cube so that they are nearly orthogonal. */
static double tail_value(size_t n_dim, size_t column, const double x[], size_t x_stride)
{
    if (column == 0)
        return 1.0;
    if (column <= n_dim)
        return 2.0 * x[(column - 1) * x_stride] - 1.0;
    const double z = 2.0 * x[(column - 1 - n_dim) * x_stride] - 1.0;
    return z * z - 1.0 / 3.0;
}

/* Twice as many centres as coefficients at least, else a simpler tail. */
static size_t tail_columns(RbfTail tail, size_t n, size_t n_dim)
{
    if (tail == RBF_QUADRATIC && n >= 2 * (1 + 2 * n_dim))
        return 1 + 2 * n_dim;
    return tail != RBF_CONSTANT && n > 1 + n_dim ? 1 + n_dim : 1;
}

/* Factors the kernel matrix, raising the nugget by tens where centres are too near each other to tell apart. */
static int factor_kernel(const Rbf *m, Worker *k, size_t n, const double C[], const double theta[], RbfForm *form)
{
    for (;; form->nugget *= 10.0) {
        kernel_matrix(m, n, C, theta, form->kernel, form->nugget, k->A);
        if (LAPACKE_dpotrf_work(LAPACK_COL_MAJOR, 'L', (int)n, k->A, (int)n) == 0)
            return 1;
        if (form->nugget >= NUGGET_MAX)
            return 0;
    }
}

/* Generalised least squares for the tail, then the weights: with A = L L', V = L^-1 P, z = L^-1 y
 *     V'V b = V'z,      L' w = z - V b.
 * Leaves V in P, the factor of V'V in M. Returns the tail columns used: a variable that no centre moves makes V'V
 * singular and the tail constant. */
static size_t solve_weights(const Rbf *m, Worker *k, size_t n, const double C[], size_t n_tail)
{
    for (;; n_tail = 1) {
        const int ni = (int)n, ti = (int)n_tail;
        for (size_t c = 0; c < n_tail; c++)
            for (size_t i = 0; i < n; i++)
                k->P[c * n + i] = tail_value(m->n_dim, c, C + i, m->n_max);
        double *z = k->P + n_tail * n;
        memcpy(z, k->y, n * sizeof *z);
        cblas_dtrsm(CblasColMajor, CblasLeft, CblasLower, CblasNoTrans, CblasNonUnit, ni, ti + 1, 1.0, k->A, ni, k->P,
                    ni);
        cblas_dsyrk(CblasColMajor, CblasLower, CblasTrans, ti, ni, 1.0, k->P, ni, 0.0, k->M, ti);
        if (LAPACKE_dpotrf_work(LAPACK_COL_MAJOR, 'L', ti, k->M, ti) != 0 && n_tail > 1)
            continue;
        cblas_dgemv(CblasColMajor, CblasTrans, ni, ti, 1.0, k->P, ni, z, 1, 0.0, k->b, 1);
        LAPACKE_dpotrs_work(LAPACK_COL_MAJOR, 'L', ti, 1, k->M, ti, k->b, ti);
        memcpy(k->w, z, n * sizeof *z);
        cblas_dgemv(CblasColMajor, CblasNoTrans, ni, ti, -1.0, k->P, ni, k->b, 1, 1.0, k->w, 1);
        cblas_dtrsv(CblasColMajor, CblasLower, CblasTrans, CblasNonUnit, ni, k->A, ni, k->w, 1);
        return n_tail;
    }
}

/* L := inv(L) for lower triangular L with leading dimension ld, by halves: nearly all of it is matrix products.
 *     inv([A 0; B C]) = [inv(A) 0; -inv(C) B inv(A)  inv(C)] */
static void invert_factor(int n, double L[], int ld)
{
    if (n <= 24) {
        LAPACKE_dtrtri_work(LAPACK_COL_MAJOR, 'L', 'N', n, L, ld);
        return;
    }
    const int a = n / 2, c = n - a;
    double *B = L + a, *C = L + a + (size_t)a * (size_t)ld;
    cblas_dtrsm(CblasColMajor, CblasRight, CblasLower, CblasNoTrans, CblasNonUnit, c, a, -1.0, L, ld, B, ld);
    cblas_dtrsm(CblasColMajor, CblasLeft, CblasLower, CblasNoTrans, CblasNonUnit, c, a, 1.0, C, ld, B, ld);
    invert_factor(a, L, ld);
    invert_factor(c, C, ld);
}

/* Leave-one-out error of the whole surface, tail refitted, without n refits:
 *     e_i = w_i / Q_ii,     Q = A^-1 - A^-1 P (P'A^-1 P)^-1 P'A^-1
 * Q y = w, so this is Rippa's formula with the inverse of the bordered matrix. Spoils A and P; e goes to q. */
static void leave_one_out(Worker *k, size_t n, size_t n_tail)
{
    const int ni = (int)n, ti = (int)n_tail;
    cblas_dtrsm(CblasColMajor, CblasLeft, CblasLower, CblasTrans, CblasNonUnit, ni, ti, 1.0, k->A, ni, k->P, ni);
    cblas_dtrsm(CblasColMajor, CblasRight, CblasLower, CblasTrans, CblasNonUnit, ni, ti, 1.0, k->M, ti, k->P, ni);
    invert_factor(ni, k->A, ni);
    for (size_t i = 0; i < n; i++) {
        const double *column = k->A + i * n + i;
        double q = cblas_ddot(ni - (int)i, column, 1, column, 1);
        for (size_t c = 0; c < n_tail; c++)
            q -= k->P[c * n + i] * k->P[c * n + i];
        k->q[i] = k->w[i] / fmax(q, 1e-300);
    }
}

static void standardise(const Rbf *m, Output *o, const double f[])
{
    double mean = 0.0, square = 0.0;
    for (size_t i = 0; i < m->n; i++)
        mean += f[i] / (double)m->n;
    for (size_t i = 0; i < m->n; i++)
        square += (f[i] - mean) * (f[i] - mean) / (double)m->n;
    o->mean = mean;
    o->scale = square > 0.0 ? sqrt(square) : 1.0;
}

static int fit_output(const Rbf *m, Worker *k, Output *o, const double f[])
{
    const size_t n = m->n;
    standardise(m, o, f);
    for (size_t i = 0; i < n; i++)
        k->y[i] = (f[i] - o->mean) / o->scale;
    RbfForm form = o->form;
    if (!isfinite(o->mean) || !isfinite(o->scale) || !factor_kernel(m, k, n, m->C, o->theta, &form))
        return 0;
    o->n_tail = solve_weights(m, k, n, m->C, tail_columns(form.tail, n, m->n_dim));
    memcpy(o->tail, k->b, o->n_tail * sizeof *o->tail);
    memcpy(o->weight, k->w, n * sizeof *o->weight);
    leave_one_out(k, n, o->n_tail);
    double square = 0.0;
    for (size_t i = 0; i < n; i++) {
        o->leave_one_out[i] = k->q[i] * o->scale;
        square += k->q[i] * k->q[i] / (double)n;
    }
    o->explained = 1.0 - square;
    return isfinite(square);
}

static Status fit_all(Rbf *m, Err *err)
{
#pragma omp parallel for schedule(dynamic, 1) num_threads((int)m->n_workers)
    for (size_t k = 0; k < m->n_out; k++)
        m->status[k] = fit_output(m, &m->worker[omp_get_thread_num()], &m->output[k], m->F + k * m->n_max)
                           ? STATUS_OK
                           : STATUS_BAD_DATA;
    for (size_t k = 0; k < m->n_out; k++)
        if (m->status[k] != STATUS_OK)
            return fail(err, STATUS_BAD_DATA,
                        "response surface: output %zu of %zu designs cannot be fitted (a value that is not finite?)",
                        k + 1, m->n);
    return STATUS_OK;
}

Status rbf_fit(Rbf *m, size_t n, const double X[], const double F[], Err *err)
{
    if (n < 2 || n > m->n_max)
        return fail(err, STATUS_INTERNAL, "response surface: %zu centres, wanted 2 to %zu", n, m->n_max);
    m->n = n;
    for (size_t i = 0; i < n; i++) {
        for (size_t d = 0; d < m->n_dim; d++)
            m->C[d * m->n_max + i] = X[i * m->n_dim + d];
        for (size_t k = 0; k < m->n_out; k++)
            m->F[k * m->n_max + i] = F[i * m->n_out + k];
    }
    return fit_all(m, err);
}

/* -- tuning: scales and nugget by maximum likelihood, kernel and tail by leave-one-out error ------------------------
 */

/* The part of minus the log likelihood that depends on p = (log theta, log nugget), variance and tail profiled out:
 *     l = n/2 log(s2) + 1/2 log|A|,    s2 = y'w / n
 * plus the prior. Its gradient needs the inverse only once (Rasmussen and Williams, eq. 5.9):
 *     dl/dp = -1/2 sum_ij (w_i w_j / s2 - inv(A)_ij) dA_ij/dp.
 * INFINITY where the matrix does not factor. */
static double likelihood(const Rbf *m, Worker *k, size_t n, RbfForm form, double theta[], const double p[],
                         double gradient[])
{
    const size_t n_dim = m->n_dim, stride = m->n_max;
    const double prior_mean = -log((double)n_dim), nugget = exp(p[n_dim]);
    for (size_t d = 0; d < n_dim; d++)
        theta[d] = exp(p[d]);
    kernel_matrix(m, n, k->C, theta, form.kernel, nugget, k->A);
    if (LAPACKE_dpotrf_work(LAPACK_COL_MAJOR, 'L', (int)n, k->A, (int)n) != 0)
        return INFINITY;
    solve_weights(m, k, n, k->C, tail_columns(form.tail, n, n_dim));
    const double s2 = fmax(cblas_ddot((int)n, k->y, 1, k->w, 1) / (double)n, 1e-300);
    double l = 0.5 * (double)n * log(s2);
    for (size_t i = 0; i < n; i++)
        l += log(k->A[i * n + i]);
    invert_factor((int)n, k->A, (int)n);
    LAPACKE_dlauum_work(LAPACK_COL_MAJOR, 'L', (int)n, k->A, (int)n);

    for (size_t d = 0; d < n_dim; d++) {
        const double off = (p[d] - prior_mean) / PRIOR_SPREAD;
        l += 0.5 * off * off;
        gradient[d] = 0.0;
    }
    double trace = 0.0;
    for (size_t j = 0; j < n; j++) {
        double *v = k->A + j * n, *r2 = k->q;
        trace += k->w[j] * k->w[j] / s2 - v[j];
        distances(n_dim, stride, k->C, theta, k->C + j, stride, j + 1, n - j - 1, r2 + j + 1);
        const size_t left = n - j - 1;
        weigh_slopes(form.kernel, left, r2 + j + 1, k->w + j + 1, k->w[j], s2, v + j + 1);
        for (size_t d = 0; d < n_dim; d++) {
            const double *c = k->C + d * stride + j;
            gradient[d] -= moment(left, v + j + 1, c + 1, c[0]);
        }
    }
    for (size_t d = 0; d < n_dim; d++)
        gradient[d] = theta[d] * gradient[d] + (p[d] - prior_mean) / (PRIOR_SPREAD * PRIOR_SPREAD);
    gradient[n_dim] = -0.5 * nugget * trace;
    return l;
}

/* Resilient back-propagation: only the signs of the gradient count, which suits likelihoods with their plateaus and
 * cliffs. Blum and Riedmiller, Optimization of Gaussian process hyperparameters using Rprop, ESANN 2013. */
static void climb(const Rbf *m, Worker *k, size_t n, RbfForm *form, double theta[], int steps)
{
    const size_t n_p = m->n_dim + 1;
    double *p = k->log_p, *g = k->gradient, *last = k->last_gradient, best = INFINITY;
    for (size_t d = 0; d < n_p; d++) {
        p[d] = log(d < m->n_dim ? theta[d] : form->nugget);
        k->best_p[d] = p[d];
        k->step[d] = 0.5;
        last[d] = 0.0;
    }
    for (int step = 0; step < steps; step++) {
        const double l = likelihood(m, k, n, *form, theta, p, g);
        if (l < best) {
            best = l;
            memcpy(k->best_p, p, n_p * sizeof *p);
        } else if (!(l < INFINITY)) {
            p[m->n_dim] = fmin(p[m->n_dim] + log(10.0), log(NUGGET_MAX));
            continue;
        }
        for (size_t d = 0; d < n_p; d++) {
            const double lowest = log(d < m->n_dim ? THETA_MIN : NUGGET_MIN);
            const double highest = log(d < m->n_dim ? THETA_MAX : NUGGET_MAX);
            const double agreed = g[d] * last[d];
            k->step[d] = agreed > 0.0   ? fmin(1.2 * k->step[d], 2.0)
                         : agreed < 0.0 ? fmax(0.5 * k->step[d], 1e-3)
                                        : k->step[d];
            last[d] = agreed < 0.0 ? 0.0 : g[d];
            if (last[d] != 0.0)
                p[d] = fmin(fmax(p[d] - copysign(k->step[d], g[d]), lowest), highest);
        }
    }
    for (size_t d = 0; d < m->n_dim; d++)
        theta[d] = exp(k->best_p[d]);
    form->nugget = exp(k->best_p[m->n_dim]);
}

/* Mean square leave-one-out error of a form and scales on the tuning choice. */
static double trial_error(const Rbf *m, Worker *k, size_t n, RbfForm *form, const double theta[])
{
    if (!factor_kernel(m, k, n, k->C, theta, form))
        return INFINITY;
    leave_one_out(k, n, solve_weights(m, k, n, k->C, tail_columns(form->tail, n, m->n_dim)));
    return cblas_ddot((int)n, k->q, 1, k->q, 1) / (double)n;
}

/* At most TUNE_MAX centres, evenly spread over their order: a likelihood costs n^3. */
static size_t choose_tuning_set(const Rbf *m, Worker *k, const Output *o, const double f[])
{
    const size_t n = m->n < TUNE_MAX ? m->n : TUNE_MAX;
    for (size_t i = 0; i < n; i++) {
        const size_t from = i * m->n / n;
        for (size_t d = 0; d < m->n_dim; d++)
            k->C[d * m->n_max + i] = m->C[d * m->n_max + from];
        k->y[i] = (f[from] - o->mean) / o->scale;
    }
    return n;
}

/* Climbs with one form from the output's scales; the better of this and the best so far stays in the worker. */
static void try_form(const Rbf *m, Worker *k, size_t n, const Output *o, RbfForm form, int steps)
{
    memcpy(k->theta, o->theta, m->n_dim * sizeof *k->theta);
    climb(m, k, n, &form, k->theta, steps);
    const double e = trial_error(m, k, n, &form, k->theta);
    if (e < k->least_error) {
        k->least_error = e;
        k->best_form = form;
        memcpy(k->best_theta, k->theta, m->n_dim * sizeof *k->theta);
    }
}

/* The first time every form is tried; later the present one and, in turn, one challenger. */
static void tune_output(const Rbf *m, Worker *k, Output *o, const double f[])
{
    const size_t n = choose_tuning_set(m, k, o, f), n_forms = RBF_N_KERNELS * RBF_N_TAILS;
    const size_t challenger = m->n_tuned % n_forms;
    k->least_error = INFINITY;
    for (size_t i = 0; i < n_forms; i++) {
        const RbfForm form = {(RbfKernel)(i / RBF_N_TAILS), (RbfTail)(i % RBF_N_TAILS), fmax(o->form.nugget, 1e-4)};
        const int present = form.kernel == o->form.kernel && form.tail == o->form.tail;
        if (m->n_tuned == 0)
            try_form(m, k, n, o, form, TUNE_STEPS_FIRST);
        else if (present || i == challenger)
            try_form(m, k, n, o, form, TUNE_STEPS);
    }
    if (k->least_error < INFINITY) {
        o->form = k->best_form;
        memcpy(o->theta, k->best_theta, m->n_dim * sizeof *o->theta);
    }
}

Status rbf_tune(Rbf *m, Err *err)
{
    if (m->n < 2)
        return fail(err, STATUS_INTERNAL, "response surface: tuned before it was fitted");
#pragma omp parallel for schedule(dynamic, 1) num_threads((int)m->n_workers)
    for (size_t k = 0; k < m->n_out; k++)
        tune_output(m, &m->worker[omp_get_thread_num()], &m->output[k], m->F + k * m->n_max);
    m->n_tuned++;
    return fit_all(m, err);
}

/* -- prediction -----------------------------------------------------------------------------------------------------
 */

static void eval_output(const Rbf *m, const Output *o, const double x[], double *f, double *error)
{
    double r2[CHUNK], phi[CHUNK], value = 0.0, square = 0.0, weights = 0.0;
    for (size_t c = 0; c < o->n_tail; c++)
        value += o->tail[c] * tail_value(m->n_dim, c, x, 1);
    for (size_t first = 0; first < m->n; first += CHUNK) {
        const size_t count = m->n - first < CHUNK ? m->n - first : CHUNK;
        distances(m->n_dim, m->n_max, m->C, o->theta, x, 1, first, count, r2);
        kernel_values(o->form.kernel, count, r2, phi);
        for (size_t i = 0; i < count; i++)
            value += o->weight[first + i] * phi[i];
        for (size_t i = 0; error && i < count; i++) {
            const double near = 1.0 / (r2[i] * r2[i] + 1e-12), e = o->leave_one_out[first + i];
            square += near * e * e;
            weights += near;
        }
    }
    *f = o->mean + o->scale * value;
    if (error)
        *error = sqrt(square / weights);
}

void rbf_eval(const Rbf *m, const double x[], double f[], double error[])
{
    for (size_t k = 0; k < m->n_out; k++)
        eval_output(m, &m->output[k], x, &f[k], error ? &error[k] : NULL);
}

/* q[i] = w[i] d phi / d (r^2), and the sum of w phi. */
WIDE static double weighted_slopes(RbfKernel kernel, size_t n, const double r2[], const double w[], double q[])
{
    double value = 0.0;
#pragma omp simd reduction(+ : value)
    for (size_t i = 0; i < n; i++) {
        const double a = sqrt(5.0 * r2[i]), e = exp_down(kernel == RBF_GAUSS ? -r2[i] : -a);
        value += w[i] * (kernel == RBF_GAUSS ? e : (1.0 + a + a * a / 3.0) * e);
        q[i] = w[i] * (kernel == RBF_GAUSS ? -e : -5.0 / 6.0 * (1.0 + a) * e);
    }
    return value;
}

static double tail_slope(size_t n_dim, const Output *o, size_t d, double x)
{
    return (o->n_tail > 1 ? 2.0 * o->tail[1 + d] : 0.0) +
           (o->n_tail > 1 + n_dim ? 4.0 * (2.0 * x - 1.0) * o->tail[1 + n_dim + d] : 0.0);
}

static void slope_output(const Rbf *m, const Output *o, const double x[], double *f, double g[])
{
    double r2[CHUNK], q[CHUNK], value = 0.0;
    for (size_t c = 0; c < o->n_tail; c++)
        value += o->tail[c] * tail_value(m->n_dim, c, x, 1);
    for (size_t d = 0; d < m->n_dim; d++)
        g[d] = 0.0;
    for (size_t first = 0; first < m->n; first += CHUNK) {
        const size_t count = m->n - first < CHUNK ? m->n - first : CHUNK;
        distances(m->n_dim, m->n_max, m->C, o->theta, x, 1, first, count, r2);
        value += weighted_slopes(o->form.kernel, count, r2, o->weight + first, q);
        for (size_t d = 0; d < m->n_dim; d++)
            g[d] += offset_moment(count, q, m->C + d * m->n_max + first, x[d]);
    }
    *f = o->mean + o->scale * value;
    for (size_t d = 0; d < m->n_dim; d++)
        g[d] = o->scale * (2.0 * o->theta[d] * g[d] + tail_slope(m->n_dim, o, d, x[d]));
}

void rbf_slope(const Rbf *m, const double x[], double f[], double J[])
{
    for (size_t k = 0; k < m->n_out; k++)
        slope_output(m, &m->output[k], x, &f[k], J + k * m->n_dim);
}

const double *rbf_leave_one_out(const Rbf *m, size_t output)
{
    return m->output[output].leave_one_out;
}

double rbf_explained(const Rbf *m, size_t output)
{
    return m->output[output].explained;
}

void rbf_set_form(Rbf *m, size_t output, RbfForm form)
{
    m->output[output].form = form;
}

void rbf_set_scales(Rbf *m, size_t output, const double theta[])
{
    memcpy(m->output[output].theta, theta, m->n_dim * sizeof *theta);
}
