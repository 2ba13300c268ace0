#include "scene/core_beam.h"

#include "base/linalg.h"
#include "base/units.h"

/* ---- beams ---------------------------------------------------------------------------------------------------- */

void beam_element(const Beam *b, double k[4][4], double m[4][4])
{
    const double l = b->length, phi = b->kGA > 0 ? 12 * b->EI / (b->kGA * l * l) : 0;

    /* Stiffness, its upper half. */
    const double scale = b->EI / (l * l * l * (1 + phi));
    const double shape[4][4] = {{12, 6 * l, -12, 6 * l},
                                {0, (4 + phi) * l * l, -6 * l, (2 - phi) * l * l},
                                {0, 0, 12, -6 * l},
                                {0, 0, 0, (4 + phi) * l * l}};

    /* Mass that moves sideways and inertia that turns. */
    const double w0 = 70 * phi * phi + 147 * phi + 78, w1 = 35 * phi * phi + 63 * phi + 27;
    const double c0 = (35 * phi * phi + 77 * phi + 44) * l / 4, c1 = (35 * phi * phi + 63 * phi + 26) * l / 4;
    const double r0 = (7 * phi * phi + 14 * phi + 8) * l * l / 4, r1 = (7 * phi * phi + 14 * phi + 6) * l * l / 4;
    const double moved[4][4] = {{w0, c0, w1, -c1}, {0, r0, c1, -r1}, {0, 0, w0, -c0}, {0, 0, 0, r0}};
    const double d = (15 * phi - 3) * l, e0 = (10 * phi * phi + 5 * phi + 4) * l * l,
                 e1 = (5 * phi * phi - 5 * phi - 1) * l * l;
    const double turned[4][4] = {{36, -d, -36, -d}, {0, e0, d, e1}, {0, 0, 36, d}, {0, 0, 0, e0}};
    const double over = 1 / ((1 + phi) * (1 + phi));
    const double along = b->mass_per_m * l / 210 * over, about = b->rotary_kg_m / (30 * l) * over;
    for (int i = 0; i < 4; i++)
        for (int j = i; j < 4; j++) {
            k[i][j] = k[j][i] = scale * shape[i][j];
            m[i][j] = m[j][i] = along * moved[i][j] + about * turned[i][j];
        }
}

/* ---- cantilever ----------------------------------------------------------------------------------------------- */

Status beam_cantilever(int n, const Beam beam[], const Foundation *base, double K[], double M[], Err *err)
{
    const int has_turn = base && base->rotation > 0, has_move = base && base->translation > 0;
    const int slaves = n + has_turn + has_move;
    const size_t size = n + slaves, nn = n * (size_t)n, rn = slaves * (size_t)n;
    double *whole_K;
    TRY_ROOM(whole_K, 2 * size * size + slaves * slaves + nn + rn + size * n, "numbers of a core", err);
    double *whole_M = whole_K + size * size, *Krr = whole_M + size * size, *T = Krr + slaves * slaves, *R = T + nn,
           *work = R + rn;

    /* Unknowns: deflections 0..n-1, rotations n..2n-1, then those of the base that is not fixed: rotation,
     * translation. */
    const int turns = has_turn ? 2 * n : -1, moves = has_move ? (int)size - 1 : -1;
    if (has_turn)
        whole_K[turns * size + turns] = base->rotation;
    if (has_move)
        whole_K[moves * size + moves] = base->translation;
    for (int e = 0; e < n; e++) {
        double k[4][4], m[4][4];
        beam_element(&beam[e], k, m);
        const int at[4] = {e == 0 ? moves : e - 1, e == 0 ? turns : n + e - 1, e, n + e};
        for (int i = 0; i < 4; i++)
            for (int j = 0; j < 4; j++)
                if (at[i] >= 0 && at[j] >= 0) {
                    whole_K[at[i] * size + at[j]] += k[i][j];
                    whole_M[at[i] * size + at[j]] += m[i][j];
                }
    }

    /* Condensed to the deflections. */
    for (int i = 0; i < n; i++)
        T[i * n + i] = 1;
    for (int i = 0; i < slaves; i++) {
        const double *row = whole_K + (n + i) * size;
        memcpy(Krr + i * slaves, row + n, slaves * sizeof *row);
        for (int j = 0; j < n; j++)
            R[i * n + j] = -row[j];
    }
    const Status status = linalg_solve_spd(slaves, n, Krr, R, err);
    if (status == STATUS_OK) {
        linalg_congruent((int)size, n, whole_K, T, work, K);
        linalg_congruent((int)size, n, whole_M, T, work, M);
    }
    free(whole_K);
    return status;
}

