#include "scene/core_beam.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/linalg.h"
#include "scene/beam.h"

typedef struct {
    double area, inertia, shear_area; /* [m2], [m4], [m2] 0: no shear deformation */
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
        return (Section){area, (pow(outer, 4) - pow(inner, 4)) / 12, tube_shear_factor(o->poisson) * area};
    }
    case CORE_PLATE:
        return (Section){o->width_m * t, o->width_m * t * t * t / 12, PLATE_SHEAR_FACTOR * o->width_m * t};
    case CORE_EFFECTIVE:
        break;
    }
    return (Section){o->area_base_m2 + (o->area_top_m2 - o->area_base_m2) * share,
                     o->inertia_base_m4 + (o->inertia_top_m4 - o->inertia_base_m4) * share,
                     o->shear_area_base_m2 + (o->shear_area_top_m2 - o->shear_area_base_m2) * share};
}

static Beam storey_beam(const CoreOptions *o, const Section *a, double length)
{
    const double E = o->youngs_modulus_pa, G = E / (2 * (1 + o->poisson));
    const int shears = o->theory == CORE_TIMOSHENKO;
    return (Beam){.EI = E * a->inertia,
                  .kGA = shears ? G * a->shear_area : 0,
                  .mass_per_m = o->density_kg_m3 * a->area,
                  .rotary_kg_m = shears ? o->density_kg_m3 * a->inertia : 0,
                  .length = length};
}

/* Unknowns: deflections 0..n-1, then rotations n..2n-1; node 0 of the beam is clamped. Returns the total mass. */
static double assemble(const CoreOptions *o, const BuildingOptions *b, int n, double t_base, double t_top, double K[],
                       double M[])
{
    const int size = 2 * n;
    double mass = 0;
    for (int e = 0; e < n; e++) {
        const double share = n > 1 ? (double)e / (n - 1) : 0;
        const double l = e == 0 ? b->first_storey_m : b->storey_m;
        const Section a = section_at(o, share, t_base + (t_top - t_base) * share);
        const Beam beam = storey_beam(o, &a, l);
        double k[4][4], m[4][4];
        beam_element(&beam, k, m);
        const int at[4] = {e - 1, e == 0 ? -1 : n + e - 1, e, n + e};
        for (int i = 0; i < 4; i++)
            for (int j = 0; j < 4; j++)
                if (at[i] >= 0 && at[j] >= 0) {
                    K[at[i] * size + at[j]] += k[i][j];
                    M[at[i] * size + at[j]] += m[i][j];
                }
        mass += beam.mass_per_m * l;
    }
    return mass;
}

/* out (n, n) = T' A T with T = [1; R], A (2n, 2n), R (n, n). */
static void condense(int n, const double A[], const double R[], double work[], double out[])
{
    const int size = 2 * n;
    for (int i = 0; i < size; i++) /* work (2n, n) = A T */
        for (int j = 0; j < n; j++) {
            double sum = A[i * size + j];
            for (int k = 0; k < n; k++)
                sum += A[i * size + n + k] * R[k * n + j];
            work[i * n + j] = sum;
        }
    for (int i = 0; i < n; i++)
        for (int j = 0; j < n; j++) {
            double sum = work[i * n + j];
            for (int k = 0; k < n; k++)
                sum += R[k * n + i] * work[(n + k) * n + j];
            out[i * n + j] = sum;
        }
    for (int i = 0; i < n; i++) /* symmetric but for rounding */
        for (int j = 0; j < i; j++)
            out[i * n + j] = out[j * n + i] = 0.5 * (out[i * n + j] + out[j * n + i]);
}

static Status remove_rotations(CoreBeam *c, const double K[], const double M[], double store[], Err *err)
{
    const int n = c->n, size = 2 * n;
    double *Krr = store, *R = Krr + n * n, *work = R + n * n;
    for (int i = 0; i < n; i++)
        for (int j = 0; j < n; j++) {
            Krr[i * n + j] = K[(n + i) * size + n + j];
            R[i * n + j] = -K[(n + i) * size + j];
        }
    TRY(linalg_solve_spd(n, n, Krr, R, err));
    condense(n, K, R, work, c->K);
    condense(n, M, R, work, c->M);
    return STATUS_OK;
}

Status core_beam_make(CoreBeam *c, const CoreOptions *o, const BuildingOptions *b, int n, double t_base_m,
                      double t_top_m, Err *err)
{
    const size_t size = 2 * (size_t)n;
    if (o->section != CORE_EFFECTIVE && !(t_base_m > 0 && t_top_m > 0))
        return fail(err, STATUS_BAD_DATA, "core: thickness %g -> %g m must be positive", t_base_m, t_top_m);
    if (o->section == CORE_BOX && !(2 * fmax(t_base_m, t_top_m) <= o->side_m))
        return fail(err, STATUS_BAD_DATA, "core: twice a thickness of %g m does not fit into core.side_m = %g m",
                    fmax(t_base_m, t_top_m), o->side_m);
    if (o->section == CORE_EFFECTIVE && (o->shear_area_base_m2 > 0) != (o->shear_area_top_m2 > 0))
        return fail(err, STATUS_BAD_DATA, "core.shear_area_base_m2 is %g, core.shear_area_top_m2 %g: give both or none",
                    o->shear_area_base_m2, o->shear_area_top_m2);
    double *K = calloc(2 * size * size + 4 * size * size, sizeof *K);
    if (!K)
        return fail(err, STATUS_NO_MEMORY, "core: no memory for %d storeys", n);
    double *M = K + size * size;
    memset(c, 0, sizeof *c);
    c->n = n;
    c->mass_kg = assemble(o, b, n, t_base_m, t_top_m, K, M);
    Status status = remove_rotations(c, K, M, M + size * size, err);
    if (status == STATUS_OK)
        status = linalg_modes(n, c->K, c->M, c->omega, c->phi, err);
    free(K);
    if (status == STATUS_OK)
        linalg_participation(n, c->M, c->phi, c->gamma);
    return status;
}

Status core_beam_first_hz(const CoreOptions *o, const BuildingOptions *b, CoreTheory theory, int n, double t_base_m,
                          double t_top_m, double *hz, Err *err)
{
    CoreOptions by_theory = *o;
    by_theory.theory = theory;
    CoreBeam *core = malloc(sizeof *core);
    if (!core)
        return fail(err, STATUS_NO_MEMORY, "core: no memory for %d storeys", n);
    const Status status = core_beam_make(core, &by_theory, b, n, t_base_m, t_top_m, err);
    *hz = status == STATUS_OK ? core->omega[0] / (2 * M_PI) : 0;
    free(core);
    return status;
}

const char *core_theory_word(CoreTheory theory)
{
    static const char *const WORDS[] = {CORE_THEORY_LIST(CHOICE_WORD)};
    return WORDS[theory];
}
