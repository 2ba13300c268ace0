#include "bench/engines/implicit.h"

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

int dense_solve(int n, double J[], double b[])
{
    for (int k = 0; k < n; k++) {
        int pivot = k;
        for (int i = k + 1; i < n; i++)
            if (fabs(J[i * n + k]) > fabs(J[pivot * n + k]))
                pivot = i;
        if (!(fabs(J[pivot * n + k]) > 0))
            return 0;
        for (int j = 0; j < n && pivot != k; j++) {
            const double t = J[k * n + j];
            J[k * n + j] = J[pivot * n + j];
            J[pivot * n + j] = t;
        }
        const double t = b[k];
        b[k] = b[pivot];
        b[pivot] = t;
        for (int i = k + 1; i < n; i++) {
            const double factor = J[i * n + k] / J[k * n + k];
            for (int j = k + 1; j < n; j++)
                J[i * n + j] -= factor * J[k * n + j];
            b[i] -= factor * b[k];
        }
    }
    for (int k = n - 1; k >= 0; k--) {
        for (int j = k + 1; j < n; j++)
            b[k] -= J[k * n + j] * b[j];
        b[k] /= J[k * n + k];
    }
    return 1;
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
        if (!dense_solve(n, x->jacobian, x->rhs))
            return 0;
        for (int a = 0; a < n; a++)
            x->f[x->in_contact[a]] += x->rhs[a];
    }
    return 0;
}
