#include <cblas.h>
#include <lapacke.h>
#include <omp.h>

#include "base/rprop.h"
#include "rbf/constants.h"
#include "rbf/model.h"
#include "rbf/rbf.h"

/* Parameters p: logarithms of theta of every variable, of a, b of the warp and of the nugget. Weak normal priors hold
 * what the data do not determine: log theta about its mean over the variables, log a and log b about 0. The standard
 * deviation of the latter grows with the number of data: a warp can always explain a few. */

static size_t n_parameters(const Rbf *m)
{
    return m->n_dim + 3;
}

static void read_parameters(const Rbf *m, const double p[], Shape *shape, double *nugget)
{
    for (size_t d = 0; d < m->n_dim; d++)
        shape->theta[d] = exp(p[d]);
    shape->warp[0] = exp(p[m->n_dim]);
    shape->warp[1] = exp(p[m->n_dim + 1]);
    *nugget = exp(p[m->n_dim + 2]);
}

/* Minus the logarithm of the priors, and its gradient. */
static double prior(const Rbf *m, size_t n, const double p[], double gradient[])
{
    double mean = 0.0, l = 0.0;
    for (size_t d = 0; d < m->n_dim; d++)
        mean += p[d] / (double)m->n_dim;
    for (size_t i = 0; i < n_parameters(m); i++) {
        const double spread = i < m->n_dim ? THETA_PRIOR_SD : i < m->n_dim + 2 ? WARP_PRIOR_SD * (double)n : INFINITY;
        const double off = (p[i] - (i < m->n_dim ? mean : 0.0)) / spread;
        l += 0.5 * off * off;
        gradient[i] = off / spread;
    }
    return l;
}

/* Subtracts from the gradient, with v symmetric, q its row sums and s the warped and scaled centres,
 *     1/2 sum_ij v_ij d (s_i - s_j)^2 / dp = 2 sum_i (q_i s_i - z_i) ds_i/dp,    z = v s
 * variable by variable: ds/d log theta = s / 2. q is what v makes of a last column of ones. */
static void pull_back(const Rbf *m, Worker *k, size_t n, const Shape *shape, double gradient[])
{
    const size_t stride = m->stride, plane = m->n_dim * stride;
    const int ni = (int)n;
    const double *q = k->Z + plane;
    for (size_t i = 0; i < n; i++)
        k->S[plane + i] = 1.0;
    cblas_dsymm(CblasColMajor, CblasLeft, CblasLower, ni, (int)m->n_dim + 1, 1.0, k->A, ni, k->S, (int)stride, 0.0,
                k->Z, (int)stride);
    for (size_t d = 0; d < m->n_dim; d++) {
        const double *s = k->S + d * stride, *log_u = k->C + plane + d * stride;
        double *pull = k->Z + d * stride;
        kernel_warp_slopes(n, log_u, log_u + plane, shape->theta[d], shape->warp, k->by_a, k->by_b);
        for (size_t i = 0; i < n; i++)
            pull[i] = 2.0 * (q[i] * s[i] - pull[i]);
        gradient[d] -= 0.5 * cblas_ddot(ni, pull, 1, s, 1);
        gradient[m->n_dim] -= cblas_ddot(ni, pull, 1, k->by_a, 1);
        gradient[m->n_dim + 1] -= cblas_ddot(ni, pull, 1, k->by_b, 1);
    }
}

/* The part of minus the log likelihood that depends on p, variance and tail profiled out:
 *     l = n/2 log(s2) + 1/2 log|A|,    s2 = y'w / n
 * plus the priors, whose gradient is written. INFINITY where the matrix does not factor; else its factor is in k->A. */
static double likelihood(const Rbf *m, Worker *k, size_t n, RbfForm form, const Shape *shape, const double p[],
                         double *s2, double gradient[])
{
    model_scale(m, n, k->C, shape, k->S);
    model_matrix(m, k, n, k->C, k->S, form, k->slope);
    if (LAPACKE_dpotrf_work(LAPACK_COL_MAJOR, 'L', (int)n, k->A, (int)n) != 0)
        return INFINITY;
    k->n_tail = model_weights(m, k, n, k->C, model_tail(form.tail, n, m->n_dim));
    *s2 = fmax(cblas_ddot((int)n, k->y, 1, k->w, 1) / (double)n, 1e-300);
    double l = 0.5 * (double)n * log(*s2) + prior(m, n, p, gradient);
    for (size_t i = 0; i < n; i++)
        l += log(k->A[i * n + i]);
    return l;
}

