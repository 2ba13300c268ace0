#include "scene/building.h"

#include "base/hash.h"
#include "base/linalg.h"
#include "base/text.h"
#include "base/units.h"
#include "scene/building_read.h"
#include "scene/reduction.h"
#include "scene/sheets.h"

/* ---- heights -------------------------------------------------------------------------------------------------- */

/* [m] Of the tower that both built-in models are matrices of. */
static const double BUILT_IN_FIRST_M = 5.4864, BUILT_IN_M = 3.9624;

/* Takes the heights of storeys from the files, or else from the setting, which a built-in building does not have. */
static Status find_heights(Building *b, const BuildingFiles *files, const BuildingOptions *o, Err *err)
{
    const int is_own =
        o->heights_m.n == 2 && o->heights_m.at[0] == BUILT_IN_FIRST_M && o->heights_m.at[1] == BUILT_IN_M;
    b->heights_assumed = !files->storey_m && !model_is_built_in(o->model) && is_own;
    for (int j = 0; j < b->n && model_is_built_in(o->model); j++)
        if (list_at(&o->heights_m, j) != (j == 0 ? BUILT_IN_FIRST_M : BUILT_IN_M))
            return bad_data(err,
                            "building.heights_m: %s is a tower of storeys of %g and %g m; others would change the core "
                            "alone. Give another building its matrices in a folder",
                            o->model, BUILT_IN_FIRST_M, BUILT_IN_M);
    if (o->heights_m.n > b->n && o->heights_m.n > 2 && !files->storey_m)
        return bad_data(err, "building.heights_m: has %d heights; the building has %d storey%s", o->heights_m.n, b->n,
                        b->n == 1 ? "" : "s");
    for (int j = 0; j < b->n; j++)
        b->storey_m[j] = files->storey_m ? files->storey_m[j] : list_at(&o->heights_m, j);
    return STATUS_OK;
}

/* ---- plausible ------------------------------------------------------------------------------------------------ */

static int is_period(double per_storey)
{
    return per_storey >= 0.01 && per_storey <= 1;
}

/* [s] Beyond it and its inverse the energies of building and core differ by more digits than there are. */
static const double PERIOD_MIN = 1e-6;

/* Units that are wrong by a factor of a thousand move the period by 32; where both are, the floors are too light.
 * is_matrix: the files say no unit by their headers. */
static Status check_units(const Building *b, const BuildingOptions *o, int is_matrix, Err *err)
{
    static const char *const WORDS[] = {BUILDING_UNITS_LIST(CHOICE_WORD)};
    const double period = 2 * M_PI / b->omega[0], per_storey = period / b->n;
    const int is_right = is_period(per_storey);
    double mass = 0;
    char fits[240] = "";
    if (isnan(period + b->omega[b->n - 1]) || period < PERIOD_MIN || (isfinite(period) && period > 1.0 / PERIOD_MIN))
        return bad_data(err, "%s: the first period is %.3g s: is a stiffness or a mass wrong?", o->model, period);
    for (int j = 0; j < b->n; j++)
        mass += building_floor_mass(b, j);
    mass /= b->n;
    if (!is_matrix || o->units != BUILDING_AUTO || (is_right && mass >= 1e3))
        return STATUS_OK;
    for (BuildingUnits u = BUILDING_N_M_KG; u <= BUILDING_KIP_IN; u++) {
        const BuildingUnit unit = building_unit(u);
        const double other = per_storey * sqrt(unit.mass / unit.stiffness), floor = unit.mass * mass;
        if (is_period(other) && (!is_right || (floor >= 1e3 && floor <= 1e7)))
            text_join(fits, sizeof fits, ", ", "%s (%.3g s per storey, floors of %.3g t)", WORDS[u], other,
                      floor / 1e3);
    }
    if (fits[0])
        return bad_data(
            err,
            "%s: %s %.3g %s if stiffness is in N/m and mass in kg%s; set building.units to what the files are "
            "in: %s",
            o->model, is_right ? "floors of" : "the first period is", is_right ? mass : per_storey,
            is_right ? "kg" : "s per storey", is_right ? " (then N_m_kg)" : "", fits);
    return is_right
               ? STATUS_OK
               : bad_data(err, "%s: the first period is %.3g s per storey; if that is meant set building.units=N_m_kg",
                          o->model, per_storey);
}

