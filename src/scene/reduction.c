#include "scene/reduction.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/linalg.h"
#include "scene/options.h"

/* ---- Craig-Bampton -------------------------------------------------------------------------------------------- */

typedef struct {
    int f, i, modes;      /* floors, others, fixed-interface modes */
    double *Kii, *Mii;    /* (i, i) */
    double *Psi;          /* (i, f) */
    double *mu, *phi;     /* (i), (i, i) column k is mode k */
    double *missed, *M_r; /* (i) the shape that is added, Mii times a shape */
    double *T, *half;     /* (n, n + 1) row-major with `columns` columns, of which so many are used */
    int columns;
    double *store;
} Reduction;

static Status allocate(Reduction *r, Err *err)
{
    const size_t i = (size_t)r->i, f = (size_t)r->f, n = i + f;
    r->store = calloc(4 * i * i + i * f + 3 * i + 2 * n * (n + 1), sizeof *r->store);
    if (!r->store)
        return fail(err, STATUS_NO_MEMORY, "building: no memory to reduce %zu degrees of freedom", n);
    r->Kii = r->store;
    r->Mii = r->Kii + i * i;
    r->phi = r->Mii + i * i;
    r->Psi = r->phi + 2 * i * i; /* behind phi is room for a copy of Kii */
    r->mu = r->Psi + i * f;
    r->missed = r->mu + i;
    r->M_r = r->missed + i;
    r->T = r->M_r + i;
    r->half = r->T + n * (n + 1);
    return STATUS_OK;
}

static Status constraint_modes(Reduction *r, const FrameFull *full, Err *err)
{
    double *factor = r->phi + r->i * r->i;
    for (int a = 0; a < r->i; a++) {
        for (int b = 0; b < r->f; b++)
            r->Psi[a * r->f + b] = -full->K[(r->f + a) * full->n + b];
        for (int b = 0; b < r->i; b++) {
            r->Kii[a * r->i + b] = full->K[(r->f + a) * full->n + r->f + b];
            r->Mii[a * r->i + b] = full->M[(r->f + a) * full->n + r->f + b];
        }
    }
    memcpy(factor, r->Kii, (size_t)(r->i * r->i) * sizeof *factor);
    TRY(linalg_solve_spd(r->i, r->f, factor, r->Psi, err));
    return linalg_modes(r->i, r->Kii, r->Mii, r->mu, r->phi, err);
}

static void mass_times(const Reduction *r, const double x[], double out[])
{
    for (int a = 0; a < r->i; a++) {
        out[a] = 0;
        for (int b = 0; b < r->i; b++)
            out[a] += r->Mii[a * r->i + b] * x[b];
    }
}

static double dot(int n, const double x[], const double y[])
{
    double sum = 0;
    for (int a = 0; a < n; a++)
        sum += x[a] * y[a];
    return sum;
}

/* Below this share of its mass the missed shape is rounding. */
static const double MISSED_MIN = 1e-12;

/* Coordinates of r in the columns of T: 1 for the floors, c for the modes; what is left, normalised, and its norm (0:
 * nothing is). */
static double missed_shape(Reduction *r, const FrameFull *full, double influence[])
{
    for (int a = 0; a < r->i; a++) {
        r->missed[a] = full->influence[r->f + a];
        for (int b = 0; b < r->f; b++)
            r->missed[a] -= r->Psi[a * r->f + b] * full->influence[b];
    }
    mass_times(r, r->missed, r->M_r);
    const double whole = dot(r->i, r->missed, r->M_r);
    for (int k = 0; k < r->modes; k++) {
        double c = 0;
        for (int a = 0; a < r->i; a++)
            c += r->phi[a * r->i + k] * r->M_r[a];
        influence[r->f + k] = c;
        for (int a = 0; a < r->i; a++)
            r->missed[a] -= c * r->phi[a * r->i + k];
    }
    mass_times(r, r->missed, r->M_r);
    const double square = dot(r->i, r->missed, r->M_r);
    if (r->modes == r->i || !(square > MISSED_MIN * whole))
        return 0;
    for (int a = 0; a < r->i; a++)
        r->missed[a] /= sqrt(square);
    return sqrt(square);
}

