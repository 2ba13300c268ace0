#include "rbf/rbf.h"

#include <cblas.h>
#include <float.h>
#include <lapacke.h>
#include <omp.h>

#include "base/carve.h"
#include "base/linalg.h"
#include "rbf/constants.h"
#include "rbf/model.h"

static void layout(void *interpolant, Carve *c)
{
    Rbf *m = interpolant;
    const size_t n = m->n_max, d = m->n_dim, t = m->n_tail_max, spread = d * m->stride + KERNEL_LANES,
                 with_squares = spread + m->stride, tuned = MIN_OF(n, TUNE_CENTRES_MAX);
    CARVE(c, m->C, 3 * spread);
    CARVE(c, m->F, m->n_out * n);
    CARVE(c, m->noise, m->n_out * n);
    CARVE(c, m->output, m->n_out);
    CARVE(c, m->worker, m->n_workers);
    for (size_t k = 0; k < m->n_out; k++) {
        Output counted, *o = c->base ? &m->output[k] : &counted;
        CARVE(c, o->shape.theta, d);
        CARVE(c, o->step, d + 3);
        CARVE(c, o->S, with_squares);
        CARVE(c, o->tail, t);
        CARVE(c, o->weight, n);
        CARVE(c, o->leave_one_out, n);
    }
    for (size_t k = 0; k < m->n_workers; k++) {
        Worker counted, *w = c->base ? &m->worker[k] : &counted;
        CARVE(c, w->C, 3 * spread);
        CARVE(c, w->S, with_squares);
        CARVE(c, w->Z, with_squares);
        CARVE(c, w->by_a, n);
        CARVE(c, w->by_b, n);
        CARVE(c, w->A, n * n);
        CARVE(c, w->slope, tuned * tuned);
        CARVE(c, w->P, n * (t + 1));
        CARVE(c, w->M, t * t);
        CARVE(c, w->b, t);
        CARVE(c, w->y, n);
        CARVE(c, w->w, n);
        CARVE(c, w->noise, n);
        CARVE(c, w->q, n);
        CARVE(c, w->log_p, d + 3);
        CARVE(c, w->best_p, d + 3);
        CARVE(c, w->gradient, d + 3);
        CARVE(c, w->last_gradient, d + 3);
        CARVE(c, w->step, d + 3);
        CARVE(c, w->best_step, d + 3);
        CARVE(c, w->theta, d);
        CARVE(c, w->shape.theta, d);
        CARVE(c, w->best_shape.theta, d);
    }
}

Status rbf_create(Rbf **out, size_t n_max, size_t n_dim, size_t n_out, Err *err)
{
    const int threads = omp_get_max_threads();
    *out = NULL;
    if (threads > 1 && n_out > 1)
        TRY(linalg_room(MIN_OF(n_out, (size_t)threads), err));
    Rbf plain = {.n_max = n_max,
                 .n_dim = n_dim,
                 .n_out = n_out,
                 .n_tail_max = 1 + 2 * n_dim,
                 .stride = (n_max + KERNEL_LANES - 1) / KERNEL_LANES * KERNEL_LANES,
                 .n_workers = MIN_OF(n_out, (size_t)threads)};
    Rbf *m = *out = carve_object(layout, &plain, sizeof plain);
    if (!m)
        return fail_memory(err, n_max, "centres of an interpolant");
    for (size_t k = 0; k < n_out; k++) {
        m->output[k].form = (RbfForm){RBF_MATERN, RBF_LINEAR, NUGGET_MIN};
        for (size_t d = 0; d < n_dim; d++)
            m->output[k].shape.theta[d] = 1.0 / (double)n_dim;
        m->output[k].shape.warp[0] = m->output[k].shape.warp[1] = 1.0;
        for (size_t i = 0; i < n_dim + 3; i++)
            m->output[k].step[i] = TUNE_STEP;
    }
    return STATUS_OK;
}

void model_scale(const Rbf *m, size_t n, const double C[], const Shape *shape, double S[])
{
    const size_t plane = m->n_dim * m->stride;
    for (size_t d = 0; d < m->n_dim; d++) {
        const double *log_u = C + plane + d * m->stride;
        kernel_warp(n, log_u, log_u + plane, shape->theta[d], shape->warp, S + d * m->stride);
    }
    kernel_squares(n, m->n_dim, m->stride, S);
}

