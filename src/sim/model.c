#include "sim/model.h"

#include "base/carve.h"
#include "base/clones.h"
#include "base/units.h"
#include "scene/neighbour.h"
#include "sim/lanes.h"

static int padded(int n)
{
    return (n + 7) & ~7;
}

/* m_pad: the most that there may be. */
static void layout(void *object, Carve *c)
{
    SimModel *m = object;
    CARVE(c, m->R, m->m_pad * m->n_pad);
    CARVE(c, m->RT, m->m_pad * m->n_pad);
    CARVE(c, m->U_room, m->m_pad * padded(POINTS_OF(m->n)));
    CARVE(c, m->B, m->m_pad * (m->n + 2));
    CARVE(c, m->omega, m->m_pad);
    CARVE(c, m->zeta, m->m_pad);
    CARVE(c, m->gamma, m->m_pad);
    CARVE(c, m->gap, m->n_pad);
    CARVE(c, m->mass_eff, m->n_pad);
    CARVE(c, m->middle, m->n_pad);
    CARVE(c, m->like, m->m_pad);
}

Status model_create(SimModel *model, int n, int nb_max, Err *err)
{
    memset(model, 0, sizeof *model);
    model->n = n;
    model->n_pad = padded(n);
    model->m_pad = padded(nb_max + n + 1);
    model->store = carve_all(layout, model);
    if (!model->store)
        return fail_memory(err, n, "floors");
    model->U = model->R;
    model->p_pad = model->n_pad;
    model->points = n;
    for (int i = 0; i < nb_max; i++)
        model->like[i] = i < n ? i : -1;
    return STATUS_OK;
}

/* Centres, of floors that turn both edges, and the neighbour's floors. */
int model_points(const SceneOptions *o, const Building *b)
{
    return ((b->model.turns_at ? 3 : 1) + neighbour_is_given(&o->core)) * (b->n + 1) - 1;
}

/* The rows of all points; core NULL: it moves with the floors, or there is none. */
static void set_points(SimModel *model, const SceneOptions *o, const Building *b, const CoreBeam *core)
{
    const BuildingModel *m = &b->model;
    const int n = model->n, own = m->turns_at ? 3 : 1, has_neighbour = neighbour_is_given(&o->core);
    const double arm[] = {0, m->arm_edge, -m->arm_edge};
    model->points = model_points(o, b);
    model->neighbour_at = has_neighbour ? own * (n + 1) : 0;
    model->neighbour_floors = core && has_neighbour ? core->top : 0;
    model->p_pad = padded(model->points);
    model->U = model->points > n ? model->U_room : model->R;
    for (int i = 0; i < model->m && model->points > n; i++) {
        double *row = model->U + i * model->p_pad;
        const int in_core = i >= model->nb;
        memset(row, 0, sizeof *row * (size_t)model->p_pad);
        for (int p = 0; p < own * n && !in_core; p++)
            row[p / n * (n + 1) + p % n] = building_shape(m, p % n, arm[p / n], i);
        for (int j = 0; j < n && has_neighbour && (in_core || !core); j++)
            row[model->neighbour_at + j] =
                core ? core->phi[j * n + i - model->nb] : building_shape(m, j, m->arm_contact, i);
    }
}

/* [m] A floor beside which there is nothing on one side moves freely so far: no floor gets there, and distances from
 * the middle are still known to 1e-14 m. */
static const double NOTHING_M = 128;

Status model_set_gaps(SimModel *model, const double right[], const double left[], Err *err)
{
    for (int j = 0; j < model->n; j++) {
        const double r = fmin(right[j], NOTHING_M), l = fmin(left[j], NOTHING_M);
        if (!(right[j] >= 0 && left[j] >= 0))
            return bad_data(err, "gap_%02d_m: left %g, right %g; a gap is zero or more", j + 1, left[j], right[j]);
        model->gap[j] = isinf(right[j]) && isinf(left[j]) ? 1e300 : 0.5 * (r + l);
        model->middle[j] = 0.5 * (r - l);
    }
    return STATUS_OK;
}

