/* sim/fast/vec.h -- eight doubles at a time, in the compiler's own vector language: one source for SSE2, AVX2, AVX-512. */
#ifndef IMTET_SIM_FAST_VEC_H
#define IMTET_SIM_FAST_VEC_H

#include <stdint.h>

/* Vectors are passed between static functions of one file only, so no caller can disagree about how. */
#pragma GCC diagnostic ignored "-Wpsabi"

typedef double v8 __attribute__((vector_size(64)));
typedef int64_t m8 __attribute__((vector_size(64))); /* all ones where true */

enum { LANES = 8 };

/* The greater of the two; b where either is not a number. */
static inline v8 v8_max(v8 a, v8 b)
{
    const m8 m = a > b;
    return (v8)(((m8)a & m) | ((m8)b & ~m));
}

static inline v8 v8_sqrt(v8 a)
{
    v8 r;
    for (int i = 0; i < LANES; i++)
        r[i] = __builtin_sqrt(a[i]);
    return r;
}

static inline v8 v8_abs(v8 a)
{
    return (v8)((m8)a & INT64_MAX);
}

typedef double v4 __attribute__((vector_size(32)));
typedef int64_t m4 __attribute__((vector_size(32)));

static inline v4 v4_where(m4 m, v4 a, v4 b)
{
    return (v4)(((m4)a & m) | ((m4)b & ~m));
}

static inline v4 v4_sqrt(v4 a)
{
    v4 r;
    for (int i = 0; i < 4; i++)
        r[i] = __builtin_sqrt(a[i]);
    return r;
}

static inline double v4_sum(v4 a)
{
    return (a[0] + a[1]) + (a[2] + a[3]);
}

static inline double lanes_sum(v8 a)
{
    return ((a[0] + a[1]) + (a[2] + a[3])) + ((a[4] + a[5]) + (a[6] + a[7]));
}

static inline int m8_any(m8 m)
{
    int64_t any = 0;
    for (int i = 0; i < LANES; i++)
        any |= m[i];
    return any != 0;
}

/* Y_r = sum_i X_r[i] A[i] for `count` rows i of A, each of `blocks` vectors; r = 0..n_rhs-1. The compiler unrolls over the
 * constant n_rhs and keeps the sums in registers. */
static inline __attribute__((always_inline)) void rows_times(int n_rhs, const v8 *A, int blocks, int count,
                                                             const double *const X[], v8 *const Y[])
{
    for (int b = 0; b < blocks; b++) {
        v8 sum[4] = {{0}}, more[4] = {{0}};
        for (int i = 0; i < count; i += 2) {
            const v8 a0 = A[i * blocks + b], a1 = A[(i + 1) * blocks + b];
            for (int r = 0; r < n_rhs; r++) {
                sum[r] += a0 * X[r][i];
                more[r] += a1 * X[r][i + 1];
            }
        }
        for (int r = 0; r < n_rhs; r++)
            Y[r][b] = sum[r] + more[r];
    }
}

#endif