/* ---- the core -------------------------------------------------------------------------------------------------- */

CoreStorey core_beam_storey(const CoreOptions *o, int n, int storey, double t_base_m, double t_top_m)
{
    const double share = n > 1 ? (double)storey / (n - 1) : 0, t = t_base_m + (t_top_m - t_base_m) * share;
    const double side = o->width_m, inner = side - 2 * t;
    if (o->section == CORE_EFFECTIVE)
        return (CoreStorey){.thickness = t,
                            .area = list_along(&o->areas_m2, storey, n),
                            .inertia = list_along(&o->inertias_m4, storey, n),
                            .shear_area = list_along(&o->shear_areas_m2, storey, n),
                            .mass_kg = o->masses_kg.n ? list_along(&o->masses_kg, storey, n) : 0};

    /* Solid rectangle, whose shear stress is a parabola. */
    if (o->section == CORE_PLATE)
        return (CoreStorey){.thickness = t,
                            .depth = t,
                            .area = side * t,
                            .inertia = side * t * t * t / 12,
                            .shear_area = 5.0 / 6 * side * t,
                            .shear_stress_per_n = 1.5 / (side * t)};

    /* Thin-walled square tube, its shear area by Cowper, J. Appl. Mech. 33 (1966) 335-340; stress Q / (I 2t). */
    const double area = side * side - inner * inner, inertia = (pow(side, 4) - pow(inner, 4)) / 12;
    return (CoreStorey){.thickness = t,
                        .depth = side,
                        .area = area,
                        .inertia = inertia,
                        .shear_area = 20 * (1 + o->poisson) / (48 + 39 * o->poisson) * area,
                        .shear_stress_per_n = (side * side * side - inner * inner * inner) / 8 / (inertia * 2 * t)};
}

double core_wall_factor(const CoreOptions *o)
{
    return o->wall_factor > 0 ? o->wall_factor : 1;
}

/* Refuses thicknesses that the section does not have, and lists of a length that the storeys do not have. */
static Status check(const CoreOptions *o, int n, double t_base_m, double t_top_m, Err *err)
{
    if (o->section != CORE_EFFECTIVE && !(t_base_m > 0 && t_top_m > 0))
        return bad_data(err, "core: thickness %g -> %g m must be positive", t_base_m, t_top_m);
    if (o->section == CORE_BOX && !(2 * fmax(t_base_m, t_top_m) <= o->width_m))
        return bad_data(err, "core: twice a thickness of %g m does not fit into core.width_m = %g m",
                        fmax(t_base_m, t_top_m), o->width_m);
    const struct {
        const char *key;
        const NumberList *list;
    } lists[] = {{"core.areas_m2", &o->areas_m2},
                 {"core.inertias_m4", &o->inertias_m4},
                 {"core.shear_areas_m2", &o->shear_areas_m2},
                 {"core.masses_kg", &o->masses_kg}};
    for (size_t i = 0; i < N_OF(lists) && o->section == CORE_EFFECTIVE; i++)
        if (lists[i].list->n > 2 && lists[i].list->n != n)
            return bad_data(err, "%s: has %d values; the building has %d storeys", lists[i].key, lists[i].list->n, n);
    for (int j = 0; j < n && o->section == CORE_EFFECTIVE; j++)
        if ((list_along(&o->shear_areas_m2, j, n) > 0) != (o->shear_areas_m2.at[0] > 0))
            return bad_data(err, "core.shear_areas_m2: 0 in one storey and not in another; give all or none");
    return STATUS_OK;
}

double core_beam_base_loss(const CoreBeam *c, double omega, const double v[], int stride)
{
    double rotation = 0, translation = 0;
    for (int j = 0; j < c->n; j++) {
        rotation += c->base_rotation[j] * v[j * stride];
        translation += c->base_translation[j] * v[j * stride];
    }
    return foundation_loss(c->base.rotation, foundation_rotation_dashpot(&c->base, omega), omega) * rotation *
               rotation +
           foundation_loss(c->base.translation, c->base.translation_dashpot, omega) * translation * translation;
}