Status model_set(SimModel *model, const SceneOptions *o, const Building *b, const CoreBeam *core, const double gaps[],
                 Err *err)
{
    const int n = b->n;
    const BuildingModel *building = &b->model;
    model->nb = building->n;
    model->nc = core ? n : 0;
    model->m = model->nb + model->nc;
    model->n_devices = model->has_mass = model->may_lift = 0;
    model->m_pad = padded(model->m);
    model->core_mass_kg = core ? core->mass_kg : 0;

    /* The modes, those of the core with the opposite sign; padded ones move nothing. */
    memset(model->R, 0, sizeof(double) * (size_t)(model->m_pad * model->n_pad));
    memset(model->RT, 0, sizeof(double) * (size_t)(model->m_pad * model->n_pad));
    for (int i = 0; i < model->m_pad; i++) {
        const int k = i - model->nb, is_own = k < 0, is_there = i < model->m;
        model->omega[i] = !is_there ? 1 : is_own ? building->omega[i] : core->omega[k];
        model->zeta[i] = !is_there ? 0.5 : is_own ? building->zeta[i] : core->zeta[k];
        model->gamma[i] = !is_there ? 0 : is_own ? building->gamma[i] : core->gamma[k];
        for (int j = 0; j < n && is_there; j++)
            model->R[i * model->n_pad + j] = model->RT[j * model->m_pad + i] =
                is_own ? building_shape(building, j, building->arm_contact, i) : -core->phi[j * n + k];
    }
    memcpy(model->like, building->like, (size_t)model->nb * sizeof *model->like);
    set_points(model, o, b, core);
    for (int j = 0; j < model->n_pad; j++) {
        double sum = 0;
        for (int i = 0; i < model->m; i++)
            sum += model->R[i * model->n_pad + j] * model->R[i * model->n_pad + j];
        model->mass_eff[j] = sum > 0 ? 1 / sum : 1e300;
    }

    /* Storeys and contacts. */
    model->yields = b->yields;
    model->storey_law = (StoreyLaw){o->building.hysteresis, o->building.bouc_wen_exponent,
                                    o->building.degradation.strength, o->building.degradation.stiffness};
    for (int j = 0; j < n; j++) {
        model->yield_m[j] = b->yield_m[j] > 0 ? b->yield_m[j] : 1e300;
        model->yield_n_m[j] = b->yield_n_m[j];
    }
    TRY(contact_make(model->contact, &o->contact, err));
    for (int j = 1; j < n; j++)
        model->contact[j] = model->contact[0];
    for (int j = 0; j < model->n_pad; j++) {
        model->gap[j] = 1e300;
        model->middle[j] = 0;
    }
    return core && gaps ? model_set_gaps(model, gaps, gaps, err) : STATUS_OK;
}

void model_add_mass(SimModel *model, double mass)
{
    const int i = model->m++;
    model->nc++;
    model->has_mass = 1;
    model->m_pad = padded(model->m);
    memset(model->R + (size_t)i * (size_t)model->n_pad, 0,
           sizeof(double) * (size_t)((model->m_pad - i) * model->n_pad));
    for (int k = i; k < model->m_pad; k++) {
        model->omega[k] = k > i;
        model->zeta[k] = k > i ? 0.5 : 0;
        model->gamma[k] = k > i ? 0 : sqrt(mass);
    }
    for (int j = 0; j < model->n_pad; j++)
        for (int k = 0; k < model->m_pad; k++)
            model->RT[j * model->m_pad + k] = model->R[k * model->n_pad + j];
}

void model_add_device(SimModel *model, const Device *device, int on_mass)
{
    const int e = model->n_devices++, last = model->m - 1;
    const double *row = model->RT + (size_t)device->floor * (size_t)model->m_pad;
    double *b = model->B + (size_t)e * (size_t)model->m_pad;
    model->device[e] = *device;
    for (int i = 0; i < model->m_pad; i++)
        b[i] = !on_mass ? row[i] : i < model->nb ? centre_row(model, i)[device->floor] : 0;
    if (on_mass)
        b[last] = -1 / model->gamma[last];
}

void model_add_uplift(SimModel *model, const CoreBeam *core)
{
    const int own = model->nc > 0;
    double *b = model->B + (size_t)model->n_devices * (size_t)model->m_pad;
    if (core->uplift.theta_up == 0)
        return;
    model->may_lift = 1;
    model->device[model->n_devices++] = (Device){.floor = -1, .lifts = core->uplift, .exponent = 1};
    memset(b, 0, (size_t)model->m_pad * sizeof *b);
    for (int i = own ? model->nb : 0; i < model->m; i++)
        for (int j = 0; j < core->n; j++) /* R is -phi of the core's own modes. */
            b[i] += (own ? -1 : 1) * core->base_rotation[j] * model->R[i * model->n_pad + j];
}

