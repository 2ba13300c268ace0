#include "scene/neighbour.h"

#include "base/list.h"

int neighbour_is_given(const CoreOptions *o)
{
    return list_is_given(o->model);
}

CoreSection core_section(const CoreOptions *o)
{
    return neighbour_is_given(o) ? CORE_EFFECTIVE : o->section;
}

const char *core_word(const CoreOptions *o)
{
    return neighbour_is_given(o) ? o->model : core_theory_word(o->theory);
}

/* Refuses a neighbour whose floors do not meet those of the building. */
static Status check_floors(const Building *n, const Building *b, const char *model, Err *err)
{
    double z = 0, own = 0;
    if (n->n > b->n)
        return bad_data(
            err,
            "core.model: %s has %d floors, the building %d: make the taller one building.model and the other "
            "core.model",
            model, n->n, b->n);
    if (n->yields)
        return bad_data(err, "core.model: %s has storeys that yield; only those of building.model may", model);
    for (int j = 0; j < n->n; j++) {
        z += b->storey_m[j];
        own += n->storey_m[j];
        if (fabs(z - own) > LEVELS_M)
            return bad_data(err,
                            "core.model: floor %d of %s is at %.3g m, that of the building at %.3g m; floors that meet "
                            "are at one height within %g m",
                            j + 1, model, own, z, LEVELS_M);
    }
    return STATUS_OK;
}

Status core_make(CoreBeam *c, const CoreOptions *o, const BuildingOptions *of, const Building *b, double t_base_m,
                 double t_top_m, Err *err)
{
    if (!neighbour_is_given(o))
        return core_beam_make(c, o, b->n, b->storey_m, t_base_m, t_top_m, err);
    Building n;
    BuildingOptions options = *of;
    memcpy(options.model, o->model, sizeof options.model);
    options.modes = 0;
    options.yield_drift = 0;
    TRY(building_load(&n, &options, err));
    const Status status = check_floors(&n, b, o->model, err);
    memset(c, 0, sizeof *c);
    c->n = b->n;
    c->top = n.n;
    c->mass_kg = building_mass(&n);
    memcpy(c->storey_m, n.storey_m, n.n * sizeof *c->storey_m);
    for (int i = 0; i < b->n && status == STATUS_OK; i++) {
        const int own = i < n.n;
        c->omega[i] = n.omega[own ? i : n.n - 1];
        c->zeta[i] = o->damping;
        c->gamma[i] = own ? n.gamma[i] : 0;
        for (int j = 0; own && j < n.n; j++) {
            c->K[i * b->n + j] = n.K[i * n.n + j];
            c->M[i * b->n + j] = n.M[i * n.n + j];
            c->phi[i * b->n + j] = n.phi[i * n.n + j];
        }
    }
    building_free(&n);
    return status;
}
