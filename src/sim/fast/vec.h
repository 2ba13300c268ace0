/* sim/fast/vec.h -- FAST_LANES doubles at a time, in the compiler's own vector language: one source for SSE2 (2 lanes),
 * AVX2 (4) and AVX-512 (8). A vector type wider than the registers would be legal and slow. */
#pragma once

#include <stdint.h>
#if defined __AVX2__
#include <immintrin.h>
#endif

/* Vectors are passed between static functions of one file only, so no caller can disagree about how. */
#pragma GCC diagnostic ignored "-Wpsabi"

#ifndef FAST_LANES
#define FAST_LANES 8
#endif
enum { LANES = FAST_LANES };

/* The greater; b where a is not a number. Faster than fmax, which must look at both. */
static inline double larger(double a, double b)
{
    return a > b ? a : b;
}

/* For functions whose constant arguments the compiler is to unroll over. */
#define INLINE static inline __attribute__((always_inline))

typedef double vec __attribute__((vector_size(8 * FAST_LANES)));
typedef int64_t mask __attribute__((vector_size(8 * FAST_LANES))); /* all ones where true */

static inline vec vec_where(mask m, vec a, vec b)
{
    return (vec)(((mask)a & m) | ((mask)b & ~m));
}

/* The greater of the two; b where either is not a number. */
static inline vec vec_max(vec a, vec b)
{
    return vec_where(a > b, a, b);
}

static inline vec vec_abs(vec a)
{
    return (vec)((mask)a & INT64_MAX);
}

static inline vec vec_sqrt(vec a)
{
    for (int i = 0; i < LANES; i++)
        a[i] = __builtin_sqrt(a[i]);
    return a;
}