void model_copy_shape(const Rbf *m, Shape *to, const Shape *from)
{
    memcpy(to->theta, from->theta, m->n_dim * sizeof *to->theta);
    memcpy(to->warp, from->warp, sizeof to->warp);
}

void model_gather(const Rbf *m, const double S[], size_t first, size_t n, double x[])
{
    for (size_t d = 0; d < m->n_dim; d++)
        for (size_t p = 0; p < RBF_BLOCK; p++)
            x[d * RBF_BLOCK + p] = S[d * m->stride + (first + p < n ? first + p : n - 1)];
}

/* A block of columns at a time, from its first row on, chunk by chunk. */
void model_matrix(const Rbf *m, Worker *k, size_t n, const double C[], const double S[], RbfForm form, double slope[])
{
    double r2[RBF_BLOCK][KERNEL_CHUNK], x[RBF_BLOCK * RBF_DIM_MAX], u[RBF_BLOCK * RBF_DIM_MAX];
    for (size_t j = 0; j < n; j += RBF_BLOCK) {
        model_gather(m, S, j, n, x);
        model_gather(m, C, j, n, u);
        for (size_t i = j; i < n; i += KERNEL_CHUNK) {
            const size_t count = MIN_OF(n - i, KERNEL_CHUNK);
            kernel_distances(m->n_dim, m->stride, S, x, i, count, r2);
            for (size_t p = 0, at = j * n + i; p < RBF_BLOCK && j + p < n; p++, at += n) {
                if (slope)
                    kernel_values_and_slopes(form.kernel, count, r2[p], k->A + at, slope + at);
                else
                    kernel_values(form.kernel, count, r2[p], k->A + at);
                if (form.kernel >= RBF_ADDITIVE)
                    kernel_additive(form.kernel, m->n_dim, m->stride, C + i, u + p, count, k->A + at,
                                    slope ? slope + at : NULL);
            }
        }
        for (size_t p = j; p < j + RBF_BLOCK && p < n; p++)
            k->A[p * n + p] += form.nugget * k->noise[p];
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

size_t model_tail(RbfTail tail, size_t n, size_t n_dim)
{
    if (tail == RBF_QUADRATIC && n > 1 + 2 * n_dim)
        return 1 + 2 * n_dim;
    return tail != RBF_CONSTANT && n > 1 + n_dim ? 1 + n_dim : 1;
}

int model_factor(const Rbf *m, Worker *k, size_t n, const double C[], const double S[], RbfForm *form)
{
    for (;; form->nugget *= 10.0) {
        model_matrix(m, k, n, C, S, *form, NULL);
        if (LAPACKE_dpotrf_work(LAPACK_COL_MAJOR, 'L', (int)n, k->A, (int)n) == 0)
            return 1;
        if (form->nugget >= 1.0)
            return 0;
    }
}

size_t model_weights(const Rbf *m, Worker *k, size_t n, const double C[], size_t n_tail)
{
    for (;; n_tail = 1) {
        const int ni = (int)n, ti = (int)n_tail;
        for (size_t c = 0; c < n_tail; c++)
            for (size_t i = 0; i < n; i++)
                k->P[c * n + i] = tail_value(m->n_dim, c, C + i, m->stride);
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

/* By halves: nearly all of it is matrix products, which are twice as fast as solving.
 *     inv([A 0; B C]) = [inv(A) 0; -inv(C) B inv(A)  inv(C)] */
void model_invert(int n, double L[], int ld)
{
    enum { WHOLE_MAX = 16 }; /* as fast as by halves */
    if (n <= WHOLE_MAX) {
        LAPACKE_dtrtri_work(LAPACK_COL_MAJOR, 'L', 'N', n, L, ld);
        return;
    }
    const int a = (n / 2 + 7) / 8 * 8, c = n - a;
    double *B = L + a, *C = L + a + a * (size_t)ld;
    model_invert(a, L, ld);
    model_invert(c, C, ld);
    cblas_dtrmm(CblasColMajor, CblasRight, CblasLower, CblasNoTrans, CblasNonUnit, c, a, -1.0, L, ld, B, ld);
    cblas_dtrmm(CblasColMajor, CblasLeft, CblasLower, CblasNoTrans, CblasNonUnit, c, a, 1.0, C, ld, B, ld);
}

/* Leave-one-out error of the whole interpolant, tail refitted, without n refits:
 *     e_i = w_i / Q_ii,     Q = A^-1 - A^-1 P (P'A^-1 P)^-1 P'A^-1
 * Q y = w, so this is Rippa's formula with the inverse of the bordered matrix. */
void model_leave_one_out(Worker *k, size_t n, size_t n_tail)
{
    const int ni = (int)n, ti = (int)n_tail;
    cblas_dtrsm(CblasColMajor, CblasLeft, CblasLower, CblasTrans, CblasNonUnit, ni, ti, 1.0, k->A, ni, k->P, ni);
    cblas_dtrsm(CblasColMajor, CblasRight, CblasLower, CblasTrans, CblasNonUnit, ni, ti, 1.0, k->M, ti, k->P, ni);
    model_invert(ni, k->A, ni);
    for (size_t i = 0; i < n; i++) {
        const double *column = k->A + i * n + i;
        double q = cblas_ddot(ni - (int)i, column, 1, column, 1);
        for (size_t c = 0; c < n_tail; c++)
            q -= k->P[c * n + i] * k->P[c * n + i];
        k->q[i] = k->w[i] / fmax(q, 1e-300);
    }
}

/* A w + P b = y, standardised, and the leave-one-out errors, with the first o->n centres; 0: not all of it is finite. A
 * centre that alone determines a coefficient of the tail, as where all others have the same value of a variable, leaves
 * no error to compute. */
static int fit_with_tail(const Rbf *m, Worker *k, Output *o, RbfTail tail)
{
    const size_t n = o->n;
    RbfForm form = o->form;
    if (!model_factor(m, k, n, m->C, o->S, &form))
        return 0;
    o->n_tail = model_weights(m, k, n, m->C, model_tail(tail, n, m->n_dim));
    memcpy(o->tail, k->b, o->n_tail * sizeof *o->tail);
    memcpy(o->weight, k->w, n * sizeof *o->weight);
    model_leave_one_out(k, n, o->n_tail);
    double square = 0.0;
    for (size_t i = 0; i < n; i++) {
        o->leave_one_out[i] = k->q[i] * o->scale;
        square += k->q[i] * k->q[i] / (double)n;
    }
    o->explained = 1.0 - square;
    return isfinite(square);
}

static void fit_output(const Rbf *m, Worker *k, Output *o, const double f[], const double noise[])
{
    memcpy(k->noise, noise, m->n * sizeof *noise);
    for (size_t i = 0; i < m->n; i++)
        k->y[i] = (f[i] - o->mean) / o->scale;
    o->is_left_out = 0;
    model_scale(m, m->n, m->C, &o->shape, o->S);
    o->n = MIN_OF(m->n, FEW_CENTRES);
    if (o->form.nugget < NUGGET_START && fit_with_tail(m, k, o, o->form.tail) && 1.0 - o->explained < EXACT_ERROR) {
        memset(o->leave_one_out + o->n, 0, (m->n - o->n) * sizeof *o->leave_one_out);
        return;
    }
    o->n = m->n;
    if (fit_with_tail(m, k, o, o->form.tail) || fit_with_tail(m, k, o, RBF_CONSTANT))
        return;

    /* The mean of the values stands for an output that cannot be fitted; the distances count for nothing. */
    const double n = (double)m->n;
    o->is_left_out = 1;
    o->n_tail = 1;
    o->tail[0] = o->explained = 0.0;
    memset(o->weight, 0, m->n * sizeof *o->weight);
    memset(o->S, 0, (m->n_dim + 1) * m->stride * sizeof *o->S);
    for (size_t i = 0; i < m->n; i++)
        o->leave_one_out[i] = (f[i] - o->mean) * n / (n - 1.0);
}

void model_fit(Rbf *m)
{
#pragma omp parallel for schedule(dynamic, 1) num_threads(m->n_workers)
    for (size_t k = 0; k < m->n_out; k++)
        fit_output(m, &m->worker[omp_get_thread_num()], &m->output[k], m->F + k * m->n_max, m->noise + k * m->n_max);
}

int rbf_is_additive(const Rbf *m, size_t output)
{
    return m->output[output].form.kernel >= RBF_ADDITIVE;
}

size_t rbf_left_out(const Rbf *m)
{
    size_t n = 0;
    for (size_t k = 0; k < m->n_out; k++)
        n += m->output[k].is_left_out != 0;
    return n;
}

/* A variable at its bound has no logarithm: it is taken as if it were this near to it. */
static double log_away(double u)
{
    return log(u < 1e-9 ? 1e-9 : u);
}

Status model_take(Rbf *m, size_t n, const double X[], const double F[], const double noise[], Err *err)
{
    if (n < 2 || n > m->n_max)
        return fail(err, STATUS_INTERNAL, "interpolant: %zu centres, wanted 2 to %zu", n, m->n_max);
    m->n = n;
    for (size_t i = 0; i < n; i++) {
        for (size_t d = 0; d < m->n_dim; d++) {
            double *c = m->C + d * m->stride + i, u = c[0] = X[i * m->n_dim + d];
            c[m->n_dim * m->stride] = log_away(u);
            c[2 * m->n_dim * m->stride] = log_away(1.0 - u);
        }
        for (size_t k = 0; k < m->n_out; k++) {
            m->F[k * m->n_max + i] = F[i * m->n_out + k];
            m->noise[k * m->n_max + i] = noise ? noise[i * m->n_out + k] : 1.0;
        }
    }
    for (size_t k = 0; k < m->n_out; k++) {
        const double *f = m->F + k * m->n_max;
        double mean = 0.0, square = 0.0;
        for (size_t i = 0; i < n; i++)
            mean += f[i] / (double)n;
        for (size_t i = 0; i < n; i++)
            square += (f[i] - mean) * (f[i] - mean) / (double)n;
        m->output[k].mean = mean;
        m->output[k].scale = square > 0.0 ? sqrt(square) : 1.0;
        if (!isfinite(m->output[k].mean) || !isfinite(m->output[k].scale))
            return bad_data(err, "interpolant: a value of output %zu of %zu designs is not finite", k + 1, m->n);
    }
    return STATUS_OK;
}

Status rbf_fit(Rbf *m, size_t n, const double X[], const double F[], const double noise[], Err *err)
{
    TRY(model_take(m, n, X, F, noise, err));
    model_fit(m);
    return STATUS_OK;
}

/* -- prediction ---------------------------------------------------------------------------------------------------- */

/* u, log u, log (1 - u) of n <= RBF_BLOCK points, the last one again where there are fewer: P (3, n_dim, RBF_BLOCK) */
static void place_points(const Rbf *m, size_t n, const double X[], double P[])
{
    for (size_t d = 0; d < m->n_dim; d++)
        for (size_t p = 0; p < RBF_BLOCK; p++) {
            const double u = X[(p < n ? p : n - 1) * m->n_dim + d];
            P[d * RBF_BLOCK + p] = u;
            P[(m->n_dim + d) * RBF_BLOCK + p] = log_away(u);
            P[(2 * m->n_dim + d) * RBF_BLOCK + p] = log_away(1.0 - u);
        }
}

/* The points as the output's kernel sees them: x (n_dim, RBF_BLOCK) */
static void scale_points(const Rbf *m, const Output *o, const double P[], double x[])
{
    for (size_t d = 0; d < m->n_dim; d++)
        kernel_warp(RBF_BLOCK, P + (m->n_dim + d) * RBF_BLOCK, P + (2 * m->n_dim + d) * RBF_BLOCK, o->shape.theta[d],
                    o->shape.warp, x + d * RBF_BLOCK);
}

static double tail_sum(const Rbf *m, const Output *o, const double x[])
{
    double value = 0.0;
    for (size_t c = 0; c < o->n_tail; c++)
        value += o->tail[c] * tail_value(m->n_dim, c, x, 1);
    return value;
}

/* f and error of point p go to f[p n_out]. */
static void eval_output(const Rbf *m, const Output *o, size_t n, const double X[], const double P[], double f[],
                        double error[])
{
    _Alignas(64) double r2[RBF_BLOCK][KERNEL_CHUNK], phi[KERNEL_CHUNK], x[RBF_BLOCK * RBF_DIM_MAX];
    double value[RBF_BLOCK] = {0}, square[RBF_BLOCK] = {0}, weights[RBF_BLOCK] = {0};
    scale_points(m, o, P, x);
    for (size_t first = 0; first < o->n; first += KERNEL_CHUNK) {
        const size_t count = MIN_OF(o->n - first, KERNEL_CHUNK);
        kernel_distances(m->n_dim, m->stride, o->S, x, first, count, r2);
        for (size_t p = 0; p < n; p++) {
            kernel_values(o->form.kernel, count, r2[p], phi);
            if (o->form.kernel >= RBF_ADDITIVE)
                kernel_additive(o->form.kernel, m->n_dim, m->stride, m->C + first, P + p, count, phi, NULL);
            value[p] += kernel_times(count, o->weight + first, phi);
            if (error)
                kernel_errors(count, r2[p], o->leave_one_out + first, &square[p], &weights[p]);
        }
    }
    for (size_t p = 0; p < n; p++) {
        f[p * m->n_out] = o->mean + o->scale * (value[p] + tail_sum(m, o, X + p * m->n_dim));
        if (error)
            error[p * m->n_out] = sqrt(square[p] / weights[p]);
    }
}

void rbf_eval(const Rbf *m, size_t n, const double X[], double F[], double E[])
{
    double P[3 * RBF_BLOCK * RBF_DIM_MAX];
    for (size_t i = 0; i < n; i += RBF_BLOCK) {
        const size_t count = MIN_OF(n - i, RBF_BLOCK);
        place_points(m, count, X + i * m->n_dim, P);
        for (size_t k = 0; k < m->n_out; k++)
            eval_output(m, &m->output[k], count, X + i * m->n_dim, P, F + i * m->n_out + k,
                        E ? E + i * m->n_out + k : NULL);
    }
}

/* Sums over the centres; of variables first. */
typedef struct {
    double x[RBF_BLOCK * RBF_DIM_MAX], by_u[RBF_BLOCK * RBF_DIM_MAX]; /* (n_dim, RBF_BLOCK) */
    double G[RBF_BLOCK * RBF_DIM_MAX * 4];                            /* (n_dim, RBF_BLOCK, 4) */
    double additive[RBF_BLOCK * RBF_DIM_MAX];                         /* (RBF_BLOCK, n_dim) */
    double value[RBF_BLOCK], sum[RBF_BLOCK];
} Slopes;

static void slope_chunk(const Rbf *m, const Output *o, size_t n, const double P[], size_t first, size_t count,
                        Slopes *s)
{
    _Alignas(64) double r2[RBF_BLOCK][KERNEL_CHUNK], q[RBF_BLOCK][KERNEL_CHUNK], phi[KERNEL_CHUNK], w[KERNEL_CHUNK];
    if (n < RBF_BLOCK || count < KERNEL_CHUNK)
        memset(q, 0, sizeof q);
    kernel_distances(m->n_dim, m->stride, o->S, s->x, first, count, r2);
    for (size_t p = 0; p < n; p++) {
        kernel_values_and_slopes(o->form.kernel, count, r2[p], phi, q[p]);
        if (o->form.kernel >= RBF_ADDITIVE) {
            memcpy(w, o->weight + first, count * sizeof *w);
            kernel_times(count, phi, w);
            kernel_additive_slopes(o->form.kernel, m->n_dim, m->stride, m->C + first, P + p, count, w,
                                   s->additive + p * m->n_dim);
            kernel_additive(o->form.kernel, m->n_dim, m->stride, m->C + first, P + p, count, phi, q[p]);
        }
        s->value[p] += kernel_times(count, o->weight + first, phi);
        s->sum[p] += kernel_times(count, o->weight + first, q[p]);
    }
    kernel_project(m->n_dim, m->stride, o->S, first, count, q, s->G);
}

/* With q = w d phi / d (r^2) and warped x, c:  df/dx_d = 2 (x_d sum q - sum q c_d), then the chain rule, and the
 * tail. J of point p goes to J[p n_out n_dim]. */
static void slope_output(const Rbf *m, const Output *o, size_t n, const double X[], const double P[], double f[],
                         double J[])
{
    const size_t n_dim = m->n_dim;
    Slopes s;
    memset(s.G, 0, RBF_BLOCK * n_dim * 4 * sizeof *s.G);
    memset(s.additive, 0, RBF_BLOCK * n_dim * sizeof *s.additive);
    memset(s.value, 0, sizeof s.value);
    memset(s.sum, 0, sizeof s.sum);
    scale_points(m, o, P, s.x);
    for (size_t d = 0; d < n_dim; d++)
        kernel_warp_by_u(RBF_BLOCK, P + (n_dim + d) * RBF_BLOCK, P + (2 * n_dim + d) * RBF_BLOCK, o->shape.theta[d],
                         o->shape.warp, s.by_u + d * RBF_BLOCK);
    for (size_t first = 0; first < o->n; first += KERNEL_CHUNK)
        slope_chunk(m, o, n, P, first, MIN_OF(o->n - first, KERNEL_CHUNK), &s);
    for (size_t p = 0; p < n; p++) {
        f[p * m->n_out] = o->mean + o->scale * (s.value[p] + tail_sum(m, o, X + p * n_dim));
        for (size_t d = 0; d < n_dim; d++) {
            const size_t at = d * RBF_BLOCK + p;
            const double *G = s.G + at * 4, along = (G[0] + G[1]) + (G[2] + G[3]);
            const double linear = o->n_tail > 1 ? 2.0 * o->tail[1 + d] : 0.0,
                         quadratic = o->n_tail > 1 + n_dim ? o->tail[1 + n_dim + d] : 0.0;
            J[p * m->n_out * n_dim + d] =
                o->scale * (2.0 * (s.x[at] * s.sum[p] - along) * s.by_u[at] + s.additive[p * n_dim + d] +
                            (linear + 4.0 * (2.0 * X[p * n_dim + d] - 1.0) * quadratic));
        }
    }
}

void rbf_slope(const Rbf *m, size_t n, const double X[], double F[], double J[])
{
    double P[3 * RBF_BLOCK * RBF_DIM_MAX];
    for (size_t i = 0; i < n; i += RBF_BLOCK) {
        const size_t count = MIN_OF(n - i, RBF_BLOCK);
        place_points(m, count, X + i * m->n_dim, P);
        for (size_t k = 0; k < m->n_out; k++)
            slope_output(m, &m->output[k], count, X + i * m->n_dim, P, F + i * m->n_out + k,
                         J + (i * m->n_out + k) * m->n_dim);
    }
}

const double *rbf_leave_one_out(const Rbf *m, size_t output)
{
    return m->output[output].leave_one_out;
}

double rbf_explained(const Rbf *m, size_t output)
{
    return m->output[output].explained;
}

void rbf_pack(Rbf *m, Pack *p)
{
    pack_size(p, &m->n_tuned, UINT32_MAX);
    for (size_t k = 0; k < m->n_out; k++) {
        Output *o = &m->output[k];
        RbfForm form = o->form;
        pack(p, &form.kernel, sizeof form.kernel);
        pack(p, &form.tail, sizeof form.tail);
        pack_numbers(p, &form.nugget, 1, 0.0, DBL_MAX);
        pack_numbers(p, o->shape.theta, m->n_dim, DBL_MIN, DBL_MAX);
        pack_numbers(p, o->shape.warp, 2, DBL_MIN, DBL_MAX);
        pack_numbers(p, o->step, m->n_dim + 3, DBL_MIN, DBL_MAX);
        p->faulty = p->faulty || form.kernel >= RBF_N_KERNELS || form.tail >= RBF_N_TAILS;
        if (!p->faulty)
            o->form = form;
    }
}
