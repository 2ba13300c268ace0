#include "sim/joined.h"

#include "base/linalg.h"
#include "sim/energy_balance.h"

static void layout(void *joined, Carve *c)
{
    Joined *j = joined;
    building_model_layout(&j->building.model, c);
    CARVE(c, j->P, (size_t)((j->m + j->n) * j->m));
}

/* Rows first.. of P: phi' M psi, of the first `size` degrees of freedom, the core's where it touches; gamma = P' (that
 * of the part). */
static void project(Joined *j, int first, int size, const double phi[], const double M[], const double gamma[])
{
    const BuildingModel *both = &j->building.model;
    const int m = j->m;
    for (int l = 0; l < size; l++)
        for (int k = 0; k < m; k++) {
            double m_psi = 0;
            for (int i = 0; i < size; i++)
                m_psi +=
                    M[l * size + i] * (first ? building_shape(both, i, both->arm_contact, k) : both->phi[i * m + k]);
            for (int i = 0; i < size; i++)
                j->P[(first + i) * m + k] += phi[l * size + i] * m_psi;
        }
    for (int i = 0; i < size; i++)
        for (int k = 0; k < m; k++)
            both->gamma[k] += j->P[(first + i) * m + k] * gamma[i];
}

Status joined_make(Joined *j, const Building *b, const CoreBeam *core, Err *err)
{
    *j = (Joined){.building = *b, .like = b->model.like, .n = core->n, .m = b->model.n};
    j->store = carve_all(layout, j);
    if (!j->store)
        return fail_memory(err, b->n, "floors");
    BuildingModel *both = &j->building.model;
    building_join_core(core, &b->model, both->K, both->M);
    TRY(linalg_modes(j->m, both->K, both->M, both->omega, both->phi, err));
    project(j, 0, j->m, b->model.phi, b->model.M, b->model.gamma);
    project(j, j->m, j->n, core->phi, core->M, core->gamma);
    building_alike(b->n, b->phi, b->M, both, both->like);
    j->shares = both->turns_at && j->m < FLOORS_MAX ? j->m : b->n;
    for (int k = 0; k < j->m; k++) {
        double nodes[FLOORS_MAX];
        for (int i = 0; i < j->n; i++)
            nodes[i] = building_shape(both, i, both->arm_contact, k);
        both->zeta[k] = b->zeta[both->like[k] >= 0 ? both->like[k] : b->n - 1] +
                        core_beam_base_loss(core, both->omega[k], nodes, 1) / (2 * both->omega[k]);
        both->like[k] = k < j->shares ? k : -1;
    }
    return STATUS_OK;
}

void joined_free(Joined *j)
{
    free(j->store);
    *j = (Joined){0};
}

void joined_book(const Joined *j, SimResult *r)
{
    double share[FLOORS_MAX];
    memcpy(share, r->mode_share_pct, sizeof share);
    memset(r->mode_share_pct, 0, sizeof share);
    r->ed1_pct = r->ed5_10_pct = r->edcs_pct = 0;
    for (int i = 0; i < j->m + j->n; i++)
        for (int k = 0; k < j->shares; k++) {
            const double booked = pow(j->P[i * j->m + k], 2) * share[k];
            if (i >= j->m)
                r->edcs_pct += booked;
            else if (j->like[i] >= 0)
                r->mode_share_pct[j->like[i]] += booked;
        }
    energy_balance_sum_shares(r);
    r->damped_core_j = r->input_energy_j > 0 ? r->edcs_pct / 100 * r->input_energy_j : 0;
    r->damped_building_j -= r->damped_core_j;
}
