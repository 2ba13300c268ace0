#include "scene/building.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/hash.h"
#include "base/linalg.h"
#include "base/list.h"
#include "base/units.h"
#include "scene/building_read.h"
#include "scene/reduction.h"

/* ---- heights -------------------------------------------------------------------------------------------------- */

static Status find_heights(Building *b, const BuildingFiles *files, const BuildingOptions *o, Err *err)
{
    if (o->heights_m.n > b->n && o->heights_m.n > 2 && !files->storey_m)
        return fail(err, STATUS_BAD_DATA, "building.heights_m: has %d heights; the building has %d storey%s",
                    o->heights_m.n, b->n, b->n == 1 ? "" : "s");
    for (int j = 0; j < b->n; j++)
        b->storey_m[j] = files->storey_m ? files->storey_m[j] : list_at(&o->heights_m, j);
    return STATUS_OK;
}

/* ---- P-delta -------------------------------------------------------------------------------------------------- */

/* K (m, m), the floors first. */
static Status add_p_delta(const Building *b, const BuildingOptions *o, int m, double K[], Err *err)
{
    const int n = b->n;
    double weight = 0;
    for (int j = n - 1; j >= 0; j--) {
        for (int k = 0; k < n; k++)
            weight += GRAVITY * b->M[j * n + k];
        const double k = weight / b->storey_m[j];
        K[j * m + j] -= k;
        if (j > 0) {
            K[(j - 1) * m + j - 1] -= k;
            K[j * m + j - 1] += k;
            K[(j - 1) * m + j] += k;
        }
    }
    const int pivot = linalg_indefinite_at(m, K);
    if (pivot < 0)
        return fail(err, STATUS_NO_MEMORY, "building: no memory to factor %d x %d", m, m);
    return pivot == 0 ? STATUS_OK
                      : fail(err, STATUS_BAD_DATA, "%s: buckles under its own weight (building.p_delta)", o->model);
}

/* ---- modes ---------------------------------------------------------------------------------------------------- */

static Status find_modes(Building *b, Err *err)
{
    TRY(linalg_modes(b->n, b->K, b->M, b->omega, b->phi, err));
    linalg_participation(b->n, b->M, b->phi, b->gamma);
    return STATUS_OK;
}

static int is_period(double per_storey)
{
    return per_storey >= 0.01 && per_storey <= 1;
}

/* [s] Beyond it and its inverse the energies of building and core differ by more digits than there are. */
static const double PERIOD_MIN = 1e-6;

static double mean_floor_mass(const Building *b)
{
    double sum = 0;
    for (int i = 0; i < b->n * b->n; i++)
        sum += b->M[i];
    return sum / b->n;
}

static int is_floor(double mass_kg)
{
    return mass_kg >= 1e3 && mass_kg <= 1e7;
}

static Status check_period(const Building *b, const BuildingOptions *o, Err *err)
{
    const double period = 2 * M_PI / b->omega[0];
    return period < PERIOD_MIN || (isfinite(period) && period > 1.0 / PERIOD_MIN)
               ? fail(err, STATUS_BAD_DATA, "%s: the first period is %.3g s: is a stiffness or a mass wrong?", o->model,
                      period)
               : STATUS_OK;
}

/* Units that are wrong by a factor of a thousand move the period by 32; where both are, the floors are too light. */
static Status check_units(const Building *b, const BuildingOptions *o, Err *err)
{
    static const char *const WORDS[] = {BUILDING_UNITS_LIST(CHOICE_WORD)};
    const double per_storey = 2 * M_PI / b->omega[0] / b->n, mass = mean_floor_mass(b);
    const int is_right = is_period(per_storey);
    if (o->units != BUILDING_AUTO || (is_right && mass >= 1e3))
        return STATUS_OK;
    char fits[240] = "";
    for (BuildingUnits u = BUILDING_N_M_KG; u <= BUILDING_KIP_IN; u++) {
        const BuildingUnit unit = building_unit(u);
        const size_t used = strlen(fits);
        const double other = per_storey * sqrt(unit.mass / unit.stiffness);
        if (is_period(other) && (!is_right || is_floor(unit.mass * mass)))
            snprintf(fits + used, sizeof fits - used, "%s%s (%.3g s per storey, floors of %.3g kg)", used ? ", " : "",
                     WORDS[u], other, unit.mass * mass);
    }
    if (fits[0])
        return fail(err, STATUS_BAD_DATA,
                    "%s: %s %.3g %s if stiffness is in N/m and mass in kg%s; set building.units to what the files are "
                    "in: %s",
                    o->model, is_right ? "floors of" : "the first period is", is_right ? mass : per_storey,
                    is_right ? "kg" : "s per storey", is_right ? " (then N_m_kg)" : "", fits);
    return is_right ? STATUS_OK
                    : fail(err, STATUS_BAD_DATA,
                           "%s: the first period is %.3g s per storey; if that is meant set building.units=N_m_kg",
                           o->model, per_storey);
}