/* ---- damping -------------------------------------------------------------------------------------------------- */

Status building_damp(Building *b, const BuildingOptions *o, Err *err)
{
    const BuildingModel *m = &b->model, *both[] = {&b->floors, m};
    const double *mode = o->rayleigh_modes.at;
    if (o->damping_model != DAMPING_RAYLEIGH) {
        if (o->damping.n > b->n)
            return bad_data(err, "building.damping: has %d ratios; the building has %d mode%s", o->damping.n, b->n,
                            b->n == 1 ? "" : "s");
        for (int i = 0; i < b->n; i++)
            b->zeta[i] = list_at(&o->damping, i);
        for (int i = 0; i < m->n; i++)
            m->zeta[i] = b->zeta[m->like[i] >= 0 ? m->like[i] : b->n - 1];
        return STATUS_OK;
    }

    /* a / w + b w = 2 zeta at two frequencies, those of the floors alone. */
    for (int i = 0; i < 2; i++)
        if (mode[i] != floor(mode[i]) || mode[i] > b->n)
            return bad_data(err, "building.rayleigh_modes: %g is none of the %d modes", mode[i], b->n);
    const double w1 = b->omega[(int)mode[0] - 1], w2 = b->omega[(int)mode[1] - 1];
    const double mass = 2 * o->damping.at[0] * w1 * w2 / (w1 + w2), stiffness = 2 * o->damping.at[0] / (w1 + w2);
    for (int k = 0; k < 2; k++)
        for (int i = 0; i < both[k]->n; i++)
            both[k]->zeta[i] = 0.5 * (mass / both[k]->omega[i] + stiffness * both[k]->omega[i]);
    return STATUS_OK;
}

/* ---- modes by shape ------------------------------------------------------------------------------------------- */

void building_alike(int n, const double phi[], const double M[], const BuildingModel *of, int like[])
{
    double M_psi[2][FLOORS_MAX] = {{0}}; /* of motion and rotation */
    const int m = of->n, n_turns = of->turns_at > 0 ? 2 : 1;
    for (int k = 0; k < m; k++) {
        double most = 0, sum = 0;
        like[k] = -1;
        for (int turn = 0; turn < n_turns; turn++)
            for (int a = 0; a < n; a++) {
                M_psi[turn][a] = 0;
                for (int b = 0; b < n; b++)
                    M_psi[turn][a] += M[a * n + b] * of->phi[(turn * of->turns_at + b) * m + k];
            }
        for (int i = 0; i < n; i++) {
            double moves = 0, turns = 0;
            for (int a = 0; a < n; a++) {
                moves += phi[a * n + i] * M_psi[0][a];
                turns += phi[a * n + i] * M_psi[1][a];
            }
            const double share = moves * moves + turns * turns;
            sum += share;
            if (share > most) {
                most = share;
                like[k] = i;
            }
        }
        if (sum < 0.5)
            like[k] = -1;
    }
}

/* ---- modes ---------------------------------------------------------------------------------------------------- */

void building_model_layout(void *model, Carve *c)
{
    BuildingModel *m = model;
    const size_t n = m->n;
    CARVE(c, m->K, n * n);
    CARVE(c, m->M, n * n);
    CARVE(c, m->phi, n * n);
    CARVE(c, m->omega, n);
    CARVE(c, m->gamma, n);
    CARVE(c, m->zeta, n);
    CARVE(c, m->like, n);
}

/* Room for a model with these matrices. */
static Status copy_matrices(BuildingModel *m, void **store, const FrameFull *from, Err *err)
{
    const size_t bytes = from->n * from->n * sizeof(double);
    m->n = from->n;
    *store = carve_all(building_model_layout, m);
    if (!*store)
        return fail_memory(err, m->n, "degrees of freedom");
    memcpy(m->K, from->K, bytes);
    memcpy(m->M, from->M, bytes);
    return STATUS_OK;
}

