#include "scene/reduction.h"

#include "base/carve.h"
#include "base/linalg.h"
#include "scene/options.h"

/* ---- Craig-Bampton -------------------------------------------------------------------------------------------- */

typedef struct {
    int n, f, i, modes;         /* floors, others, fixed-interface modes that are kept */
    double *Kii, *Mii, *factor; /* (i, i) */
    double *Psi;                /* (i, f) */
    double *mu, *phi;           /* (i), (i, i) column k is mode k */
    double *missed, *M_r;       /* (i) the shape that is added, Mii times it */
    double *T, *work;           /* (n, n + 1) of which as many columns are used as shapes are kept */
} Reduction;

/* Names every array, for base/carve.h. */
static void layout(void *reduction, Carve *c)
{
    Reduction *r = reduction;
    const size_t n = r->n, i = r->i;
    CARVE(c, r->Kii, i * i);
    CARVE(c, r->Mii, i * i);
    CARVE(c, r->factor, i * i);
    CARVE(c, r->phi, i * i);
    CARVE(c, r->Psi, i * r->f);
    CARVE(c, r->mu, i);
    CARVE(c, r->missed, i);
    CARVE(c, r->M_r, i);
    CARVE(c, r->T, n * (n + 1));
    CARVE(c, r->work, n * (n + 1));
}

/* Mii missed, and missed' Mii missed. */
static double weigh_missed(const Reduction *r)
{
    double square = 0;
    for (int a = 0; a < r->i; a++) {
        r->M_r[a] = 0;
        for (int b = 0; b < r->i; b++)
            r->M_r[a] += r->Mii[a * r->i + b] * r->missed[b];
        square += r->missed[a] * r->M_r[a];
    }
    return square;
}

/* Below this share of its mass the missed shape is rounding. */
static const double MISSED_MIN = 1e-12;

/* Fills out with the matrices in the columns of T, and with the coordinates of the ground's motion in them. */
static Status reduce(Reduction *r, const FrameFull *full, FrameFull *out, Err *err)
{
    TRY(frame_full_make(out, r->f + r->modes + 1, err));
    double *influence = out->influence;

    /* Constraint modes Psi, and the fixed-interface modes phi. */
    for (int a = 0; a < r->i; a++) {
        const double *K = full->K + (r->f + a) * r->n, *M = full->M + (r->f + a) * r->n;
        for (int b = 0; b < r->f; b++)
            r->Psi[a * r->f + b] = -K[b];
        memcpy(r->Kii + a * r->i, K + r->f, r->i * sizeof *K);
        memcpy(r->factor + a * r->i, K + r->f, r->i * sizeof *K);
        memcpy(r->Mii + a * r->i, M + r->f, r->i * sizeof *M);
    }
    TRY(linalg_solve_spd(r->i, r->f, r->factor, r->Psi, err));
    TRY(linalg_modes(r->i, r->Kii, r->Mii, r->mu, r->phi, err));

    /* r is 1 of the floors and c of the modes; what is left, normalised, is one shape more. */
    memcpy(influence, full->influence, r->f * sizeof *influence);
    for (int a = 0; a < r->i; a++) {
        r->missed[a] = full->influence[r->f + a];
        for (int b = 0; b < r->f; b++)
            r->missed[a] -= r->Psi[a * r->f + b] * influence[b];
    }
    const double whole = weigh_missed(r);
    for (int k = 0; k < r->modes; k++) {
        double *c = &influence[r->f + k];
        for (int a = 0; a < r->i; a++)
            *c += r->phi[a * r->i + k] * r->M_r[a];
        for (int a = 0; a < r->i; a++)
            r->missed[a] -= *c * r->phi[a * r->i + k];
    }
    const double square = weigh_missed(r);
    const int is_missed = r->modes < r->i && square > MISSED_MIN * whole, n = out->n = r->f + r->modes + is_missed;
    if (is_missed)
        influence[n - 1] = sqrt(square);

    /* The columns of T. */
    for (int b = 0; b < r->f; b++)
        r->T[b * n + b] = 1;
    for (int a = 0; a < r->i; a++) {
        double *row = r->T + (r->f + a) * n;
        memcpy(row, r->Psi + a * r->f, r->f * sizeof *row);
        memcpy(row + r->f, r->phi + a * r->i, r->modes * sizeof *row);
        if (is_missed)
            row[n - 1] = r->missed[a] / sqrt(square);
    }
    linalg_congruent(r->n, n, full->K, r->T, r->work, out->K);
    linalg_congruent(r->n, n, full->M, r->T, r->work, out->M);
    return STATUS_OK;
}

Status reduction_craig_bampton(const FrameFull *full, int n_floors, long modes, FrameFull *out, Err *err)
{
    Reduction r = {.n = full->n, .f = n_floors, .i = full->n - n_floors};
    r.modes = modes < r.i ? (int)modes : r.i;
    *out = (FrameFull){0};
    void *store = carve_all(layout, &r);
    const Status status = store
                              ? reduce(&r, full, out, err)
                              : fail(err, STATUS_NO_MEMORY, "building: no memory to reduce %d degrees of freedom", r.n);
    free(store);
    if (status != STATUS_OK)
        frame_full_free(out);
    return status;
}