/* At least sqrt(a^2 + b^2), at most 8 % more, without a root. */
static inline vec vec_hypot_above(vec a, vec b)
{
    const vec x = vec_abs(a), y = vec_abs(b), most = vec_max(x, y);
    return most + 0.4142135623730951 * (x + y - most);
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

static inline v4 v4_abs(v4 a)
{
    return (v4)((m4)a & INT64_MAX);
}

/* Not a number where either is not. */
static inline v4 v4_larger(v4 a, v4 b)
{
    return v4_where((a >= b) | (a != a), a, b);
}

/* LANES_TURN: every lane gets the one `by` lanes further, round the end. LANES_BEFORE: b's lanes one to the right, the
 * last of a before them. */
#if FAST_LANES == 8
#define LANES_TURN(a, by)                                                                                              \
    __builtin_shufflevector(a, a, by, (by + 1) % 8, (by + 2) % 8, (by + 3) % 8, (by + 4) % 8, (by + 5) % 8,            \
                            (by + 6) % 8, (by + 7) % 8)
#define LANES_BEFORE(a, b) __builtin_shufflevector(a, b, 7, 8, 9, 10, 11, 12, 13, 14)
#elif FAST_LANES == 4
#define LANES_TURN(a, by)  __builtin_shufflevector(a, a, by % 4, (by + 1) % 4, (by + 2) % 4, (by + 3) % 4)
#define LANES_BEFORE(a, b) __builtin_shufflevector(a, b, 3, 4, 5, 6)
#else
#define LANES_TURN(a, by)  __builtin_shufflevector(a, a, by % 2, (by + 1) % 2)
#define LANES_BEFORE(a, b) __builtin_shufflevector(a, b, 1, 2)
#endif

static inline double lanes_sum(vec a)
{
    if (LANES > 4)
        a += LANES_TURN(a, 4);
    if (LANES > 2)
        a += LANES_TURN(a, 2);
    return a[0] + a[1];
}

/* The greatest; of no use where one is not a number. */
static inline double lanes_max(vec a)
{
    if (LANES > 4)
        a = vec_max(a, LANES_TURN(a, 4));
    if (LANES > 2)
        a = vec_max(a, LANES_TURN(a, 2));
    return a[0] > a[1] ? a[0] : a[1];
}

/* Bit i: lane i is true. */
static inline unsigned lane_bits(mask m)
{
#if defined __AVX512DQ__ && FAST_LANES == 8
    return _mm512_movepi64_mask((__m512i)m);
#elif defined __AVX2__ && FAST_LANES == 4
    return (unsigned)_mm256_movemask_pd((__m256d)m);
#else
    unsigned bits = 0;
    for (int i = 0; i < LANES; i++)
        bits |= (unsigned)(m[i] & 1) << i;
    return bits;
#endif
}

static inline int any(mask m)
{
    return lane_bits(m) != 0;
}

/* The sums of a, b, c and d. */
static inline v4 v4_sums(v4 a, v4 b, v4 c, v4 d)
{
    const v4 ab = __builtin_shufflevector(a, b, 0, 4, 2, 6) + __builtin_shufflevector(a, b, 1, 5, 3, 7);
    const v4 cd = __builtin_shufflevector(c, d, 0, 4, 2, 6) + __builtin_shufflevector(c, d, 1, 5, 3, 7);
    return __builtin_shufflevector(ab, cd, 0, 1, 4, 5) + __builtin_shufflevector(ab, cd, 2, 3, 6, 7);
}

/* A matrix of 2 x 2, row by row, and a vector of 2, twice: (x0, x1, x0, x1). */
typedef v4 m22;
typedef v4 p2;

static inline m22 m22_times(m22 a, m22 b)
{
    return __builtin_shufflevector(a, a, 0, 0, 2, 2) * __builtin_shufflevector(b, b, 0, 1, 0, 1) +
           __builtin_shufflevector(a, a, 1, 1, 3, 3) * __builtin_shufflevector(b, b, 2, 3, 2, 3);
}

/* A 2 x 2 factor b in two parts, its upper row twice and its lower row twice. */
typedef struct {
    v4 upper, lower;
} m22_rows;

static inline m22_rows m22_split(m22 b)
{
    return (m22_rows){__builtin_shufflevector(b, b, 0, 1, 0, 1), __builtin_shufflevector(b, b, 2, 3, 2, 3)};
}

static inline m22 m22_times_rows(m22 a, m22_rows b)
{
    return __builtin_shufflevector(a, a, 0, 0, 2, 2) * b.upper + __builtin_shufflevector(a, a, 1, 1, 3, 3) * b.lower;
}

/* Not a number where there is none. */
static inline m22 m22_inverse(m22 a)
{
    const v4 products = a * __builtin_shufflevector(a, a, 3, 2, 1, 0); /* ad bc cb da, hence det -det -det det */
    return __builtin_shufflevector(a, a, 3, 1, 2, 0) /
           (products - __builtin_shufflevector(products, products, 1, 0, 3, 2));
}

/* The vector (e0 + e1, e2 + e3): with e = a * x, or a sum of such, it is the product of matrix and vector. */
static inline p2 p2_sum(v4 e)
{
    const v4 sums = e + __builtin_shufflevector(e, e, 1, 0, 3, 2);
    return __builtin_shufflevector(sums, sums, 0, 2, 0, 2);
}

static inline double p2_dot(p2 a, p2 b)
{
    const p2 c = a * b;
    return c[0] + c[1];
}

static inline p2 p2_make(double x0, double x1)
{
    return (p2){x0, x1, x0, x1};
}

/* The numbers of an array of vectors. */
static inline double *scalars(vec *p)
{
    return (double *)p;
}

static inline const double *scalars_const(const vec *p)
{
    return (const double *)p;
}

/* Largest magnitude of nf vectors; of no use where one is not a number. */
static inline double largest(const vec *a, int nf)
{
    vec most = vec_abs(a[0]);
    for (int f = 1; f < nf; f++)
        most = vec_max(most, vec_abs(a[f]));
    return lanes_max(most);
}

/* Blocks first, first + 1 .. (n_blocks of them) of Y_r = sum_i X_r[i] A[i], of `count` numbers of X_r and rows of A,
 * each of `blocks` vectors; r = 0..n_rhs-1. The sums stay in registers: an element of X, once in all lanes, serves
 * all blocks. */
INLINE void rows_times_blocks(const int n_rhs, const int n_blocks, const vec *A, int blocks, int first, int count,
                              const vec *const X[], vec *const Y[])
{
    vec sum[4][4] = {{{0}}};
#pragma GCC unroll 4
    for (int i = 0; i < count; i++, A += blocks)
#pragma GCC unroll 4
        for (int r = 0; r < n_rhs; r++)
#pragma GCC unroll 4
            for (int b = 0; b < n_blocks; b++)
                sum[r][b] += A[first + b] * scalars_const(X[r])[i];
#pragma GCC unroll 4
    for (int r = 0; r < n_rhs; r++)
#pragma GCC unroll 4
        for (int b = 0; b < n_blocks; b++)
            Y[r][first + b] = sum[r][b];
}

/* The first blocks, `wanted` of them, three at a time: twenty floors are three vectors of eight. */
INLINE void rows_times_first(const int n_rhs, const vec *A, int blocks, int wanted, int count, const vec *const X[],
                             vec *const Y[])
{
    int b = 0;
    for (; b + 3 <= wanted; b += 3)
        rows_times_blocks(n_rhs, 3, A, blocks, b, count, X, Y);
    for (; b < wanted; b++)
        rows_times_blocks(n_rhs, 1, A, blocks, b, count, X, Y);
}

INLINE void rows_times(const int n_rhs, const vec *A, int blocks, int count, const vec *const X[], vec *const Y[])
{
    rows_times_first(n_rhs, A, blocks, blocks, count, X, Y);
}