/* Modes of K and M, of whose degrees of freedom the floors come first; with P-delta K loses the geometric stiffness of
 * the weights above. r NULL: all of it moves with the ground. */
static Status find_modes(const Building *b, BuildingModel *m, const double *r, const BuildingOptions *o, Err *err)
{
    double weight = 0;
    for (int j = b->n - 1; j >= 0 && o->p_delta; j--) {
        for (int k = 0; k < b->n; k++)
            weight += GRAVITY * b->M[j * b->n + k];
        storey_spring(m->n, j, -weight / b->storey_m[j], m->K);
    }
    const int pivot = o->p_delta ? linalg_indefinite_at(m->n, m->K) : 0;
    if (pivot < 0)
        return fail(err, STATUS_NO_MEMORY, "building: no memory to factor %d x %d", m->n, m->n);
    if (pivot > 0)
        return bad_data(err, "%s: buckles under its own weight (building.p_delta)", o->model);
    TRY(linalg_modes(m->n, m->K, m->M, m->omega, m->phi, err));
    linalg_participation(m->n, m->M, r, m->phi, m->gamma);
    building_alike(b->n, b->phi, b->M, m, m->like);
    return STATUS_OK;
}

/* ---- yielding storeys ----------------------------------------------------------------------------------------- */

/* Of what may yield without the rest of the building falling: below 1 by this share. */
static const double STANDS = 0.98;

/* Finds the part of each storey's stiffness that yields, where any does (scene/building.h). K: without P-delta. */
static Status find_yielding(Building *b, const double of_file[], const double K[], const BuildingOptions *o, Err *err)
{
    const int n = b->n;
    double *k = b->yield_n_m, *phi, shear = 0;
    b->hardening = o->hardening;
    for (int j = 0; j < n; j++) {
        b->yield_m[j] = b->storey_m[j] * (of_file && of_file[j] > 0 ? of_file[j] : o->yield_drift);
        b->yields |= b->yield_m[j] > 0;
    }
    if (!b->yields)
        return STATUS_OK;
    TRY_ROOM(phi, (2 * n + 1) * n, "yielding storeys", err);
    double *yields = phi + n * n, *omega = yields + n * n;
    Status status = linalg_modes(n, K, b->M, omega, phi, err);

    /* k_j = V_j / d_j of the first mode under the forces K phi. */
    for (int j = n - 1; j >= 0 && status == STATUS_OK; j--) {
        for (int i = 0; i < n; i++)
            shear += K[j * n + i] * phi[i * n];
        const double drift = phi[j * n] - (j > 0 ? phi[(j - 1) * n] : 0);
        k[j] = b->yield_m[j] > 0 ? shear / drift : 0;
        if (b->yield_m[j] > 0 && !(k[j] > 0 && isfinite(k[j])))
            status =
                bad_data(err,
                         "building: storey %d has no stiffness in the first mode (%.3g N/m), so that nothing of it can "
                         "yield; leave building.yield_drift at 0",
                         j + 1, k[j]);
    }

    /* The largest eigenvalue of B' diag(k) B x = lambda K x says how much of that may yield. */
    for (int j = 0; j < n && status == STATUS_OK; j++)
        storey_spring(n, j, k[j], yields);
    THEN(status, linalg_modes(n, yields, b->K, omega, phi, err));
    const double c = fmin(1 - b->hardening, STANDS / (omega[n - 1] * omega[n - 1]));
    free(phi);
    TRY(status);
    b->hardening = 1 - c;
    b->hardening_raised = b->hardening > o->hardening + 1e-12;
    for (int j = 0; j < n; j++)
        k[j] *= c;
    return STATUS_OK;
}

/* ---- all of it ------------------------------------------------------------------------------------------------ */

static uint64_t hash_matrices(const FrameFull *f, uint64_t hash)
{
    const size_t bytes = f->n * f->n * sizeof *f->K;
    return hash_fnv1a(f->M, bytes, hash_fnv1a(f->K, bytes, hash));
}

