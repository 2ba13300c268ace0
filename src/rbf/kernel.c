#include "rbf/kernel.h"

#include <math.h>
#include <stdint.h>
#include <string.h>

#include "base/clones.h"
#include "rbf/constants.h"

/* Four numbers, wherever they lie. */
typedef double Four __attribute__((vector_size(32), aligned(8), may_alias));

/* exp(x) for x <= 700 within 2e-16 relative, without a branch or a call: x = k log 2 + r, |r| <= log(2) / 2, Taylor
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

CLONED void kernel_warp(size_t n, const double log_u[], const double log_v[], double theta, const double warp[2],
                        double s[])
{
    const double half = 0.5 * sqrt(theta), a = warp[0], b = warp[1];
#pragma omp simd
    for (size_t i = 0; i < n; i++)
        s[i] = half * (exp_down(a * log_u[i]) + 1.0 - exp_down(b * log_v[i]));
}

CLONED void kernel_warp_slopes(size_t n, const double log_u[], const double log_v[], double theta, const double warp[2],
                               double by_a[], double by_b[])
{
    const double half = 0.5 * sqrt(theta), a = warp[0], b = warp[1];
#pragma omp simd
    for (size_t i = 0; i < n; i++) {
        by_a[i] = half * a * log_u[i] * exp_down(a * log_u[i]);
        by_b[i] = -half * b * log_v[i] * exp_down(b * log_v[i]);
    }
}

CLONED_V3 void kernel_warp_by_u(size_t n, const double log_u[], const double log_v[], double theta,
                                const double warp[2], double by_u[])
{
    const double half = 0.5 * sqrt(theta), a = warp[0], b = warp[1];
#pragma omp simd
    for (size_t i = 0; i < n; i++)
        by_u[i] = half * (a * exp_down((a - 1.0) * log_u[i]) + b * exp_down((b - 1.0) * log_v[i]));
}

CLONED void kernel_squares(size_t n, size_t n_dim, size_t stride, double S[])
{
    double *square = S + n_dim * stride;
    memset(square, 0, n * sizeof *square);
    for (size_t d = 0; d < n_dim; d++) {
        const double *s = S + d * stride;
#pragma omp simd
        for (size_t i = 0; i < n; i++)
            square[i] += s[i] * s[i];
    }
}

/* Eight centres and all points of a block at a time: every number that is loaded is used four times at least, and one
 * operation makes a term. */
CLONED_V3 void kernel_distances(size_t n_dim, size_t stride, const double S[], const double x[], size_t first,
                                size_t count, double r2[RBF_BLOCK][KERNEL_CHUNK])
{
    double square[RBF_BLOCK] = {0};
    for (size_t d = 0; d < n_dim; d++)
        for (size_t p = 0; p < RBF_BLOCK; p++)
            square[p] += x[d * RBF_BLOCK + p] * x[d * RBF_BLOCK + p];
    for (size_t i = 0; i < count; i += KERNEL_LANES) {
        Four low[RBF_BLOCK] = {0}, high[RBF_BLOCK] = {0};
        for (size_t d = 0; d < n_dim; d++) {
            const Four *c = (const Four *)(S + d * stride + first + i);
#pragma GCC unroll 4
            for (size_t p = 0; p < RBF_BLOCK; p++) {
                low[p] += c[0] * x[d * RBF_BLOCK + p];
                high[p] += c[1] * x[d * RBF_BLOCK + p];
            }
        }
        const Four *c = (const Four *)(S + n_dim * stride + first + i);
#pragma GCC unroll 4
        for (size_t p = 0; p < RBF_BLOCK; p++) {
            *(Four *)(r2[p] + i) = c[0] + square[p] - 2.0 * low[p];
            *(Four *)(r2[p] + i + 4) = c[1] + square[p] - 2.0 * high[p];
        }
    }
    for (size_t p = 0; p < RBF_BLOCK; p++)
#pragma omp simd
        for (size_t i = 0; i < count; i++)
            r2[p][i] = r2[p][i] < 0.0 ? 0.0 : r2[p][i];
}

CLONED void kernel_values(RbfKernel kernel, size_t n, const double r2[], double phi[])
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
        phi[i] = (1.0 + a + 5.0 / 3.0 * r2[i]) * exp_down(-a);
    }
}

