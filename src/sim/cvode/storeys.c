#include "sim/cvode/storeys.h"

void storeys_drifts(const SimModel *model, const double q[], double d[])
{
    double u[POINTS_MAX];
    points_from_modes(model, q, u);
    for (int j = 0; j < model->n; j++)
        d[j] = u[j] - (j > 0 ? u[j - 1] : 0);
}

void storeys_add(const SimModel *model, const double p[], double g[])
{
    double f[FLOORS_MAX];
    model_plastic_forces(model, p, f);
    for (int i = 0; i < model->nb; i++)
        for (int j = 0; j < model->n; j++)
            g[i] += centre_row(model, i)[j] * f[j];
}

void storeys_rates(const Storeys *s, const double d[], const double d_dot[], const double p[], const double W[],
                   double p_dot[], double W_dot[])
{
    const SimModel *model = s->model;
    const StoreyLaw *law = &model->storey_law;
    for (int j = 0; j < model->n; j++) {
        const double k = model->yield_n_m[j], y = model->yield_m[j], z = d[j] - p[j];
        W_dot[j] = k * z * d_dot[j];
        p_dot[j] = 0;
        if (k == 0)
            continue;
        if (law->kind == HYSTERESIS_BILINEAR)
            p_dot[j] = s->side[j] ? d_dot[j] : 0;
        else
            p_dot[j] = d_dot[j] * (1 - storey_slope(law, z / y, W[j] / (k * y * y), d_dot[j]));
    }
}

int storeys_switch(Storeys *s, const double z[], const double d_dot[], const int found[])
{
    const SimModel *model = s->model;
    int flipped = 0;
    for (int j = 0; j < model->n && model->storey_law.kind == HYSTERESIS_BILINEAR; j++) {
        const int side = s->side[j], sign = z[j] > 0 ? 1 : -1;
        if (!side && (found[j] || (fabs(z[j]) > model->yield_m[j] && sign * d_dot[j] > 0)))
            s->side[j] = sign;
        else if (side && (found[j] || side * d_dot[j] < 0))
            s->side[j] = 0;
        flipped |= s->side[j] != side;
    }
    return flipped;
}

void storeys_energies(const SimModel *model, const double d[], const double p[], const double W[], SimResult *result)
{
    for (int j = 0; j < model->n; j++) {
        const double k = model->yield_n_m[j], z = d[j] - p[j];
        result->hysteresis_j += W[j] - 0.5 * k * z * z;
        result->kinetic_strain_j -= 0.5 * k * (d[j] * d[j] - z * z);
    }
}
