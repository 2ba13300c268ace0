/* base/linalg.h for the page of a report, which has no LAPACK: small dense matrices, by Cholesky and Jacobi. */
#include "base/linalg.h"

/* Lower triangle L of A = L L', in place; the row of the first pivot that is not positive, from 1; 0: none. */
static int factor(int n, double A[])
{
    for (int i = 0; i < n; i++)
        for (int j = 0; j <= i; j++) {
            double sum = A[i * n + j];
            for (int k = 0; k < j; k++)
                sum -= A[i * n + k] * A[j * n + k];
            if (i == j && !(sum > 0))
                return i + 1;
            A[i * n + j] = i == j ? sqrt(sum) : sum / A[j * n + j];
        }
    return 0;
}

/* L X = B (is_transposed: L' X = B), X (n, m) in the place of B. */
static void substitute(int n, int m, const double L[], int is_transposed, double B[])
{
    for (int step = 0; step < n; step++) {
        const int i = is_transposed ? n - 1 - step : step;
        for (int k = is_transposed ? i + 1 : 0; k < (is_transposed ? n : i); k++) {
            const double l = is_transposed ? L[k * n + i] : L[i * n + k];
            for (int c = 0; c < m; c++)
                B[i * m + c] -= l * B[k * m + c];
        }
        for (int c = 0; c < m; c++)
            B[i * m + c] /= L[i * n + i];
    }
}

/* Turns two vectors of n numbers, `stride` apart, in their plane: c of one less s of the other, s of one and c of the
 * other. */
static void rotate(int n, int stride, double one[], double other[], double c, double s)
{
    for (int k = 0; k < n * stride; k += stride) {
        const double a = one[k], b = other[k];
        one[k] = c * a - s * b;
        other[k] = s * a + c * b;
    }
}

/* Eigenvalues on the diagonal of A, eigenvectors in the rows of V, in no order. Cyclic Jacobi converges quadratically:
 * a sixth of SWEEPS_MAX suffices. */
static int diagonalize(int n, double A[], double V[])
{
    enum { SWEEPS_MAX = 60 };
    for (int i = 0; i < n * n; i++)
        V[i] = i % (n + 1) == 0;
    for (int sweep = 0; sweep < SWEEPS_MAX; sweep++) {
        int turned = 0;
        for (int p = 0; p < n; p++)
            for (int q = p + 1; q < n; q++) {
                if (!(fabs(A[p * n + q]) > 1e-17 * sqrt(fabs(A[p * n + p] * A[q * n + q]))))
                    continue;
                /* A_pq becomes 0 (Golub and Van Loan, Matrix Computations, section 8.5.2). */
                const double tau = (A[q * n + q] - A[p * n + p]) / (2 * A[p * n + q]);
                const double t = (tau < 0 ? -1 : 1) / (fabs(tau) + sqrt(1 + tau * tau)), c = 1 / sqrt(1 + t * t);
                rotate(n, n, A + p, A + q, c, t * c);
                rotate(n, 1, A + p * n, A + q * n, c, t * c);
                rotate(n, 1, V + p * n, V + q * n, c, t * c);
                turned = 1;
            }
        if (!turned)
            return 1;
    }
    return 0;
}

Status linalg_modes(int n, const double K[], const double M[], double omega[], double phi[], Err *err)
{
    const size_t nn = n * (size_t)n;
    double *L;
    TRY_ROOM(L, 3 * nn, "numbers of three matrices", err);
    double *A = L + nn, *V = A + nn;
    memcpy(L, M, nn * sizeof *L);
    memcpy(A, K, nn * sizeof *A);
    const int pivot = factor(n, L);
    Status status =
        pivot ? bad_data(err, "modes: the mass matrix is not positive definite (pivot %d)", pivot) : STATUS_OK;

    /* 1. A = L^-1 K L^-T has the same eigenvalues: columns, then rows, which are the columns of its transpose. */
    for (int turn = 0; turn < 2 && status == STATUS_OK; turn++) {
        substitute(n, n, L, 0, A);
        for (int i = 0; i < n; i++)
            for (int j = 0; j < i; j++) {
                const double a = A[i * n + j];
                A[i * n + j] = A[j * n + i];
                A[j * n + i] = a;
            }
    }
    if (status == STATUS_OK && !diagonalize(n, A, V))
        status = fail(err, STATUS_INTERNAL, "modes: Jacobi's method did not converge");

    /* 2. Ascending, back to the coordinates of K, the largest entry positive. */
    for (int i = 0; i < n && status == STATUS_OK; i++) {
        int least = -1, largest = 0;
        for (int k = 0; k < n; k++)
            if (isfinite(A[k * n + k]) && (least < 0 || A[k * n + k] < A[least * n + least]))
                least = k;
        if (least < 0) {
            status = fail(err, STATUS_INTERNAL, "modes: a matrix is not finite");
            break;
        }
        double *v = V + (size_t)least * n;
        substitute(n, 1, L, 1, v);
        for (int j = 1; j < n; j++)
            largest = fabs(v[j]) > fabs(v[largest]) ? j : largest;
        for (int j = 0; j < n; j++)
            phi[j * n + i] = v[largest] < 0 ? -v[j] : v[j];
        omega[i] = A[least * n + least];
        A[least * n + least] = INFINITY;
    }
    free(L);
    TRY(status);
    if (omega[0] < -1e-12 * fabs(omega[n - 1]))
        return bad_data(err, "modes: the stiffness matrix is not positive: lowest w^2 = %g", omega[0]);
    for (int i = 0; i < n; i++)
        omega[i] = sqrt(fmax(omega[i], 0.0));
    return STATUS_OK;
}

Status linalg_solve_spd(int n, int m, double A[], double B[], Err *err)
{
    const int pivot = factor(n, A);
    if (pivot)
        return bad_data(err, "a symmetric %d x %d matrix is not positive definite (pivot %d)", n, n, pivot);
    substitute(n, m, A, 0, B);
    substitute(n, m, A, 1, B);
    return STATUS_OK;
}

int linalg_indefinite_at(int n, const double A[])
{
    const size_t bytes = n * (size_t)n * sizeof *A;
    double *copy = malloc(bytes);
    if (!copy)
        return -1;
    memcpy(copy, A, bytes);
    const int pivot = factor(n, copy);
    free(copy);
    return pivot;
}
