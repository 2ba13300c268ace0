/* rbf/kernel.h -- the inner loops of the interpolant: distances, kernel values, their derivatives and sums.
 *
 * Compiled once for any machine and once for wide vectors, chosen when the program starts; on one machine the same
 * numbers always give the same bits. Centres lie variable by variable, S (n_dim + 1, stride), warped and scaled,
 * |s|^2 in the last row; stride is a multiple of KERNEL_LANES and S has KERNEL_LANES numbers to spare behind it.
 *
 * Threads  pure functions. */
#pragma once

#include <stddef.h>

/* From RBF_ADDITIVE on: Matern, times what kernel_additive says, of either reach. */
typedef enum { RBF_GAUSS, RBF_MATERN, RBF_ADDITIVE, RBF_ADDITIVE_LONG, RBF_N_KERNELS } RbfKernel;

/* RBF_BLOCK: points that are evaluated together. */
enum { KERNEL_LANES = 8, KERNEL_CHUNK = 64, RBF_BLOCK = 4 };

/* s = root(theta) (u^a + 1 - v^b) / 2 with v = 1 - u, from log u and log v; warp = a, b. */
void kernel_warp(size_t n, const double log_u[], const double log_v[], double theta, const double warp[2], double s[]);

/* Its derivatives by log a and log b. */
void kernel_warp_slopes(size_t n, const double log_u[], const double log_v[], double theta, const double warp[2],
                        double by_a[], double by_b[]);

/* ds/du = root(theta) (a u^(a-1) + b v^(b-1)) / 2 */
void kernel_warp_by_u(size_t n, const double log_u[], const double log_v[], double theta, const double warp[2],
                      double by_u[]);

/* The last row of S, for n centres. */
void kernel_squares(size_t n, size_t n_dim, size_t stride, double S[]);

/* r2[p][i] = |s|^2 + |x|^2 - 2 s.x, squared distance of point p to centre first + i, count <= KERNEL_CHUNK; x (n_dim,
 * RBF_BLOCK) warped and scaled like the centres. Numbers behind count, up to a multiple of KERNEL_LANES, are spoilt. */
void kernel_distances(size_t n_dim, size_t stride, const double S[], const double x[], size_t first, size_t count,
                      double r2[RBF_BLOCK][KERNEL_CHUNK]);

/* phi[i] of r2[i], and its derivative by it. */
void kernel_values(RbfKernel kernel, size_t n, const double r2[], double phi[]);
void kernel_values_and_slopes(RbfKernel kernel, size_t n, const double r2[], double phi[], double slope[]);

/* Multiplies v by w; returns its sum. */
double kernel_times(size_t n, const double w[], double v[]);

/* Adds to the local average of squared errors e: near_i = 1 / r^4, *square += sum near e^2, *weights += sum near. */
void kernel_errors(size_t n, const double r2[], const double e[], double *square, double *weights);

/* G[d][p][i % 4] += sum_i q[p][i] S[d][first + i], count <= KERNEL_CHUNK; q is 0 behind count up to a multiple of
 * KERNEL_LANES. */
void kernel_project(size_t n_dim, size_t stride, const double S[], size_t first, size_t count,
                    double q[RBF_BLOCK][KERNEL_CHUNK], double G[]);

/* Multiplies a and, where it is not NULL, b by 1/2 + 1/2 mean_d psi(|x_d - u_d| / reach), with psi(t) =
 * (1 - t)^3 (1 + 3 t), 0 beyond t = 1, of `count` <= KERNEL_CHUNK centres U (n_dim, stride) and the first point of a
 * block x (n_dim, RBF_BLOCK), neither warped nor scaled. */
void kernel_additive(RbfKernel kernel, size_t n_dim, size_t stride, const double U[], const double x[], size_t count,
                     double a[], double b[]);

/* Adds sum_i w[i] times its derivatives by x to g (n_dim). */
void kernel_additive_slopes(RbfKernel kernel, size_t n_dim, size_t stride, const double U[], const double x[],
                            size_t count, const double w[], double g[]);

/* v[i] = (w[i] w_j / s2 - v[i]) slope[i]: the terms of the likelihood's gradient of one column. */
void kernel_weigh(size_t n, const double slope[], const double w[], double w_j, double s2, double v[]);