/* The rest of its gradient, from that factor, which is spoilt. It needs the inverse only once (Rasmussen and Williams,
 * eq. 5.9):
 *     dl/dp = -1/2 sum_ij (w_i w_j / s2 - inv(A)_ij) dA_ij/dp. */
static void likelihood_slope(const Rbf *m, Worker *k, size_t n, RbfForm form, const Shape *shape, double s2,
                             double gradient[])
{
    double trace = 0.0;
    model_invert((int)n, k->A, (int)n);
    LAPACKE_dlauum_work(LAPACK_COL_MAJOR, 'L', (int)n, k->A, (int)n);

    /* The inverse becomes v_ij = (w_i w_j / s2 - inv(A)_ij) d phi_ij / d (r^2), i > j, with 0 on the diagonal; trace:
     * sum_i noise_i (w_i^2 / s2 - inv(A)_ii). */
    for (size_t j = 0; j < n; j++) {
        double *v = k->A + j * n;
        trace += k->noise[j] * (k->w[j] * k->w[j] / s2 - v[j]);
        kernel_weigh(n - j, k->slope + j * n + j, k->w + j, k->w[j], s2, v + j);
        v[j] = 0.0;
    }
    gradient[m->n_dim + 2] -= 0.5 * form.nugget * trace;
    pull_back(m, k, n, shape, gradient);
}

/* Of the forms that are tried the first time, with the same tail, one goes no further that is clearly less likely after
 * a few steps than another kernel was: l is minus the logarithm. */
static int is_hopeless(Worker *k, RbfTail tail, double l)
{
    const int is_far = l > k->likeliest[tail] + 20.0;
    k->likeliest[tail] = fmin(k->likeliest[tail], l);
    return is_far;
}

/* Resilient back-propagation: only the signs of the gradient count, which suits likelihoods with their plateaus and
 * cliffs. Blum and Riedmiller, Optimization of Gaussian process hyperparameters using Rprop, ESANN 2013. Returns
 * whether the last point was the best one: then its factor and weights are at hand. */
static int climb(const Rbf *m, Worker *k, size_t n, const Output *o, RbfForm *form, Shape *shape, int steps)
{
    const size_t n_p = n_parameters(m), i_nugget = n_p - 1;
    double *p = k->log_p, *g = k->gradient, *last = k->last_gradient, best = INFINITY, s2 = 1.0;
    Shape at = {.theta = k->theta};
    int is_best = 0;
    for (size_t i = 0; i < n_p; i++) {
        p[i] = log(i < m->n_dim ? shape->theta[i] : i < i_nugget ? shape->warp[i - m->n_dim] : form->nugget);
        k->best_p[i] = p[i];
        k->step[i] = fmin(fmax(2.0 * o->step[i], 0.1 * TUNE_STEP), TUNE_STEP);
        last[i] = 0.0;
    }
    for (int step = 1; step <= steps; step++) {
        read_parameters(m, p, &at, &form->nugget);
        const double l = likelihood(m, k, n, *form, &at, p, &s2, g);
        is_best = l < best;
        if (step == TUNE_STEPS && step < steps && is_hopeless(k, form->tail, l))
            steps = step;
        if (is_best) {
            best = l;
            memcpy(k->best_p, p, n_p * sizeof *p);
        } else if (!(l < INFINITY)) {
            p[i_nugget] = fmin(p[i_nugget] + log(10.0), 0.0);
            continue;
        }
        if (step < steps)
            likelihood_slope(m, k, n, *form, &at, s2, g);
        for (size_t i = 0; i < n_p && step < steps; i++) {
            /* The bounds of theta and warp only keep exp finite where the data say nothing: far wider ones change no
             * front (docs/measured/constants.csv). All of the variance may be noise. */
            const double least = log(i < i_nugget ? 1e-4 : NUGGET_MIN), most = log(i < i_nugget ? 50.0 : 1.0);
            p[i] = fmin(fmax(p[i] + rprop_move(g[i], &last[i], &k->step[i]), least), most);
        }
    }
    read_parameters(m, k->best_p, shape, &form->nugget);
    return is_best;
}

