#include "sim/as_built.h"

int is_uncertain(const UncertainOptions *u)
{
    return u->restitution + u->contact_stiffness + u->core_stiffness + u->building_stiffness + u->damping +
               u->ground_stiffness + u->strength >
           0;
}

void as_built_options(const AsBuilt *built, const SceneOptions *o, SceneOptions *out)
{
    *out = *o;
    if (built->restitution != 0)
        out->contact.restitution = fmin(fmax(o->contact.restitution + built->restitution, 0.05), 1);
    out->contact.youngs_modulus_pa *= built->contact_stiffness;
    out->contact.bumper_stiffness_n_m *= built->contact_stiffness;
    out->core.youngs_modulus_pa *= built->core_stiffness;
    out->core.foundation_factor *= built->ground_stiffness;
    out->core.damping *= built->core_damping;
}

static double *scaled(size_t n, const double from[], double factor, double **store)
{
    double *to = *store;
    for (size_t i = 0; i < n; i++)
        to[i] = factor * from[i];
    *store += n;
    return to;
}

Status as_built_building(const AsBuilt *built, const Building *b, Building *out, double **store, Err *err)
{
    const size_t n = (size_t)b->n, m = (size_t)b->model.n;
    const double stiffness = built->building_stiffness, damping = built->building_damping;
    if (!*store)
        TRY_ROOM(*store, n * n + 4 * n + m * m + 2 * m, "numbers of a building", err);
    double *at = *store;
    *out = *b;
    out->K = scaled(n * n, b->K, stiffness, &at);
    out->omega = scaled(n, b->omega, sqrt(stiffness), &at);
    out->zeta = scaled(n, b->zeta, damping, &at);
    out->yield_m = scaled(n, b->yield_m, built->strength, &at);
    out->yield_n_m = scaled(n, b->yield_n_m, stiffness, &at);
    out->model.K = scaled(m * m, b->model.K, stiffness, &at);
    out->model.omega = scaled(m, b->model.omega, sqrt(stiffness), &at);
    out->model.zeta = scaled(m, b->model.zeta, damping, &at);
    return STATUS_OK;
}