/* Makes the building of what its files hold. */
static Status make_building(Building *b, const BuildingFiles *files, const BuildingOptions *o, Err *err)
{
    const FrameFull *full = &files->full;
    const double *drift = files->yield_drift;
    BuildingModel *m = &b->floors;
    memcpy(b->note, files->note, sizeof b->note);
    b->hash = hash_matrices(full, hash_matrices(&files->floors, HASH_SEED));
    if (files->storey_m)
        b->hash = hash_fnv1a(files->storey_m, files->floors.n * sizeof *files->storey_m, b->hash);
    for (int j = 0; drift && j < files->floors.n; j++)
        if (drift[j] > 0)
            b->hash = hash_fnv1a((double[]){j, drift[j]}, 2 * sizeof(double), b->hash);

    /* The floors alone. */
    TRY(copy_matrices(m, &b->store, &files->floors, err));
    TRY_ROOM(b->storey_m, 3 * b->n, "numbers of storeys", err);
    b->yield_m = b->storey_m + b->n;
    b->yield_n_m = b->yield_m + b->n;
    TRY(find_heights(b, files, o, err));
    TRY(find_modes(b, m, NULL, o, err));

    for (int j = 0; j < b->n; j++)
        m->like[j] = j;
    TRY(find_yielding(b, drift, files->floors.K, o, err));

    /* The model that is integrated: the floors, or more where the files have it, with as many modes as are wanted. */
    b->model = *m;
    if (full->n > 0) {
        FrameFull reduced = {0};
        const int reduces = o->modes > 0 && o->modes < full->n - b->n;
        Status status = reduces ? reduction_craig_bampton(full, b->n, o->modes, &reduced, err) : STATUS_OK;
        THEN(status, copy_matrices(&b->model, &b->model_store, reduces ? &reduced : full, err));
        THEN(status, find_modes(b, &b->model, reduces ? reduced.influence : full->influence, o, err));
        frame_full_free(&reduced);
        TRY(status);
    }
    TRY(check_units(b, o, !files->storey_m, err));
    return building_damp(b, o, err);
}

Status building_load(Building *b, const BuildingOptions *o, Err *err)
{
    BuildingFiles files;
    memset(b, 0, sizeof *b);
    Status s = building_read(&files, o, err);
    THEN(s, make_building(b, &files, o, err));
    building_files_free(&files);
    if (s != STATUS_OK)
        building_free(b);
    return s;
}

double building_mass(const Building *b)
{
    double sum = 0;
    for (int i = 0; i < b->model.n; i++)
        sum += b->model.gamma[i] * b->model.gamma[i];
    return sum;
}

double building_floor_mass(const Building *b, int floor)
{
    double sum = 0;
    for (int k = 0; k < b->n; k++)
        sum += b->M[floor * b->n + k];
    return sum;
}

void building_join_core(const CoreBeam *c, const BuildingModel *building, double K[], double M[])
{
    const int m = building->n;
    memcpy(K, building->K, m * m * sizeof *K);
    memcpy(M, building->M, m * m * sizeof *M);
    const int parts = building->turns_at ? 2 : 1;
    for (int a = 0; a < parts * parts; a++) { /* the motion and the rotation of the floors by which the nodes move */
        const int at = a / parts * building->turns_at * m + a % parts * building->turns_at;
        const double arm = pow(building->arm_contact, a / parts + a % parts);
        for (int i = 0; i < c->n; i++)
            for (int j = 0; j < c->n; j++) {
                K[at + i * m + j] += arm * c->K[i * c->n + j];
                M[at + i * m + j] += arm * c->M[i * c->n + j];
            }
    }
}

Status building_joined_hz(const CoreBeam *c, const Building *b, double hz[], Err *err)
{
    const int m = b->model.n, mm = m * m;
    double *K;
    TRY_ROOM(K, 3 * (size_t)mm + m, "numbers of modes", err);
    double *M = K + mm, *phi = M + mm, *omega = phi + mm;
    building_join_core(c, &b->model, K, M);
    const Status status = linalg_modes(m, K, M, omega, phi, err);
    for (int i = 0; i < b->n && status == STATUS_OK; i++)
        hz[i] = omega[i] / (2 * M_PI);
    free(K);
    return status;
}

void building_free(Building *b)
{
    free(b->store);
    free(b->model_store);
    free(b->storey_m);
    memset(b, 0, sizeof *b);
}