static void set_columns(Reduction *r, int with_missed)
{
    const int columns = r->columns = r->f + r->modes + with_missed;
    for (int b = 0; b < r->f; b++)
        r->T[b * columns + b] = 1;
    for (int a = 0; a < r->i; a++) {
        double *row = r->T + (r->f + a) * columns;
        memcpy(row, r->Psi + a * r->f, (size_t)r->f * sizeof *row);
        memcpy(row + r->f, r->phi + a * r->i, (size_t)r->modes * sizeof *row);
        if (with_missed)
            row[columns - 1] = r->missed[a];
    }
}

/* out (columns, columns) = T' A T */
static void project(const Reduction *r, const double A[], double out[])
{
    const int n = r->f + r->i, columns = r->columns;
    memset(r->half, 0, (size_t)(n * columns) * sizeof *r->half);
    for (int a = 0; a < n; a++)
        for (int b = 0; b < n; b++)
            for (int c = 0; c < columns && A[a * n + b] != 0; c++)
                r->half[a * columns + c] += A[a * n + b] * r->T[b * columns + c];
    for (int a = 0; a < n; a++)
        for (int p = 0; p < columns; p++)
            for (int q = 0; q < columns && r->T[a * columns + p] != 0; q++)
                out[p * columns + q] += r->T[a * columns + p] * r->half[a * columns + q];
}

static Status reduce(Reduction *r, const FrameFull *full, FrameFull *out, Err *err)
{
    TRY(constraint_modes(r, full, err));
    const size_t most = (size_t)(r->f + r->modes + 1);
    out->K = calloc(2 * most * most + most, sizeof *out->K);
    if (!out->K)
        return fail(err, STATUS_NO_MEMORY, "building: no memory for %zu degrees of freedom", most);
    out->M = out->K + most * most;
    out->influence = out->M + most * most;
    memcpy(out->influence, full->influence, (size_t)r->f * sizeof *out->influence);
    const double missed = missed_shape(r, full, out->influence);
    set_columns(r, missed > 0);
    out->n = r->columns;
    if (missed > 0)
        out->influence[out->n - 1] = missed;
    project(r, full->K, out->K);
    project(r, full->M, out->M);
    return STATUS_OK;
}

Status reduction_craig_bampton(const FrameFull *full, int n_floors, long modes, FrameFull *out, Err *err)
{
    Reduction r = {.f = n_floors, .i = full->n - n_floors};
    r.modes = modes < r.i ? (int)modes : r.i;
    *out = (FrameFull){0};
    Status status = allocate(&r, err);
    if (status == STATUS_OK)
        status = reduce(&r, full, out, err);
    free(r.store);
    if (status != STATUS_OK)
        frame_full_free(out);
    return status;
}

/* ---- modes by shape ------------------------------------------------------------------------------------------- */

void reduction_alike(int n, const double phi[], const double M[], int m, const double psi[], int like[])
{
    double M_psi[FLOORS_MAX];
    for (int k = 0; k < m; k++) {
        double most = 0, sum = 0;
        like[k] = -1;
        for (int a = 0; a < n; a++) {
            M_psi[a] = 0;
            for (int b = 0; b < n; b++)
                M_psi[a] += M[a * n + b] * psi[b * m + k];
        }
        for (int i = 0; i < n; i++) {
            double share = 0;
            for (int a = 0; a < n; a++)
                share += phi[a * n + i] * M_psi[a];
            share *= share;
            sum += share;
            if (share > most) {
                most = share;
                like[k] = i;
            }
        }
        if (sum < 0.5)
            like[k] = -1;
    }
}
