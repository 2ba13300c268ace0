#include "scene/core_beam.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/linalg.h"
#include "base/list.h"
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

static Section section_at(const CoreOptions *o, double share, double t)
{
    switch (o->section) {
    case CORE_BOX: {
        const double outer = o->side_m, inner = outer - 2 * t;
        const double area = outer * outer - inner * inner;
        return (Section){area, (pow(outer, 4) - pow(inner, 4)) / 12, tube_shear_factor(o->poisson) * area, 0};
    }
    case CORE_PLATE:
        return (Section){o->width_m * t, o->width_m * t * t * t / 12, PLATE_SHEAR_FACTOR * o->width_m * t, 0};
    case CORE_EFFECTIVE:
        break;
    }
    return (Section){o->area_base_m2 + (o->area_top_m2 - o->area_base_m2) * share,
                     o->inertia_base_m4 + (o->inertia_top_m4 - o->inertia_base_m4) * share,
                     o->shear_area_base_m2 + (o->shear_area_top_m2 - o->shear_area_base_m2) * share, 0};
}

/* Value `storey` of a list of n, where there is one. */
static Status take_listed(const char *list, int n, int storey, const char *key, double *value, Err *err)
{
    if (!list_is_given(list))
        return STATUS_OK;
    if (list_count(list) != (size_t)n)
        return fail(err, STATUS_BAD_DATA, "%s: has %zu values; the building has %d storeys", key, list_count(list), n);
    return list_positive(list, (size_t)storey, key, value, err);
}

/* What an effective section has storey by storey. */
static Status take_lists(const CoreOptions *o, int n, int storey, Section *a, Err *err)
{
    if (o->section != CORE_EFFECTIVE)
        return STATUS_OK;
    TRY(take_listed(o->areas_m2, n, storey, "core.areas_m2", &a->area, err));
    TRY(take_listed(o->inertias_m4, n, storey, "core.inertias_m4", &a->inertia, err));
    return take_listed(o->masses_kg, n, storey, "core.masses_kg", &a->mass_kg, err);
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

static Status check(const CoreOptions *o, double t_base_m, double t_top_m, Err *err)
{
    if (o->section != CORE_EFFECTIVE && !(t_base_m > 0 && t_top_m > 0))
        return fail(err, STATUS_BAD_DATA, "core: thickness %g -> %g m must be positive", t_base_m, t_top_m);
    if (o->section == CORE_BOX && !(2 * fmax(t_base_m, t_top_m) <= o->side_m))
        return fail(err, STATUS_BAD_DATA, "core: twice a thickness of %g m does not fit into core.side_m = %g m",
                    fmax(t_base_m, t_top_m), o->side_m);
    if (o->section == CORE_EFFECTIVE && (o->shear_area_base_m2 > 0) != (o->shear_area_top_m2 > 0))
        return fail(err, STATUS_BAD_DATA, "core.shear_area_base_m2 is %g, core.shear_area_top_m2 %g: give both or none",
                    o->shear_area_base_m2, o->shear_area_top_m2);
    return STATUS_OK;
}

Status core_beam_make(CoreBeam *c, const CoreOptions *o, int n, const double storey_m[], double t_base_m,
                      double t_top_m, Err *err)
{
    Beam beam[FLOORS_MAX];
    TRY(check(o, t_base_m, t_top_m, err));
    memset(c, 0, sizeof *c);
    c->n = n;
    for (int e = 0; e < n; e++) {
        const double share = n > 1 ? (double)e / (n - 1) : 0;
        Section section = section_at(o, share, t_base_m + (t_top_m - t_base_m) * share);
        TRY(take_lists(o, n, e, &section, err));
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
    const double side = o->side_m, inner = side - 2 * t;
    const Section a = section_at(o, share, t);
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