/* ---- damping -------------------------------------------------------------------------------------------------- */

/* a / w + b w = 2 zeta at two frequencies, those of the floors alone. */
static Status rayleigh(Building *b, const BuildingOptions *o, Err *err)
{
    double mode[2];
    if (list_count(o->rayleigh_modes) > 2)
        return fail(err, STATUS_BAD_DATA, "building.rayleigh_modes: '%s' has %zu modes; Rayleigh damping takes two",
                    o->rayleigh_modes, list_count(o->rayleigh_modes));
    for (size_t i = 0; i < 2; i++) {
        TRY(list_positive(o->rayleigh_modes, i, "building.rayleigh_modes", &mode[i], err));
        if (mode[i] != floor(mode[i]) || mode[i] > b->n)
            return fail(err, STATUS_BAD_DATA, "building.rayleigh_modes: %g is none of the %d modes", mode[i], b->n);
    }
    const double w1 = b->omega[(int)mode[0] - 1], w2 = b->omega[(int)mode[1] - 1];
    if (!(w1 != w2))
        return fail(err, STATUS_BAD_DATA, "building.rayleigh_modes: '%s' are not two modes", o->rayleigh_modes);
    const double mass = 2 * o->damping.at[0] * w1 * w2 / (w1 + w2), stiffness = 2 * o->damping.at[0] / (w1 + w2);
    for (int i = 0; i < b->n; i++)
        b->zeta[i] = 0.5 * (mass / b->omega[i] + stiffness * b->omega[i]);
    for (int i = 0; i < b->model.n; i++)
        b->model.zeta[i] = 0.5 * (mass / b->model.omega[i] + stiffness * b->model.omega[i]);
    return STATUS_OK;
}

Status building_damp(Building *b, const BuildingOptions *o, Err *err)
{
    if (o->damping_model == DAMPING_RAYLEIGH)
        return rayleigh(b, o, err);
    if (o->damping.n > b->n)
        return fail(err, STATUS_BAD_DATA, "building.damping: has %d ratios; the building has %d mode%s", o->damping.n,
                    b->n, b->n == 1 ? "" : "s");
    for (int i = 0; i < b->n; i++)
        b->zeta[i] = list_at(&o->damping, i);
    for (int i = 0; i < b->model.n; i++)
        b->model.zeta[i] = b->zeta[b->model.like[i] >= 0 ? b->model.like[i] : b->n - 1];
    return STATUS_OK;
}

/* ---- the model that is integrated ----------------------------------------------------------------------------- */

static void use_the_floors(Building *b)
{
    for (int i = 0; i < b->n; i++)
        b->model.like[i] = i;
    b->model = (BuildingModel){.n = b->n,
                               .K = b->K,
                               .M = b->M,
                               .phi = b->phi,
                               .omega = b->omega,
                               .gamma = b->gamma,
                               .zeta = b->zeta,
                               .like = b->model.like};
}

/* Room for n degrees of freedom. */
static Status allocate_model(Building *b, int n, Err *err)
{
    const size_t nn = (size_t)n * (size_t)n;
    double *p = b->model_store = calloc(3 * nn + 3 * (size_t)n, sizeof *p);
    int *like = realloc(b->model.like, (size_t)n * sizeof *like);
    if (like)
        b->model.like = like;
    if (!p || !like)
        return fail(err, STATUS_NO_MEMORY, "building: no memory for %d degrees of freedom", n);
    b->model = (BuildingModel){.n = n, .K = p, .M = p + nn, .phi = p + 2 * nn, .omega = p + 3 * nn, .like = like};
    b->model.gamma = b->model.omega + n;
    b->model.zeta = b->model.gamma + n;
    return STATUS_OK;
}

