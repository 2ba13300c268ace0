#include <cblas.h>
#include <lapacke.h>
#include <math.h>
#include <omp.h>
#include <string.h>

#include "rbf/kernel.h"
#include "rbf/model.h"

enum { TUNE_MAX = 250, TUNE_STEPS_FIRST = 16, TUNE_STEPS = 8 };

static const double THETA_MIN = 1e-4, THETA_MAX = 50.0;
/* Weak prior on log theta (mean log 1/n_dim): keeps the scale of a variable that the data say nothing about. */
static const double PRIOR_SPREAD = 2.0;

/* Adds theta_d times the likelihood's derivative by theta_d, from the inverse in A and the scaled centres, to the
 * gradient; returns sum_i (w_i^2 / s2 - inv(A)_ii). Spoils A. */
static double likelihood_slopes(const Rbf *m, Worker *k, size_t n, RbfKernel kernel, double s2, double gradient[])
{
    const size_t n_dim = m->n_dim, stride = m->stride;
    double trace = 0.0, r2[RBF_BLOCK][KERNEL_CHUNK], x[RBF_BLOCK * RBF_DIM_MAX];
    for (size_t j = 0; j < n; j++)
        trace += k->w[j] * k->w[j] / s2 - k->A[j * n + j];
    for (size_t j = 0; j < n; j += RBF_BLOCK) {
        model_gather(m, k->S, j, n, x);
        for (size_t i = j; i < n; i += KERNEL_CHUNK) {
            const size_t count = n - i < KERNEL_CHUNK ? n - i : KERNEL_CHUNK;
            kernel_distances(n_dim, stride, k->S, x, i, count, r2);
            for (size_t p = 0; p < RBF_BLOCK && j + p < n; p++) {
                const size_t skip = i == j ? (p + 1 < count ? p + 1 : count) : 0, from = i + skip;
                double *v = k->A + (j + p) * n + from;
                kernel_weigh(kernel, count - skip, r2[p] + skip, k->w + from, k->w[j + p], s2, v);
                for (size_t d = 0; d < n_dim; d++)
                    gradient[d] -= kernel_moment(count - skip, v, k->S + d * stride + from, x[p * n_dim + d]);
            }
        }
    }
    return trace;
}

/* The part of minus the log likelihood that depends on p = (log theta, log nugget), variance and tail profiled out:
 *     l = n/2 log(s2) + 1/2 log|A|,    s2 = y'w / n
 * plus the prior. Its gradient needs the inverse only once (Rasmussen and Williams, eq. 5.9):
 *     dl/dp = -1/2 sum_ij (w_i w_j / s2 - inv(A)_ij) dA_ij/dp.
 * INFINITY where the matrix does not factor. */
static double likelihood(const Rbf *m, Worker *k, size_t n, RbfForm form, double theta[], const double p[],
                         double gradient[])
{
    const size_t n_dim = m->n_dim;
    const double prior_mean = -log((double)n_dim), nugget = exp(p[n_dim]);
    for (size_t d = 0; d < n_dim; d++)
        theta[d] = exp(p[d]);
    model_scale(m, n, k->C, theta, k->S);
    model_matrix(m, n, k->S, form.kernel, nugget, k->A);
    if (LAPACKE_dpotrf_work(LAPACK_COL_MAJOR, 'L', (int)n, k->A, (int)n) != 0)
        return INFINITY;
    model_weights(m, k, n, k->C, model_tail(form.tail, n, n_dim));
    const double s2 = fmax(cblas_ddot((int)n, k->y, 1, k->w, 1) / (double)n, 1e-300);
    double l = 0.5 * (double)n * log(s2);
    for (size_t i = 0; i < n; i++)
        l += log(k->A[i * n + i]);
    model_invert((int)n, k->A, (int)n);
    LAPACKE_dlauum_work(LAPACK_COL_MAJOR, 'L', (int)n, k->A, (int)n);

    for (size_t d = 0; d < n_dim; d++) {
        const double off = (p[d] - prior_mean) / PRIOR_SPREAD;
        l += 0.5 * off * off;
        gradient[d] = 0.0;
    }
    const double trace = likelihood_slopes(m, k, n, form.kernel, s2, gradient);
    for (size_t d = 0; d < n_dim; d++)
        gradient[d] += (p[d] - prior_mean) / (PRIOR_SPREAD * PRIOR_SPREAD);
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
    model_scale(m, n, k->C, theta, k->S);
    if (!model_factor(m, k, n, k->S, form))
        return INFINITY;
    model_leave_one_out(k, n, model_weights(m, k, n, k->C, model_tail(form->tail, n, m->n_dim)));
    return cblas_ddot((int)n, k->q, 1, k->q, 1) / (double)n;
}

/* At most TUNE_MAX centres, evenly spread over their order: a likelihood costs n^3. */
static size_t choose_tuning_set(const Rbf *m, Worker *k, const Output *o, const double f[])
{
    const size_t n = m->n < TUNE_MAX ? m->n : TUNE_MAX;
    for (size_t i = 0; i < n; i++) {
        const size_t from = i * m->n / n;
        for (size_t d = 0; d < m->n_dim; d++)
            k->C[d * m->stride + i] = m->C[d * m->stride + from];
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
    return model_fit(m, err);
}
