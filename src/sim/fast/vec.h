/* sim/fast/vec.h -- FAST_LANES doubles at a time, in the compiler's own vector language: one source for SSE2 (2 lanes),
 * AVX2 (4) and AVX-512 (8). A vector type wider than the registers would be legal and slow. */
#ifndef IMTET_SIM_FAST_VEC_H
#define IMTET_SIM_FAST_VEC_H

#include <stdint.h>

/* Vectors are passed between static functions of one file only, so no caller can disagree about how. */
#pragma GCC diagnostic ignored "-Wpsabi"

#ifndef FAST_LANES
#define FAST_LANES 8
#endif
enum { LANES = FAST_LANES };

/* For functions whose constant arguments the compiler is to unroll over. */
#define INLINE static inline __attribute__((always_inline))

typedef double vec __attribute__((vector_size(8 * FAST_LANES)));
typedef int64_t mask __attribute__((vector_size(8 * FAST_LANES))); /* all ones where true */

/* The greater of the two; b where either is not a number. */
static inline vec vec_max(vec a, vec b)
{
    const mask m = a > b;
    return (vec)(((mask)a & m) | ((mask)b & ~m));
}

static inline vec vec_sqrt(vec a)
{
    vec r;
    for (int i = 0; i < LANES; i++)
        r[i] = __builtin_sqrt(a[i]);
    return r;
}

static inline vec vec_abs(vec a)
{
    return (vec)((mask)a & INT64_MAX);
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

static inline double lanes_sum(vec a)
{
    double sum = 0;
    for (int i = 0; i < LANES; i++)
        sum += a[i];
    return sum;
}

static inline int any(mask m)
{
    int64_t any = 0;
    for (int i = 0; i < LANES; i++)
        any |= m[i];
    return any != 0;
}

/* Y_r = sum_i X_r[i] A[i] for `count` rows i of A, each of `blocks` vectors; r = 0..n_rhs-1. The compiler unrolls over
 * the constant n_rhs and keeps the sums in registers. */
INLINE void rows_times(int n_rhs, const vec *A, int blocks, int count, const double *const X[], vec *const Y[])
{
    for (int b = 0; b < blocks; b++) {
        vec sum[4] = {{0}}, more[4] = {{0}};
        for (int i = 0; i < count; i += 2) {
            const vec a0 = A[i * blocks + b], a1 = A[(i + 1) * blocks + b];
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