/* gamma = phi' M r */
static void participate(const BuildingModel *m, const double r[])
{
    for (int j = 0; j < m->n; j++) {
        double force = 0;
        for (int k = 0; k < m->n; k++)
            force += m->M[j * m->n + k] * r[k];
        for (int i = 0; i < m->n; i++)
            m->gamma[i] += m->phi[j * m->n + i] * force;
    }
}

static Status use_more(Building *b, const FrameFull *more, const BuildingOptions *o, Err *err)
{
    const size_t bytes = (size_t)(more->n * more->n) * sizeof(double);
    TRY(allocate_model(b, more->n, err));
    BuildingModel *m = &b->model;
    memcpy(m->K, more->K, bytes);
    memcpy(m->M, more->M, bytes);
    if (o->p_delta)
        TRY(add_p_delta(b, o, m->n, m->K, err));
    TRY(linalg_modes(m->n, m->K, m->M, m->omega, m->phi, err));
    participate(m, more->influence);
    reduction_alike(b->n, b->phi, b->M, m->n, m->phi, m->like);
    return STATUS_OK;
}

static Status make_model(Building *b, const FrameFull *full, const BuildingOptions *o, Err *err)
{
    FrameFull reduced;
    if (full->n == 0) {
        use_the_floors(b);
        return STATUS_OK;
    }
    if (o->modes == 0 || o->modes >= full->n - b->n)
        return use_more(b, full, o, err);
    TRY(reduction_craig_bampton(full, b->n, o->modes, &reduced, err));
    const Status status = use_more(b, &reduced, o, err);
    frame_full_free(&reduced);
    return status;
}

/* ---- all of it ------------------------------------------------------------------------------------------------ */

static Status allocate(Building *b, Err *err)
{
    const int n = b->n;
    b->phi = calloc((size_t)(n * n + 4 * n), sizeof *b->phi);
    if (!b->phi)
        return fail(err, STATUS_NO_MEMORY, "building: no memory for %d modes", n);
    b->omega = b->phi + n * n;
    b->gamma = b->omega + n;
    b->zeta = b->gamma + n;
    b->storey_m = b->zeta + n;
    b->model.like = malloc((size_t)n * sizeof *b->model.like);
    return b->model.like ? STATUS_OK : fail(err, STATUS_NO_MEMORY, "building: no memory for %d modes", n);
}

/* K and M become the building's. */
static Status take(Building *b, BuildingFiles *files, const BuildingOptions *o, Err *err)
{
    b->n = files->n;
    b->K = files->K;
    b->M = files->M;
    files->K = files->M = NULL;
    memcpy(b->note, files->note, sizeof b->note);
    const size_t bytes = (size_t)(b->n * b->n) * sizeof *b->K;
    b->hash = hash_fnv1a(b->M, bytes, hash_fnv1a(b->K, bytes, HASH_SEED));
    const size_t full_bytes = (size_t)(files->full.n * files->full.n) * sizeof *b->K;
    if (full_bytes)
        b->hash = hash_fnv1a(files->full.M, full_bytes, hash_fnv1a(files->full.K, full_bytes, b->hash));
    if (files->storey_m)
        b->hash = hash_fnv1a(files->storey_m, (size_t)b->n * sizeof *files->storey_m, b->hash);
    TRY(allocate(b, err));
    TRY(find_heights(b, files, o, err));
    if (o->p_delta)
        TRY(add_p_delta(b, o, b->n, b->K, err));
    TRY(find_modes(b, err));
    TRY(make_model(b, &files->full, o, err));
    TRY(check_period(b, o, err));
    if (!files->storey_m) /* matrices: their headers say no unit */
        TRY(check_units(b, o, err));
    return building_damp(b, o, err);
}

Status building_load(Building *b, const BuildingOptions *o, Err *err)
{
    BuildingFiles files;
    memset(b, 0, sizeof *b);
    Status s = building_read(&files, o, err);
    if (s == STATUS_OK)
        s = take(b, &files, o, err);
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

void building_free(Building *b)
{
    free(b->K);
    free(b->M);
    free(b->phi);
    free(b->model.like);
    free(b->model_store);
    memset(b, 0, sizeof *b);
}
