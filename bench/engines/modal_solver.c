#include "bench/engines/modal_solver.h"

#include <string.h>

#include "base/clones.h"
#include "bench/engines/implicit.h"

static SUNLinearSolver_Type get_type(SUNLinearSolver s)
{
    (void)s;
    return SUNLINEARSOLVER_MATRIX_EMBEDDED;
}

/* x = D^-1 b, the modes alone. */
CLONED static void solve_modes(const SimModel *model, double g, const double b[], double x[])
{
    const int m = model->m;
    const double *bv = b + m;
    double *xv = x + m;
#pragma GCC ivdep
    for (int i = 0; i < m; i++) {
        const double w = model->omega[i], damping = 1 + 2 * g * model->zeta[i] * w, det = damping + g * g * w * w;
        const double q = b[i], v = bv[i];
        x[i] = (damping * q + g * v) / det;
        xv[i] = (v - g * w * w * q) / det;
    }
}

/* Floors in contact at state y and their stiffnesses, times gamma. */
static int find_contacts(const Ode *o, double g, const double y[], int floor[], double dp[], double dv[])
{
    const SimModel *model = o->model;
    int n = 0;
    for (int j = 0; j < model->n && model->nc > 0; j++) {
        const int s = o->contacts.side[j];
        if (!s)
            continue;
        const double p = s * relative_displacement(model, j, y) - model->gap[j];
        if (!(p > 0))
            continue;
        const double p_dot = s * relative_displacement(model, j, y + model->m);
        const ContactForce f = contact_force(&model->contact[j], model->mass_eff[j], p, p_dot, o->contacts.v0[j]);
        floor[n] = j;
        dp[n] = g * f.dp;
        dv[n++] = g * f.dv;
    }
    return n;
}

/* Takes sum_j D^-1 (0, R_j) phi_j off x. */
static int subtract_contacts(const Ode *o, double g, const double y[], double x[])
{
    const SimModel *model = o->model;
    const int m = model->m;
    int floor[FLOORS_MAX];
    double dp[FLOORS_MAX], dv[FLOORS_MAX], load[2 * MODES_MAX], answer[FLOORS_MAX][2 * MODES_MAX];
    double matrix[FLOORS_MAX * FLOORS_MAX], phi[FLOORS_MAX];
    const int n = find_contacts(o, g, y, floor, dp, dv);
    for (int b = 0; b < n; b++) {
        memset(load, 0, sizeof *load * (size_t)m);
        memcpy(load + m, model->RT + (size_t)floor[b] * (size_t)model->m_pad, sizeof *load * (size_t)m);
        solve_modes(model, g, load, answer[b]);
    }
    for (int a = 0; a < n; a++) {
        phi[a] =
            dp[a] * relative_displacement(model, floor[a], x) + dv[a] * relative_displacement(model, floor[a], x + m);
        for (int b = 0; b < n; b++)
            matrix[a * n + b] = (a == b) + dp[a] * relative_displacement(model, floor[a], answer[b]) +
                                dv[a] * relative_displacement(model, floor[a], answer[b] + m);
    }
    if (!dense_solve(n, matrix, phi))
        return SUNLS_LUFACT_FAIL;
    for (int b = 0; b < n; b++)
        for (int i = 0; i < 2 * m; i++)
            x[i] -= phi[b] * answer[b][i];
    return 0;
}

static int solve(SUNLinearSolver s, SUNMatrix unused, N_Vector x, N_Vector b, sunrealtype tolerance)
{
    (void)unused;
    (void)tolerance;
    const ModalSolver *self = s->content;
    double gamma;
    N_Vector y;
    if (self->current(self->ode->memory, &gamma, &y))
        return SUNLS_PACKAGE_FAIL_UNREC;
    solve_modes(self->ode->model, gamma, ode_values(b), ode_values(x));
    return self->with_contacts ? subtract_contacts(self->ode, gamma, ode_values(y), ode_values(x)) : 0;
}

static int release(SUNLinearSolver s)
{
    s->content = NULL;
    SUNLinSolFreeEmpty(s);
    return 0;
}

SUNLinearSolver modal_solver_create(ModalSolver *self, const Ode *ode, int with_contacts,
                                    int (*current)(void *memory, double *gamma, N_Vector *y))
{
    SUNLinearSolver s = SUNLinSolNewEmpty(ode->context);
    if (!s)
        return NULL;
    *self = (ModalSolver){ode, with_contacts, current};
    s->content = self;
    s->ops->gettype = get_type;
    s->ops->solve = solve;
    s->ops->free = release;
    return s;
}
