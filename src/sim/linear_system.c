#include <limits.h>

#include "base/carve.h"
#include "base/linalg.h"
#include "scene/reduction.h"
#include "sim/linear.h"

static void layout(void *system, Carve *c)
{
    LinearSystem *s = system;
    const size_t n = (size_t)s->n, m = (size_t)s->m, losses = (size_t)s->n_loss;
    CARVE(c, s->omega, m);
    CARVE(c, s->gamma, m);
    CARVE(c, s->psi, n * m);
    CARVE(c, s->P, losses * m);
    CARVE(c, s->loss, losses);
    CARVE(c, s->apart, s->n_apart * m);
}

static Status reserve(LinearSystem *s, Err *err)
{
    s->store = carve_all(layout, s);
    return s->store ? STATUS_OK : fail_memory(err, s->n, "floors");
}

void linear_system_free(LinearSystem *s)
{
    free(s->store);
    *s = (LinearSystem){0};
}

/* Losses of the modes of building and core, each by its own damping. */
static void set_modal_losses(LinearSystem *s, const Building *b, const CoreBeam *core)
{
    for (int i = 0; i < s->n_building; i++)
        s->loss[i] = 2 * b->model.zeta[i] * b->model.omega[i];
    for (int i = 0; i < s->n_core; i++)
        s->loss[s->n_building + i] = 2 * core->zeta[i] * core->omega[i];
}

/* -- rigidly connected --------------------------------------------------------------------------------------------- */

/* Rows first .. first+size-1 of P: phi' M Psi, from row-major phi and M (size, size) of the first degrees of freedom;
 * psi (m, m) row-major. */
static void project(LinearSystem *s, int first, int size, const double phi[], const double M[], const double psi[])
{
    const int m = s->m;
    for (int k = 0; k < m; k++)
        for (int l = 0; l < size; l++) {
            double m_psi = 0;
            for (int j = 0; j < size; j++)
                m_psi += M[l * size + j] * psi[j * m + k];
            for (int i = 0; i < size; i++)
                s->P[k * s->n_loss + first + i] += phi[l * size + i] * m_psi;
        }
}

/* Gamma = P' gamma of building and core. */
static void set_rigid_modes(LinearSystem *s, const Building *b, const CoreBeam *core, const double psi[])
{
    const int m = s->m;
    project(s, 0, m, b->model.phi, b->model.M, psi);
    project(s, m, s->n, core->phi, core->M, psi);
    for (int k = 0; k < m; k++) {
        for (int j = 0; j < s->n; j++)
            s->psi[k * s->n + j] = psi[j * m + k];
        for (int i = 0; i < s->n_building + s->n_core; i++) /* behind them stand the losses of both together */
            s->gamma[k] += s->P[k * s->n_loss + i] * (i < m ? b->model.gamma[i] : core->gamma[i - m]);
    }
}

/* The modes of both together have the damping ratios of the building's that they resemble: the sum C + Cc would leave
 * them less than either part has alone, 1.9 % of 3 % in the first mode of the tower under docs/study.md. The core's
 * foundation adds its own. */
static void set_rigid_losses(LinearSystem *s, const Building *b, const CoreBeam *core, const double psi[],
                             const int like[])
{
    const int first = s->n_building + s->n_core;
    for (int k = 0; k < s->m; k++) {
        s->P[k * s->n_loss + first + k] = 1;
        s->loss[first + k] = 2 * b->zeta[like[k] >= 0 ? like[k] : b->n - 1] * s->omega[k] +
                             core_beam_base_loss(core, s->omega[k], psi + k, s->m);
    }
}

static Status make_rigid(LinearSystem *s, const Building *b, const CoreBeam *core, Err *err)
{
    const size_t mm = (size_t)s->m * (size_t)s->m;
    double *K = malloc(3 * mm * sizeof *K);
    int *like = malloc((size_t)s->m * sizeof *like);
    if (!K || !like) {
        free(K);
        free(like);
        return fail_memory(err, s->n, "floors");
    }
    double *M = K + mm, *psi = M + mm;
    building_join_core(core, &b->model, K, M);
    const Status status = linalg_modes(s->m, K, M, s->omega, psi, err);
    if (status == STATUS_OK) {
        set_rigid_modes(s, b, core, psi);
        reduction_alike(b->n, b->phi, b->M, s->m, psi, like);
        set_rigid_losses(s, b, core, psi, like);
    }
    free(K);
    free(like);
    return status;
}

/* -- tuned mass ---------------------------------------------------------------------------------------------------- */

/* In the building's modes q and sqrt(m_t) x_t: the identity as mass, diag(w^2, 0) + k_t r r' as stiffness, r q the
 * distance between roof and mass. */