double core_beam_dashpot_share(const CoreBeam *c)
{
    const Foundation *f = &c->base;
    const double omega = c->omega[0],
                 turns = f->rotation > 0 ? omega * foundation_rotation_dashpot(f, omega) / f->rotation : 0;
    return fmax(turns, f->translation > 0 ? omega * f->translation_dashpot / f->translation : 0);
}

double core_beam_weight(const CoreBeam *c)
{
    return c->base.weight_n + GRAVITY * c->mass_kg;
}

double core_beam_anchor(const CoreBeam *c)
{
    return fmax(c->base.anchors - 1, 0) * core_beam_weight(c);
}

/* [s] A dashpot that gives way sooner than this is none. */
static const double DASHPOT_FELT_S = 1e-4;

Status core_beam_make(CoreBeam *c, const CoreOptions *o, int n, const double storey_m[], double t_base_m,
                      double t_top_m, Err *err)
{
    const double E = o->youngs_modulus_pa, G = E / (2 * (1 + o->poisson));
    const int shears = o->theory == CORE_TIMOSHENKO;
    const Foundation *base = &c->base;
    Beam beam[FLOORS_MAX];
    double z = 0, share = 0;
    TRY(check(o, n, t_base_m, t_top_m, err));
    memset(c, 0, sizeof *c);
    c->n = c->top = n;
    TRY(foundation_parse(o->foundation, o->foundation_factor, &c->base, err));
    c->base.anchors = o->anchors > 0 ? o->anchors : base->anchors;
    for (int e = 0; e < n; e++) {
        const CoreStorey a = core_beam_storey(o, n, e, t_base_m, t_top_m);
        const double heavier = 1 + o->stiffeners, left = o->wall_share[e] > 0 ? o->wall_share[e] : core_wall_factor(o);
        beam[e] = (Beam){.EI = E * a.inertia * left,
                         .kGA = shears ? G * a.shear_area * left : 0,
                         .mass_per_m = a.mass_kg > 0 ? a.mass_kg / storey_m[e] : o->density_kg_m3 * a.area * heavier,
                         .rotary_kg_m = shears ? o->density_kg_m3 * a.inertia * heavier : 0,
                         .length = storey_m[e]};
        c->mass_kg += beam[e].mass_per_m * beam[e].length;
    }
    TRY(beam_cantilever(n, beam, base, c->K, c->M, err));
    TRY(linalg_modes(n, c->K, c->M, c->omega, c->phi, err));
    linalg_participation(n, c->M, NULL, c->phi, c->gamma);

    /* How the base moves with the nodes, and what its dashpots take of the modes. */
    for (int j = 0; j < n; j++) {
        z += storey_m[j];
        for (int i = 0; i < n; i++) {
            c->base_rotation[i] += base->rotation > 0 ? z * c->K[j * n + i] / base->rotation : 0;
            c->base_translation[i] += base->translation > 0 ? c->K[j * n + i] / base->translation : 0;
        }
    }
    for (int i = 0; i < n; i++)
        c->zeta[i] = o->damping + core_beam_base_loss(c, c->omega[i], c->phi + i, n) / (2 * c->omega[i]);

    /* share: of a rigid rotation that the base takes, a / (K + a) (scene/uplift.h). */
    z = 0;
    for (int j = 0; j < n; j++)
        share += c->base_rotation[j] * (z += storey_m[j]);
    if (base->anchors > 0) {
        const double K = base->rotation, whole = K / (1 - share), C = base->rotation_dashpot;
        const double moment = base->anchors * foundation_uplift_nm(base, core_beam_weight(c));
        c->uplift = (Uplift){moment / K, K, whole, C > DASHPOT_FELT_S * whole ? C : 0, base->cone_s};
    }
    return STATUS_OK;
}

Status core_beam_first_hz(const CoreOptions *o, CoreTheory theory, int n, const double storey_m[], double t_base_m,
                          double t_top_m, double *hz, Err *err)
{
    CoreOptions by_theory = *o;
    by_theory.theory = theory;
    CoreBeam *core;
    TRY_ROOM(core, 1, "a core", err);
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
