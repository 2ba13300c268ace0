/* base/linalg.h -- the few dense operations that the scene needs, on LAPACK. Matrices are square (n, n) row-major;
 * symmetric ones are read in full.
 *
 * Threads  no state; BLAS is expected to run on one thread (linalg_use) */
#pragma once

#include "base/status.h"

/* From now on OpenBLAS uses the kernels of Haswell, which wherever there are AVX2 and FMA give the same bytes, but
 * where OPENBLAS_CORETYPE is set or there is no choice. Changes BLAS for the whole process: for a program to call,
 * before it starts threads, never for a library. 0: no memory. */
int linalg_pin(void);
const char *linalg_kernel_name(void); /* "Haswell" */

/* For a library: between the two BLAS has one thread, and then again as many as before. The number is one of the whole
 * process: of several threads that are between them the first and the last change it. */
void linalg_begin(void);
void linalg_end(void);

/* Where the address space is limited (RLIMIT_AS, `ulimit -v`): room for the linear algebra of so many threads at
 * once, the first of which has been here before. OpenBLAS, which would ask for memory for ever, gets it now; where
 * there is none: STATUS_NO_MEMORY. To be called before memory is taken for other things. */
Status linalg_room(size_t n_threads, Err *err);

/* K x = w^2 M x, ascending: omega[i] = sqrt(w^2) [rad/s], phi (n, n) with column i = mode i, phi' M phi = 1, the
 * largest entry by magnitude of every mode positive. A negative w^2 within rounding counts as zero. K and M are kept.
 */
Status linalg_modes(int n, const double K[], const double M[], double omega[], double phi[], Err *err);

/* gamma_i = phi_i' M r of the modes above; r NULL: 1. */
void linalg_participation(int n, const double M[], const double *r, const double phi[], double gamma[]);

/* X: A X = B with A symmetric positive definite (n, n), B (n, m) row-major and overwritten. A is overwritten. */
Status linalg_solve_spd(int n, int m, double A[], double B[], Err *err);

/* Row of the first pivot that is not positive in a Cholesky factorisation, counted from 1; 0: positive definite.
 * -1: no memory. */
int linalg_indefinite_at(int n, const double A[]);

/* Symmetric band matrix A (n), its lower band column by column: A_ij at A[j (band+1) + i-j], j <= i <= j+band. Cholesky
 * in place; the diagonal of the factor stands at A[j (band+1)]. Row of the first pivot that is not positive, counted
 * from 1; 0: factored; -1: no memory. */
int linalg_factor_band(int n, int band, double A[]);

/* A X = B with that factor; B: m right-hand sides, each the first n of `stride` numbers, overwritten. */
void linalg_solve_band(int n, int band, const double A[], int m, int stride, double B[]);

/* out (m, m) = T' A T of a symmetric A (n, n), T (n, m); work (n, m). */
void linalg_congruent(int n, int m, const double A[], const double T[], double work[], double out[]);

/* C (n, n) = A B' with A, B (n, m). */
void linalg_product_of_rows(int n, int m, const double A[], const double B[], double C[]);
