#include "scene/core_beam.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/linalg.h"
#include "scene/beam.h"

typedef struct {
    double area, inertia, shear_area; /* [m2], [m4], [m2] 0: no shear deformation */
    double mass_kg;                   /* of the storey; 0: density times area */
} Section;

/* Shear area over area of a thin-walled square tube: Cowper, J. Appl. Mech. 33 (1966) 335-340. */
static double tube_shear_factor(double poisson)
{
    return 20 * (1 + poisson) / (48 + 39 * poisson);
}

static const double PLATE_SHEAR_FACTOR = 5.0 / 6; /* solid rectangle, parabola of shear stress */

static Section section_at(const CoreOptions *o, int n, int storey, double t)
{
    switch (o->section) {
    case CORE_BOX: {
        const double outer = o->width_m, inner = outer - 2 * t;
        const double area = outer * outer - inner * inner;
        return (Section){area, (pow(outer, 4) - pow(inner, 4)) / 12, tube_shear_factor(o->poisson) * area, 0};
    }
    case CORE_PLATE:
        return (Section){o->width_m * t, o->width_m * t * t * t / 12, PLATE_SHEAR_FACTOR * o->width_m * t, 0};
    case CORE_EFFECTIVE:
        break;
    }
    return (Section){list_along(&o->areas_m2, storey, n), list_along(&o->inertias_m4, storey, n),
                     list_along(&o->shear_areas_m2, storey, n),
                     o->masses_kg.n ? list_along(&o->masses_kg, storey, n) : 0};
}

static Beam storey_beam(const CoreOptions *o, const Section *a, double length)
{
    const double E = o->youngs_modulus_pa, G = E / (2 * (1 + o->poisson));
    const int shears = o->theory == CORE_TIMOSHENKO;
    return (Beam){.EI = E * a->inertia,
                  .kGA = shears ? G * a->shear_area : 0,
                  .mass_per_m = a->mass_kg > 0 ? a->mass_kg / length : o->density_kg_m3 * a->area,
                  .rotary_kg_m = shears ? o->density_kg_m3 * a->inertia : 0,
                  .length = length};
}

static Status check(const CoreOptions *o, int n, double t_base_m, double t_top_m, Err *err)
{
    if (o->section != CORE_EFFECTIVE && !(t_base_m > 0 && t_top_m > 0))
        return fail(err, STATUS_BAD_DATA, "core: thickness %g -> %g m must be positive", t_base_m, t_top_m);
    if (o->section == CORE_BOX && !(2 * fmax(t_base_m, t_top_m) <= o->width_m))
        return fail(err, STATUS_BAD_DATA, "core: twice a thickness of %g m does not fit into core.width_m = %g m",
                    fmax(t_base_m, t_top_m), o->width_m);
    const struct {
        const char *key;
        const NumberList *list;
    } lists[] = {{"core.areas_m2", &o->areas_m2},
                 {"core.inertias_m4", &o->inertias_m4},
                 {"core.shear_areas_m2", &o->shear_areas_m2},
                 {"core.masses_kg", &o->masses_kg}};
    for (size_t i = 0; i < sizeof lists / sizeof lists[0] && o->section == CORE_EFFECTIVE; i++)
        if (lists[i].list->n > 2 && lists[i].list->n != n)
            return fail(err, STATUS_BAD_DATA, "%s: has %d values; the building has %d storeys", lists[i].key,
                        lists[i].list->n, n);
    for (int j = 0; j < n && o->section == CORE_EFFECTIVE; j++)
        if ((list_along(&o->shear_areas_m2, j, n) > 0) != (o->shear_areas_m2.at[0] > 0))
            return fail(err, STATUS_BAD_DATA,
                        "core.shear_areas_m2: 0 in one storey and not in another; give all or none");
    return STATUS_OK;
}

Status core_beam_make(CoreBeam *c, const CoreOptions *o, int n, const double storey_m[], double t_base_m,
                      double t_top_m, Err *err)
{
    Beam beam[FLOORS_MAX];
    TRY(check(o, n, t_base_m, t_top_m, err));
    memset(c, 0, sizeof *c);
    c->n = n;
    for (int e = 0; e < n; e++) {
        const double share = n > 1 ? (double)e / (n - 1) : 0;
        const Section section = section_at(o, n, e, t_base_m + (t_top_m - t_base_m) * share);
        beam[e] = storey_beam(o, &section, storey_m[e]);
        c->mass_kg += beam[e].mass_per_m * beam[e].length;
    }
    TRY(beam_cantilever(n, beam, c->K, c->M, err));
    TRY(linalg_modes(n, c->K, c->M, c->omega, c->phi, err));
    linalg_participation(n, c->M, c->phi, c->gamma);
    return STATUS_OK;
}

CoreStorey core_beam_storey(const CoreOptions *o, int n, int storey, double t_base_m, double t_top_m)
{
    const double share = n > 1 ? (double)storey / (n - 1) : 0, t = t_base_m + (t_top_m - t_base_m) * share;
    const double side = o->width_m, inner = side - 2 * t;
    const Section a = section_at(o, n, storey, t);
    CoreStorey c = {.thickness = t, .area = a.area, .inertia = a.inertia};
    if (o->section == CORE_BOX) {
        c.depth = side;
        c.shear_stress_per_n = (side * side * side - inner * inner * inner) / 8 / (a.inertia * 2 * t); /* Q / (I 2t) */
    } else if (o->section == CORE_PLATE) {
        c.depth = t;
        c.shear_stress_per_n = 1.5 / a.area;
    }
    return c;
}

Status core_beam_first_hz(const CoreOptions *o, CoreTheory theory, int n, const double storey_m[], double t_base_m,
                          double t_top_m, double *hz, Err *err)
{
    CoreOptions by_theory = *o;
    by_theory.theory = theory;
    CoreBeam *core = malloc(sizeof *core);
    if (!core)
        return fail(err, STATUS_NO_MEMORY, "core: no memory for %d storeys", n);
    const Status status = core_beam_make(core, &by_theory, n, storey_m, t_base_m, t_top_m, err);
    *hz = status == STATUS_OK ? core->omega[0] / (2 * M_PI) : 0;
    free(core);
    return status;
}

const char *core_theory_word(CoreTheory theory)
{
    static const char *const WORDS[] = {CORE_THEORY_LIST(CHOICE_WORD)};
    return WORDS[theory];
}

void core_beam_join(const CoreBeam *c, const BuildingModel *building, double K[], double M[])
{
    const int m = building->n;
    memcpy(K, building->K, (size_t)(m * m) * sizeof *K);
    memcpy(M, building->M, (size_t)(m * m) * sizeof *M);
    for (int i = 0; i < c->n; i++)
        for (int j = 0; j < c->n; j++) {
            K[i * m + j] += c->K[i * c->n + j];
            M[i * m + j] += c->M[i * c->n + j];
        }
}

Status core_beam_joined_hz(const CoreBeam *c, const Building *b, double hz[], Err *err)
{
    const int m = b->model.n, mm = m * m;
    double *K = malloc((3 * (size_t)mm + (size_t)m) * sizeof *K);
    if (!K)
        return fail(err, STATUS_NO_MEMORY, "modes: no memory for %d degrees of freedom", m);
    double *M = K + mm, *phi = M + mm, *omega = phi + mm;
    core_beam_join(c, &b->model, K, M);
    const Status status = linalg_modes(m, K, M, omega, phi, err);
    for (int i = 0; i < b->n && status == STATUS_OK; i++)
        hz[i] = omega[i] / (2 * M_PI);
    free(K);
    return status;
}
