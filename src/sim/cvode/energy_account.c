#include "sim/cvode/energy_account.h"

#include "base/clones.h"

void energy_account_start(EnergyAccount *l, const SimModel *model)
{
    memset(l, 0, sizeof *l);
    l->model = model;
    l->peaks.n = model->points;
}

void energy_account_peaks(EnergyAccount *l, double t, const double q[], const double v[], const double contact[])
{
    const SimModel *model = l->model;
    PeakPoint *point = peak_monitor_next(&l->peaks);
    double pull[MODES_MAX], w[FLOORS_MAX];
    for (int i = 0; i < point_modes(model); i++)
        pull[i] = contact[i] - model->omega[i] * (2 * model->zeta[i] * v[i] + model->omega[i] * q[i]);
    point->t = t;
    points_from_modes(model, q, point->of[PEAK_DISPLACEMENT]);
    points_from_modes(model, pull, point->of[PEAK_ACCELERATION]);
    const int apart = model->U != model->R; /* else w is u beside the core */
    floors_from_modes(model, apart ? 0 : model->nb, model->m, q, w);
    for (int j = 0; j < model->n; j++)
        point->of[PEAK_RELATIVE][j] = (apart ? 0 : point->of[PEAK_DISPLACEMENT][j]) + w[j] - model->middle[j];
    peak_monitor_add(&l->peaks);
    devices_look(model, q, v, l->device);
}

/* Returns sum gamma q'. */
CLONED static double add_damping(const SimModel *model, double seconds, const double v[], double damped[])
{
    for (int i = 0; i < model->m; i++)
        damped[i] += seconds * (2 * model->zeta[i] * model->omega[i] * v[i] * v[i]);
    return dot_product(model->m, model->gamma, v);
}

void energy_account_add(EnergyAccount *l, double seconds, const double v[], double a, const ContactPower *power)
{
    l->input -= seconds * a * add_damping(l->model, seconds, v, l->damped);
    l->input += seconds * power->pushed;
    l->lost += seconds * power->lost;
    l->clamp += seconds * power->clamp;
    l->devices += seconds * power->devices;
}

void energy_account_report(const EnergyAccount *l, const Contacts *c, const EngineOptions *options, const double q[],
                           const double v[], SimResult *result)
{
    const SimModel *model = l->model;
    result->steps = l->steps;
    result->force_evaluations = l->evaluations;
    result->impacts = c->impacts;
    memcpy(result->closings, c->closings, (size_t)c->model->n * sizeof *c->closings);
    result->v0_limited = c->floored;
    result->input_energy_j = l->input;
    result->contact_loss_j = l->lost;
    result->clamp_j = l->clamp;
    for (int i = 0; i < model->m; i++)
        result->kinetic_strain_j += 0.5 * (v[i] * v[i] + pow(model->omega[i] * q[i], 2));
    result->contact_stored_j = contacts_stored(c, q);
    result->device_loss_j = l->devices;
    model_report_devices(model, l->device, result);
    result->kinetic_strain_j += devices_look(model, q, v, NULL);
    const MatState mat = contacts_mat(c, q);
    result->kinetic_strain_j += mat.held;
    result->mat_rotation_rad = l->mat_turned;
    for (int j = 0; j < model->n && model->nc > 0; j++)
        result_add_approach(result, &model->contact[j], l->peaks.peak[PEAK_RELATIVE][j] - model->gap[j]);
    model_report_peaks(model,
                       (const double *const[]){l->peaks.peak[PEAK_DISPLACEMENT], l->peaks.peak[PEAK_DRIFT],
                                               l->peaks.peak[PEAK_ACCELERATION], NULL},
                       result);
    energy_balance_close(result, model->nb, model->like, model->nc, l->damped, mat.taken - mat.held);
    if (options->end_state) {
        memcpy(options->end_state, q, sizeof *q * (size_t)model->m);
        memcpy(options->end_state + model->m, v, sizeof *v * (size_t)model->m);
    }
}