/* Mean square leave-one-out error of a form and scales on the tuning set, whose factor and weights may be at hand. */
static double trial_error(const Rbf *m, Worker *k, size_t n, RbfForm *form, const Shape *shape, int is_at_hand)
{
    if (!is_at_hand) {
        model_scale(m, n, k->C, shape, k->S);
        if (!model_factor(m, k, n, k->C, k->S, form))
            return INFINITY;
        k->n_tail = model_weights(m, k, n, k->C, model_tail(form->tail, n, m->n_dim));
    }
    model_leave_one_out(k, n, k->n_tail);
    return cblas_ddot((int)n, k->q, 1, k->q, 1) / (double)n;
}

/* Climbs with one form from these scales; the better of this and the best so far stays in the worker. An additive part
 * must be worth it where there is none yet, and is not tried where the others leave nothing. */
static void try_form(const Rbf *m, Worker *k, size_t n, const Output *o, RbfForm form, const Shape *from, int steps)
{
    const int is_new = form.kernel >= RBF_ADDITIVE && o->form.kernel < RBF_ADDITIVE;
    if (k->min_error < (is_new ? ADDITIVE_ERROR : EXACT_ERROR))
        return;
    model_copy_shape(m, &k->shape, from);
    const int is_at_hand = climb(m, k, n, o, &form, &k->shape, steps);
    const double e = trial_error(m, k, n, &form, &k->shape, is_at_hand);
    if (e < k->min_error * (is_new ? ADDITIVE_GAIN : 1.0)) {
        k->min_error = e;
        k->best_form = form;
        model_copy_shape(m, &k->best_shape, &k->shape);
        memcpy(k->best_step, k->step, n_parameters(m) * sizeof *k->step);
    }
}

/* On at most TUNE_CENTRES_MAX centres, evenly spread over their order: a likelihood costs n^3. The first time every
 * form is tried; later the present one and, in turn, a challenger, which is tuned where it is nearly as good with the
 * scales of the present one. */
static void tune_output(const Rbf *m, Worker *k, Output *o, const double f[], const double noise[])
{
    const size_t n = MIN_OF(m->n, TUNE_CENTRES_MAX), n_forms = RBF_N_KERNELS * RBF_N_TAILS;
    const double nugget = fmax(o->form.nugget, NUGGET_START);
    const int is_first = m->n_tuned == 0;
    for (size_t i = 0; i < n; i++) {
        const size_t from = i * m->n / n;
        for (size_t d = 0; d < 3 * m->n_dim; d++)
            k->C[d * m->stride + i] = m->C[d * m->stride + from];
        k->y[i] = (f[from] - o->mean) / o->scale;
        k->noise[i] = noise[from];
    }
    k->min_error = k->likeliest[RBF_CONSTANT] = k->likeliest[RBF_LINEAR] = k->likeliest[RBF_QUADRATIC] = INFINITY;
    if (!is_first) {
        RbfForm present = o->form;
        if (present.nugget < NUGGET_START && trial_error(m, k, n, &present, &o->shape, 0) < EXACT_ERROR)
            return;
        try_form(m, k, n, o, (RbfForm){o->form.kernel, o->form.tail, nugget}, &o->shape, TUNE_STEPS);
    }
    for (size_t i = 0; i < n_forms; i++) {
        const RbfForm form = {(RbfKernel)(i / RBF_N_TAILS), (RbfTail)(i % RBF_N_TAILS), nugget};
        RbfForm trial = form;
        if (is_first)
            try_form(m, k, n, o, form, &o->shape, TUNE_STEPS_FIRST);
        else if (i == m->n_tuned % n_forms && (form.kernel != o->form.kernel || form.tail != o->form.tail) &&
                 trial_error(m, k, n, &trial, &k->best_shape, 0) < CHALLENGE_MAX * k->min_error)
            try_form(m, k, n, o, form, &k->best_shape, TUNE_STEPS);
    }
    if (k->min_error < INFINITY) {
        o->form = k->best_form;
        model_copy_shape(m, &o->shape, &k->best_shape);
        memcpy(o->step, k->best_step, n_parameters(m) * sizeof *o->step);
    }
}

Status rbf_tune(Rbf *m, size_t n, const double X[], const double F[], const double noise[], Err *err)
{
    TRY(model_take(m, n, X, F, noise, err));
#pragma omp parallel for schedule(dynamic, 1) num_threads(m->n_workers)
    for (size_t k = 0; k < m->n_out; k++)
        tune_output(m, &m->worker[omp_get_thread_num()], &m->output[k], m->F + k * m->n_max, m->noise + k * m->n_max);
    m->n_tuned++;
    model_fit(m);
    return STATUS_OK;
}