static void tmd_stiffness(const LinearSystem *s, const Building *b, double mass, double k_t, double r[], double K[])
{
    const int nb = s->n_building, m = s->m;
    for (int i = 0; i < nb; i++)
        r[i] = b->model.phi[(s->n - 1) * b->model.n + i];
    r[nb] = -1 / sqrt(mass);
    for (int i = 0; i < m; i++)
        for (int j = 0; j < m; j++)
            K[i * m + j] = k_t * r[i] * r[j] + (i == j && i < nb ? b->model.omega[i] * b->model.omega[i] : 0);
}

/* Everything in the modes Q (m, m, row-major, column per mode) of that. */
static void set_tmd_modes(LinearSystem *s, const Building *b, double mass, const double r[], const double Q[])
{
    const int nb = s->n_building, n = s->n, m = s->m;
    for (int k = 0; k < m; k++) {
        s->gamma[k] = sqrt(mass) * Q[nb * m + k];
        for (int i = 0; i < m; i++)
            s->apart[k] += r[i] * Q[i * m + k];
        for (int i = 0; i < nb; i++) {
            s->gamma[k] += b->model.gamma[i] * Q[i * m + k];
            s->P[k * s->n_loss + i] = Q[i * m + k];
            for (int j = 0; j < n; j++)
                s->psi[k * n + j] += b->model.phi[j * b->model.n + i] * Q[i * m + k];
        }
        s->P[k * s->n_loss + nb] = s->apart[k];
    }
}

static Status make_tmd(LinearSystem *s, const Building *b, double mass, const LinearDevice *d, Err *err)
{
    const size_t m = (size_t)s->m;
    const double w_t = 2 * M_PI * d->tmd_hz;
    double *K;
    TRY_ROOM(K, 3 * m * m + m, "numbers of modes", err);
    double *M = K + m * m, *Q = M + m * m, *r = Q + m * m;
    for (size_t i = 0; i < m; i++)
        M[i * m + i] = 1;
    tmd_stiffness(s, b, mass, mass * w_t * w_t, r, K);
    const Status status = linalg_modes((int)m, K, M, s->omega, Q, err);
    if (status == STATUS_OK)
        set_tmd_modes(s, b, mass, r, Q);
    s->loss[s->n_building] = 2 * d->tmd_damping * mass * w_t;
    free(K);
    return status;
}

/* -- links --------------------------------------------------------------------------------------------------------- */

/* The coordinates are the modes of both; dashpots alone join them. */
static void make_links(LinearSystem *s, const Building *b, const CoreBeam *core, const LinearDevice *d)
{
    const int nb = s->n_building, n = s->n;
    for (int k = 0; k < s->m; k++) {
        const int i = k < nb ? k : k - nb;
        s->omega[k] = k < nb ? b->model.omega[i] : core->omega[i];
        s->gamma[k] = k < nb ? b->model.gamma[i] : core->gamma[i];
        s->P[k * s->n_loss + k] = 1;
        for (int j = 0; j < n; j++) {
            s->psi[k * n + j] = k < nb ? b->model.phi[j * b->model.n + i] : 0;
            if (j < core->top)
                s->apart[k * n + j] = k < nb ? b->model.phi[j * b->model.n + i] : -core->phi[j * n + i];
            s->P[k * s->n_loss + s->m + j] = s->apart[k * n + j];
        }
    }
    for (int j = 0; j < n; j++)
        s->loss[s->m + j] = d->link_ns_m;
}

Status linear_system_make(LinearSystem *s, LinearKind kind, const Building *b, const CoreBeam *core,
                          const LinearDevice *device, int n_modes, Err *err)
{
    const int n = b->n, all = kind == LINEAR_RIGID ? INT_MAX : n_modes;
    *s = (LinearSystem){.n = n,
                        .n_building = all < b->model.n ? all : b->model.n,
                        .n_core = kind == LINEAR_TMD ? 0
                                  : all < n          ? all
                                                     : n};
    s->like = b->model.like;
    s->n_apart = kind == LINEAR_RIGID ? 0 : kind == LINEAR_TMD ? 1 : n;
    s->m = s->n_building + (kind == LINEAR_TMD ? 1 : kind == LINEAR_LINKS ? s->n_core : 0);
    s->n_loss = s->n_building + s->n_core + (kind == LINEAR_RIGID ? s->m : s->n_apart);
    TRY(reserve(s, err));
    if (kind != LINEAR_RIGID)
        set_modal_losses(s, b, core);
    Status status = STATUS_OK;
    if (kind == LINEAR_RIGID)
        status = make_rigid(s, b, core, err);
    else if (kind == LINEAR_TMD)
        status = make_tmd(s, b, core->mass_kg, device, err);
    else
        make_links(s, b, core, device);
    if (status != STATUS_OK)
        linear_system_free(s);
    return status;
}
