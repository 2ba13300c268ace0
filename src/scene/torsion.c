#include "scene/torsion.h"

/* [-] b/l of the tower that is built in, 36.58 by 30.48 m. */
static const double ASPECT = 1.2;

Status torsion_add(Building *b, const NumberList *eccentricity, Err *err)
{
    const double share = eccentricity->n > 0 ? eccentricity->at[0] : 0;
    const double aspect = eccentricity->n > 1 ? eccentricity->at[1] : ASPECT;
    if (share == 0)
        return STATUS_OK;
    const double radius = sqrt((1 + aspect * aspect) / 12); /* over l */
    if (eccentricity->n > 2)
        return bad_data(err,
                        "contact.eccentricity: %d numbers; give the share of the side along the motion, and behind "
                        "it at most the side across over that one",
                        eccentricity->n);
    if (!(share <= 0.5 * aspect))
        return bad_data(err, "contact.eccentricity: %g is more than %g, half of the side across the motion", share,
                        0.5 * aspect);
    const BuildingModel from = b->model;
    const int n = from.n;
    BuildingModel *m = &b->model;
    *m = (BuildingModel){.n = 2 * n, .turns_at = n, .arm_contact = share / radius, .arm_edge = 0.5 * aspect / radius};
    void *store = carve_all(building_model_layout, m);
    if (!store) {
        *m = from;
        return fail_memory(err, 2 * n, "degrees of freedom");
    }
    for (int i = 0; i < 2 * n; i++) {
        const int j = i % n, at = 2 * n * i + (i < n ? 0 : n);
        memcpy(m->K + at, from.K + j * n, n * sizeof *m->K);
        memcpy(m->M + at, from.M + j * n, n * sizeof *m->M);
        memcpy(m->phi + at, from.phi + j * n, n * sizeof *m->phi);
        m->omega[i] = from.omega[j];
        m->zeta[i] = from.zeta[j];
        m->like[i] = from.like[j];
        m->gamma[i] = i < n ? from.gamma[j] : 0;
    }
    free(b->model_store);
    b->model_store = store;
    return STATUS_OK;
}
