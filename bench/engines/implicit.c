#include "bench/engines/implicit.h"

#include <lapacke.h>
#include <math.h>
#include <string.h>

#include "base/carve.h"
#include "base/clones.h"

enum { ITERATIONS_MAX = 60 };

/* Of the largest force. */
static const double FORCE_TOLERANCE = 1e-11;

static void layout(void *implicit, Carve *c)
{
    Implicit *x = implicit;
    const size_t N = (size_t)x->N, real = sizeof(double);
    x->A = carve(c, N * N, real);
    x->B = carve(c, N * N, real);
    x->jacobian = carve(c, N * N, real);
    x->w_free = carve(c, N, real);
    x->wd_free = carve(c, N, real);
    x->f = carve(c, N, real);
    x->w = carve(c, N, real);
    x->wd = carve(c, N, real);
    x->rhs = carve(c, N, real);
    x->in_contact = carve(c, N, sizeof(int));
    x->pivot = carve(c, N, sizeof *x->pivot);
}

Status implicit_create(Implicit *x, int n, int stages, Err *err)
{
    memset(x, 0, sizeof *x);
    x->n = n;
    x->N = stages * n;
    x->store = carve_all(layout, x);
    return x->store ? STATUS_OK : fail(err, STATUS_NO_MEMORY, "implicit step: no memory for %d unknowns", x->N);
}

void implicit_free(Implicit *x)
{
    free(x->store);
    memset(x, 0, sizeof *x);
}

CLONED static void motion_under_forces(Implicit *x)
{
    const int N = x->N;
    memcpy(x->w, x->w_free, sizeof *x->w * (size_t)N);
    memcpy(x->wd, x->wd_free, sizeof *x->wd * (size_t)N);
    for (int l = 0; l < N; l++) {
        if (x->f[l] == 0)
            continue;
        for (int k = 0; k < N; k++) {
            x->w[k] += x->A[l * N + k] * x->f[l];
            x->wd[k] += x->B[l * N + k] * x->f[l];
        }
    }
}

/* Residual f + s F of every point in contact or still with a force, its derivatives, and the largest of both. */
static int linearise(Implicit *x, const Contacts *c, double *worst, double *largest)
{
    const SimModel *model = c->model;
    ContactForce law[3 * FLOORS_MAX];
    int n = 0;
    *worst = *largest = 0;
    for (int k = 0; k < x->N; k++) {
        const int j = k % x->n, s = x->w[k] > 0 ? 1 : -1;
        const double p = fabs(x->w[k]) - model->gap[j];
        if (!(p > 0) && x->f[k] == 0)
            continue;
        law[n] = (ContactForce){0};
        if (p > 0) {
            law[n] = contact_force(&model->contact[j], model->mass_eff[j], p, s * x->wd[k], contacts_speed(c, j, s));
            x->evaluations++;
        }
        x->rhs[n] = -(x->f[k] + s * law[n].force);
        *worst = fmax(*worst, fabs(x->rhs[n]));
        *largest = fmax(*largest, fmax(fabs(x->f[k]), law[n].force));
        x->in_contact[n++] = k;
    }
    for (int a = 0; a < n; a++)
        for (int b = 0; b < n; b++) {
            const size_t at = (size_t)x->in_contact[b] * (size_t)x->N + (size_t)x->in_contact[a];
            x->jacobian[a * n + b] = (a == b) + law[a].dp * x->A[at] + law[a].dv * x->B[at];
        }
    return n;
}

int implicit_solve(Implicit *x, const Contacts *c)
{
    double worst, largest;
    for (int iteration = 0; iteration < ITERATIONS_MAX; iteration++) {
        motion_under_forces(x);
        const int n = linearise(x, c, &worst, &largest);
        if (!isfinite(worst))
            return 0;
        if (worst <= FORCE_TOLERANCE * largest)
            return 1;
        if (LAPACKE_dgesv(LAPACK_ROW_MAJOR, n, 1, x->jacobian, n, x->pivot, x->rhs, 1) != 0)
            return 0;
        for (int a = 0; a < n; a++)
            x->f[x->in_contact[a]] += x->rhs[a];
    }
    return 0;
}