void model_report_devices(const SimModel *model, const DevicePeak peak[], SimResult *result)
{
    const int n = model->n_devices - model->may_lift;
    for (int e = 0; e < n; e++) {
        result->device[model->has_mass && e + 1 == n ? FLOORS_MAX : model->device[e].floor] = peak[e];
        result->stroke_m = fmax(result->stroke_m, peak[e].stroke);
        result->dashpot_n = fmax(result->dashpot_n, peak[e].force);
    }
}

void model_plastic_forces(const SimModel *model, const double p[], double f[])
{
    for (int j = 0; j < model->n; j++)
        f[j] = model->yield_n_m[j] * p[j] - (j + 1 < model->n ? model->yield_n_m[j + 1] * p[j + 1] : 0);
}

void model_report_plastic(const SimModel *model, const double p[], SimResult *r)
{
    double f[FLOORS_MAX], u[FLOORS_MAX] = {0};
    model_plastic_forces(model, p, f);
    for (int i = 0; i < model->nb; i++) { /* the floors at rest: sum_i R_ij (R_i f) / w_i^2 */
        const double *row = centre_row(model, i);
        double load = 0;
        for (int j = 0; j < model->n; j++)
            load += row[j] * f[j];
        for (int j = 0; j < model->n; j++)
            u[j] += row[j] * load / (model->omega[i] * model->omega[i]);
    }
    r->yields = 1;
    for (int j = 0; j < model->n; j++) {
        r->plastic_drift_m[j] = p[j];
        r->residual_drift_m[j] = u[j] - (j > 0 ? u[j - 1] : 0);
        if (model->yield_n_m[j] > 0)
            r->ductility = fmax(r->ductility, r->peak_drift_m[j] / model->yield_m[j]);
    }
}

void model_report_peaks(const SimModel *model, const double *const of[POINT_PEAKS], SimResult *r)
{
    FloorPeaks *beside = &r->neighbour;
    double *const floors[2][POINT_PEAKS] = {
        {r->peak_displacement_m, r->peak_drift_m, r->peak_acceleration_g, r->peak_filtered_g},
        {beside->displacement_m, beside->drift_m, beside->acceleration_g, beside->filtered_g}};
    double *const largest[2][POINT_PEAKS] = {{&r->j1_m, &r->j2_m, &r->j3_g, &r->j3_filtered_g},
                                             {&beside->j1_m, &beside->j2_m, &beside->j3_g, &beside->j3_filtered_g}};
    beside->n = model->neighbour_floors;
    for (int p = 0; p < model->points; p++) {
        const int j = p % (model->n + 1), at = model->neighbour_at && p >= model->neighbour_at;
        for (int y = 0; y < POINT_PEAKS && j < (at ? beside->n : model->n); y++)
            if (of[y]) {
                floors[at][y][j] = fmax(floors[at][y][j], y < 2 ? of[y][p] : of[y][p] / GRAVITY);
                *largest[at][y] = fmax(*largest[at][y], floors[at][y][j]);
            }
    }
}

void model_free(SimModel *model)
{
    free(model->store);
    memset(model, 0, sizeof *model);
}

/* Three vectors of floors from a pair of sums each: six chains of multiply-adds hide their latency. */
CLONED void rows_from_modes(const double rows[], int width, int first, int end, const double x[], double out[])
{
    const size_t stride = (size_t)width / 8;
    for (size_t block = 0; block < stride; block += 3) {
        const size_t b = block + 1 < stride ? 1 : 0, c = block + 2 < stride ? 2 : 0; /* 0: once more the first */
        const v8 *row = (const v8 *)rows + (size_t)first * stride + block;
        v8 a0 = {0}, b0 = {0}, c0 = {0}, a1 = {0}, b1 = {0}, c1 = {0};
        int i = first;
        for (; i + 2 <= end; i += 2, row += 2 * stride) {
            a0 += row[0] * x[i];
            b0 += row[b] * x[i];
            c0 += row[c] * x[i];
            a1 += row[stride] * x[i + 1];
            b1 += row[stride + b] * x[i + 1];
            c1 += row[stride + c] * x[i + 1];
        }
        if (i < end) {
            a0 += row[0] * x[i];
            b0 += row[b] * x[i];
            c0 += row[c] * x[i];
        }
        const v8 sum[3] = {a0 + a1, b0 + b1, c0 + c1};
        const size_t rest = stride - block < 3 ? stride - block : 3;
        memcpy(out + 8 * block, sum, rest * sizeof sum[0]);
    }
}
