/* rbf/rbf.h -- radial basis interpolant of several outputs, with its own leave-one-out errors.
 *
 *   s(x) = b . p(x) + sum_j w_j phi(r(x, c_j)),    r^2 = sum_d theta_d (v(x_d) - v(c_jd))^2     for each output
 *   v(u) = (u^a + 1 - (1 - u)^b) / 2               stretches the neighbourhood of a bound where a, b < 1: a gap of some
 *                                                  millimetres differs more from the next than one of half a metre
 *
 *   phi     Gaussian or Matern 5/2, positive definite; where leave-one-out errors are smaller, times an additive part
 *             1/2 + 1/2 mean_d psi(|x_d - c_jd| / reach),  psi(t) = (1 - t)^3 (1 + 3 t), 0 beyond t = 1 (Wendland)
 *           functions of single variables, waves say, whose height the rest modulates: as many data as waves along one
 *           variable times variables tell them, where a product alone needs as many as waves to the power of variables
 *   p       constant, linear or diagonal quadratic tail
 *   nugget  on the diagonal of the kernel matrix: 1e-8 for smooth data, more where data are noisy or centres nearly
 *           equal; times noise_i where some centres are known better than others: 1/n for a mean of n replicates
 *
 * Every output has its own kernel, tail, length scales theta, warp a, b and nugget. rbf_tune maximises the likelihood
 * over scales, warp and nugget and takes the kernel and tail with the smallest leave-one-out error; rbf_fit keeps them.
 *
 * Error       of a prediction: root mean square of the leave-one-out errors weighted with 1/r^4, a local average
 * Life cycle  rbf_create -> (rbf_fit or rbf_tune -> rbf_eval ...) ... -> free; rbf_tune now and then
 * Memory      all of it in rbf_create, for at most n_max centres
 * Threads     rbf_fit and rbf_tune share the outputs out over OpenMP threads (set BLAS to one); rbf_eval only reads
 * Shapes      row-major X (n, n_dim), F (n, n_out); x scaled to the unit cube; n_dim <= RBF_DIM_MAX
 * Errors      near-equal centres raise the nugget until the matrix factors; centres that do not determine the tail
 *             make it constant; an output that cannot be fitted all the same is left out: its mean stands for it,
 *             explained is 0. BAD_DATA: a value is not finite
 * Sources     Rippa, Adv. Comput. Math. 11 (1999) 193-210 (leave-one-out)
 *             Rasmussen and Williams, Gaussian Processes for Machine Learning (2006) ch. 2 and 5 (kernels, tail,
 *             likelihood)
 *             Duvenaud, Nickisch and Rasmussen, Additive Gaussian processes, NIPS 2011
 *             Wendland, Adv. Comput. Math. 4 (1995) 389-396 (psi)
 *             Snoek, Swersky, Zemel and Adams, Input warping for Bayesian optimization of non-stationary functions,
 *             ICML 2014 (the idea of v) */
#pragma once

#include "base/pack.h"
#include "base/status.h"
#include "rbf/kernel.h"

typedef struct Rbf Rbf;

enum { RBF_DIM_MAX = 512 };

Status rbf_create(Rbf **out, size_t n_max, size_t n_dim, size_t n_out, Err *err);

/* Fits F at X with the present forms and scales; variances are nugget times noise (n, n_out), NULL: 1; rbf_create
 * starts with Matern, linear tail, theta = 1 / n_dim, no warp. */
Status rbf_fit(Rbf *m, size_t n, const double X[], const double F[], const double noise[], Err *err);

/* Tunes forms and scales first, starting from the present ones, on at most 250 evenly spread centres; then fits as
 * above. */
Status rbf_tune(Rbf *m, size_t n, const double X[], const double F[], const double noise[], Err *err);

/* F (n, n_out) at X (n, n_dim), and the errors E (n, n_out), which may be NULL. RBF_BLOCK points cost little more than
 * one. */
void rbf_eval(const Rbf *m, size_t n, const double X[], double F[], double E[]);

/* F (n, n_out) and its derivatives J (n, n_out, n_dim). */
void rbf_slope(const Rbf *m, size_t n, const double X[], double F[], double J[]);

const double *rbf_leave_one_out(const Rbf *m, size_t output); /* (n) f_i minus the prediction made without i */
double rbf_explained(const Rbf *m, size_t output);            /* 1 - leave-one-out variance / variance; 1: perfect */

int rbf_is_additive(const Rbf *m, size_t output); /* its kernel has an additive part */

size_t rbf_left_out(const Rbf *m); /* outputs that the last fit left out */

/* Forms, scales, warps and how often they were tuned: with the data of the next rbf_fit all of the model's state. */
void rbf_pack(Rbf *m, Pack *p);