CLONED void kernel_values_and_slopes(RbfKernel kernel, size_t n, const double r2[], double phi[], double slope[])
{
#pragma omp simd
    for (size_t i = 0; i < n; i++) {
        const double a = sqrt(5.0 * r2[i]), e = exp_down(kernel == RBF_GAUSS ? -r2[i] : -a);
        phi[i] = kernel == RBF_GAUSS ? e : (1.0 + a + 5.0 / 3.0 * r2[i]) * e;
        slope[i] = kernel == RBF_GAUSS ? -e : -5.0 / 6.0 * (1.0 + a) * e;
    }
}

CLONED_V3 double kernel_times(size_t n, const double w[], double v[])
{
    double sum = 0.0;
#pragma omp simd reduction(+ : sum)
    for (size_t i = 0; i < n; i++)
        sum += v[i] *= w[i];
    return sum;
}

CLONED_V3 void kernel_errors(size_t n, const double r2[], const double e[], double *square, double *weights)
{
    double squares = 0.0, sum = 0.0;
#pragma omp simd reduction(+ : squares, sum)
    for (size_t i = 0; i < n; i++) {
        const double near = 1.0 / (r2[i] * r2[i] + 1e-12);
        squares += near * e[i] * e[i];
        sum += near;
    }
    *square += squares;
    *weights += sum;
}

/* Two variables at a time, the last one alone twice. */
CLONED_V3 void kernel_project(size_t n_dim, size_t stride, const double S[], size_t first, size_t count,
                              double q[RBF_BLOCK][KERNEL_CHUNK], double G[])
{
    for (size_t d = 0; d < n_dim; d += 2) {
        const size_t next = d + 1 < n_dim ? d + 1 : d;
        const double *s = S + d * stride + first, *t = S + next * stride + first;
        Four *g = (Four *)G + d * RBF_BLOCK, *h = (Four *)G + next * RBF_BLOCK, a[RBF_BLOCK], b[RBF_BLOCK];
        memcpy(a, g, sizeof a);
        memcpy(b, h, sizeof b);
        for (size_t i = 0; i < count; i += 4) {
            const Four u = *(const Four *)(s + i), v = *(const Four *)(t + i);
#pragma GCC unroll 4
            for (size_t p = 0; p < RBF_BLOCK; p++) {
                a[p] += *(const Four *)(q[p] + i) * u;
                b[p] += *(const Four *)(q[p] + i) * v;
            }
        }
        memcpy(g, a, sizeof a);
        memcpy(h, b, sizeof b);
    }
}

CLONED void kernel_weigh(size_t n, const double slope[], const double w[], double w_j, double s2, double v[])
{
#pragma omp simd
    for (size_t i = 0; i < n; i++)
        v[i] = (w[i] * w_j / s2 - v[i]) * slope[i];
}

static double inverse_reach(RbfKernel kernel)
{
    return 1.0 / (kernel == RBF_ADDITIVE ? ADDITIVE_REACH : ADDITIVE_REACH_LONG);
}

CLONED void kernel_additive(RbfKernel kernel, size_t n_dim, size_t stride, const double U[], const double x[],
                            size_t count, double a[], double b[])
{
    const double by_reach = inverse_reach(kernel), each = 0.5 / (double)n_dim;
    double sum[KERNEL_CHUNK] = {0};
    for (size_t d = 0; d < n_dim; d++) {
        const double *u = U + d * stride, at = x[d * RBF_BLOCK];
#pragma omp simd
        for (size_t i = 0; i < count; i++) {
            const double t = fabs(u[i] - at) * by_reach, left = t < 1.0 ? 1.0 - t : 0.0;
            sum[i] += left * left * left * (1.0 + 3.0 * t);
        }
    }
    for (double *values = a; values; values = values == a ? b : NULL)
#pragma omp simd
        for (size_t i = 0; i < count; i++)
            values[i] *= 0.5 + each * sum[i];
}

/* psi' = -12 t (1 - t)^2 */
CLONED_V3 void kernel_additive_slopes(RbfKernel kernel, size_t n_dim, size_t stride, const double U[], const double x[],
                                      size_t count, const double w[], double g[])
{
    const double by_reach = inverse_reach(kernel), each = -6.0 * by_reach / (double)n_dim;
    for (size_t d = 0; d < n_dim; d++) {
        const double *u = U + d * stride, at = x[d * RBF_BLOCK];
        double sum = 0.0;
#pragma omp simd reduction(+ : sum)
        for (size_t i = 0; i < count; i++) {
            const double t = (at - u[i]) * by_reach, off = fabs(t), left = off < 1.0 ? 1.0 - off : 0.0;
            sum += w[i] * t * left * left;
        }
        g[d] += each * sum;
    }
}
