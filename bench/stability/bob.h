/* bench/stability/bob.h -- models built by hand: independent masses, each on its own spring (or none) in front of a
 * wall.
 *
 * Floor j is one building mode; the core is one mode that cannot be moved, or one free mass that all floors hit. */
#pragma once

#include <math.h>
#include <string.h>

#include "bench/stability/need.h"
#include "sim/model.h"

typedef struct {
    double mass, omega, zeta; /* [kg] [rad/s] [-] */
    double gap;               /* [m] on both sides */
} Bob;

/* core_mass 0: a wall. The caller frees the model. */
static inline void bobs_model(SimModel *model, int n, const Bob bobs[], double core_mass, const Contact *contact)
{
    Err why = {0};
    const double core = core_mass > 0 ? 1 / sqrt(core_mass) : 1e-30;
    need(model_create(model, n, n, &why), &why);
    model->nb = n;
    model->nc = 1;
    model->m = n + 1;
    model->m_pad = (model->m + 7) & ~7;
    for (int j = 0; j < n; j++)
        model->contact[j] = *contact;
    memset(model->R, 0, sizeof(double) * (size_t)(model->m_pad * model->n_pad));
    memset(model->RT, 0, sizeof(double) * (size_t)(model->m_pad * model->n_pad));
    for (int i = 0; i < model->m_pad; i++) {
        model->omega[i] = i > n;
        model->zeta[i] = model->gamma[i] = 0;
    }
    model->omega[n] = 0;
    for (int j = 0; j < model->n_pad; j++) {
        model->gap[j] = 1e300;
        model->mass_eff[j] = 1e300;
    }
    for (int j = 0; j < n; j++) {
        const double own = 1 / sqrt(bobs[j].mass);
        model->omega[j] = bobs[j].omega;
        model->zeta[j] = bobs[j].zeta;
        model->gamma[j] = sqrt(bobs[j].mass);
        model->gap[j] = bobs[j].gap;
        model->mass_eff[j] = 1 / (own * own + core * core);
        model->R[j * model->n_pad + j] = model->RT[j * model->m_pad + j] = own;
        model->R[n * model->n_pad + j] = model->RT[j * model->m_pad + n] = -core;
    }
}
