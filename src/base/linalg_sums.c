/* What of base/linalg.h is plain sums, without LAPACK. */
#include "base/linalg.h"

void linalg_participation(int n, const double M[], const double *r, const double phi[], double gamma[])
{
    for (int i = 0; i < n; i++) {
        gamma[i] = 0;
        for (int j = 0; j < n; j++)
            for (int k = 0; k < n; k++)
                gamma[i] += phi[j * n + i] * M[j * n + k] * (r ? r[k] : 1);
    }
}

/* Plain sums, so that the core has the same bits with any BLAS. */
void linalg_congruent(int n, int m, const double A[], const double T[], double work[], double out[])
{
    memset(work, 0, n * m * sizeof *work);
    memset(out, 0, m * m * sizeof *out);
    for (int i = 0; i < n; i++)
        for (int k = 0; k < n; k++)
            for (int j = 0; j < m && A[i * n + k] != 0; j++)
                work[i * m + j] += A[i * n + k] * T[k * m + j];
    for (int k = 0; k < n; k++)
        for (int i = 0; i < m; i++)
            for (int j = 0; j < m && T[k * m + i] != 0; j++)
                out[i * m + j] += T[k * m + i] * work[k * m + j];
    for (int i = 0; i < m; i++)
        for (int j = 0; j < i; j++) /* symmetric but for rounding */
            out[i * m + j] = out[j * m + i] = 0.5 * (out[i * m + j] + out[j * m + i]);
}
