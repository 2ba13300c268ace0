#include "scene/beam.h"

#include <stdlib.h>

#include "base/linalg.h"

static void mirror(double a[4][4])
{
    for (int i = 0; i < 4; i++)
        for (int j = 0; j < i; j++)
            a[i][j] = a[j][i];
}

static void stiffness(const Beam *b, double phi, double k[4][4])
{
    const double l = b->length, scale = b->EI / (l * l * l * (1 + phi));
    const double shape[4][4] = {{12, 6 * l, -12, 6 * l},
                                {0, (4 + phi) * l * l, -6 * l, (2 - phi) * l * l},
                                {0, 0, 12, -6 * l},
                                {0, 0, 0, (4 + phi) * l * l}};
    for (int i = 0; i < 4; i++)
        for (int j = i; j < 4; j++)
            k[i][j] = scale * shape[i][j];
    mirror(k);
}

static void mass(const Beam *b, double phi, double m[4][4])
{
    const double l = b->length, over = 1 / ((1 + phi) * (1 + phi));
    const double w0 = 70 * phi * phi + 147 * phi + 78, w1 = 35 * phi * phi + 63 * phi + 27;
    const double c0 = (35 * phi * phi + 77 * phi + 44) * l / 4, c1 = (35 * phi * phi + 63 * phi + 26) * l / 4;
    const double r0 = (7 * phi * phi + 14 * phi + 8) * l * l / 4, r1 = (7 * phi * phi + 14 * phi + 6) * l * l / 4;
    const double moved[4][4] = {{w0, c0, w1, -c1}, {0, r0, c1, -r1}, {0, 0, w0, -c0}, {0, 0, 0, r0}};
    const double d = (15 * phi - 3) * l, e0 = (10 * phi * phi + 5 * phi + 4) * l * l,
                 e1 = (5 * phi * phi - 5 * phi - 1) * l * l;
    const double turned[4][4] = {{36, -d, -36, -d}, {0, e0, d, e1}, {0, 0, 36, d}, {0, 0, 0, e0}};
    const double along = b->mass_per_m * l / 210 * over, about = b->rotary_kg_m / (30 * l) * over;
    for (int i = 0; i < 4; i++)
        for (int j = i; j < 4; j++)
            m[i][j] = along * moved[i][j] + about * turned[i][j];
    mirror(m);
}

void beam_element(const Beam *b, double k[4][4], double m[4][4])
{
    const double phi = b->kGA > 0 ? 12 * b->EI / (b->kGA * b->length * b->length) : 0;
    stiffness(b, phi, k);
    mass(b, phi, m);
}

/* ---- cantilever ----------------------------------------------------------------------------------------------- */

/* Unknowns: deflections 0..n-1, then rotations n..2n-1. */
static void assemble(int n, const Beam beam[], double K[], double M[])
{
    const int size = 2 * n;
    for (int e = 0; e < n; e++) {
        double k[4][4], m[4][4];
        beam_element(&beam[e], k, m);
        const int at[4] = {e - 1, e == 0 ? -1 : n + e - 1, e, n + e};
        for (int i = 0; i < 4; i++)
            for (int j = 0; j < 4; j++)
                if (at[i] >= 0 && at[j] >= 0) {
                    K[at[i] * size + at[j]] += k[i][j];
                    M[at[i] * size + at[j]] += m[i][j];
                }
    }
}

/* out (n, n) = T' A T with T = [1; R], A (2n, 2n), R (n, n). */
static void condense(int n, const double A[], const double R[], double work[], double out[])
{
    const int size = 2 * n;
    for (int i = 0; i < size; i++) /* work (2n, n) = A T */
        for (int j = 0; j < n; j++) {
            double sum = A[i * size + j];
            for (int k = 0; k < n; k++)
                sum += A[i * size + n + k] * R[k * n + j];
            work[i * n + j] = sum;
        }
    for (int i = 0; i < n; i++)
        for (int j = 0; j < n; j++) {
            double sum = work[i * n + j];
            for (int k = 0; k < n; k++)
                sum += R[k * n + i] * work[(n + k) * n + j];
            out[i * n + j] = sum;
        }
    for (int i = 0; i < n; i++) /* symmetric but for rounding */
        for (int j = 0; j < i; j++)
            out[i * n + j] = out[j * n + i] = 0.5 * (out[i * n + j] + out[j * n + i]);
}

Status beam_cantilever(int n, const Beam beam[], double K[], double M[], Err *err)
{
    const size_t size = 2 * (size_t)n, nn = (size_t)n * (size_t)n;
    double *whole_K = calloc(2 * size * size + 4 * nn, sizeof *whole_K);
    if (!whole_K)
        return fail(err, STATUS_NO_MEMORY, "beam: no memory for %d elements", n);
    double *whole_M = whole_K + size * size, *Krr = whole_M + size * size, *R = Krr + nn, *work = R + nn;
    assemble(n, beam, whole_K, whole_M);
    for (int i = 0; i < n; i++)
        for (int j = 0; j < n; j++) {
            Krr[i * n + j] = whole_K[(size_t)(n + i) * size + (size_t)(n + j)];
            R[i * n + j] = -whole_K[(size_t)(n + i) * size + (size_t)j];
        }
    const Status status = linalg_solve_spd(n, n, Krr, R, err);
    if (status == STATUS_OK) {
        condense(n, whole_K, R, work, K);
        condense(n, whole_M, R, work, M);
    }
    free(whole_K);
    return status;
}
