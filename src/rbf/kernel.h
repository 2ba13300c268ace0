/* rbf/kernel.h -- the inner loops of the response surface: distances, kernel values, their derivatives and sums.
 *
 * Compiled once for any machine and once for wide vectors, chosen when the program starts; on one machine the same
 * numbers always give the same bits. Centres lie variable by variable, S (n_dim, stride), each variable multiplied by
 * the square root of its theta; stride is a multiple of KERNEL_LANES and S has KERNEL_LANES numbers to spare behind it.
 *
 * Threads  pure functions. */
#ifndef IMTET_RBF_KERNEL_H
#define IMTET_RBF_KERNEL_H

#include "rbf/rbf.h"

enum { KERNEL_LANES = 8, KERNEL_CHUNK = 64 };

/* r2[p][i] = squared distance of point p to centre first + i, count <= KERNEL_CHUNK; x (RBF_BLOCK, n_dim) scaled like
 * the centres. Numbers behind count, up to a multiple of KERNEL_LANES, are spoilt. */
void kernel_distances(size_t n_dim, size_t stride, const double S[], const double x[], size_t first, size_t count,
                      double r2[RBF_BLOCK][KERNEL_CHUNK]);

/* phi[i] of r2[i]; may be the same array. */
void kernel_values(RbfKernel kernel, size_t n, const double r2[], double phi[]);

/* q[i] = w[i] d phi / d (r^2) at r2[i]; returns the sum of w phi. */
double kernel_slopes(RbfKernel kernel, size_t n, const double r2[], const double w[], double q[]);

/* G[p][d] += sum_i q[p][i] S[d][first + i], count <= KERNEL_CHUNK; q is 0 behind count up to a multiple of
 * KERNEL_LANES. */
void kernel_project(size_t n_dim, size_t stride, const double S[], size_t first, size_t count,
                    double q[RBF_BLOCK][KERNEL_CHUNK], double *G);

/* v[i] = (w[i] w_j / s2 - v[i]) d phi / d (r^2) at r2[i]: the terms of the likelihood's gradient of one column. */
void kernel_weigh(RbfKernel kernel, size_t n, const double r2[], const double w[], double w_j, double s2, double v[]);

/* sum_i v[i] (c[i] - at)^2 */
double kernel_moment(size_t n, const double v[], const double c[], double at);

#endif
