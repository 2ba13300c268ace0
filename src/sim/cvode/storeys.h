/* sim/cvode/storeys.h -- storeys that yield, for a step-by-step engine that locates events.
 *
 * Beside q and q' the integrator has for every storey p [m], its plastic drift, and W [J], the work int k z d' dt that
 * its yielding part has taken (sim/storey.h). A bilinear storey yields while its flag is up: the flag rises where |z|
 * reaches the yield drift and falls where d' changes its sign, and between the two its rates are smooth.
 *
 * Threads  no state but the struct */
#pragma once

#include "sim/model.h"
#include "sim/result.h"

typedef struct {
    const SimModel *model;
    int side[FLOORS_MAX]; /* bilinear: 0 elastic, else the sign of z while it yields */
} Storeys;

/* Drifts (n) of the floors of q, or their rates of q'. */
void storeys_drifts(const SimModel *model, const double q[], double d[]);

/* Adds the modal forces k p to g. */
void storeys_add(const SimModel *model, const double p[], double g[]);

/* p' and W' at the drifts d and their rates d'. */
void storeys_rates(const Storeys *s, const double d[], const double d_dot[], const double p[], const double W[],
                   double p_dot[], double W_dot[]);

/* Bilinear, at the end of a step: flags whose root was found, or whose event was passed by. Whether any changed. */
int storeys_switch(Storeys *s, const double z[], const double d_dot[], const int found[]);

/* Adds hysteresis_j of a run that ended with p, W and the drifts d, and to kinetic_strain_j by how much the energy of
 * the modes, K u'u / 2, is more than is there. */
void storeys_energies(const SimModel *model, const double d[], const double p[], const double W[], SimResult *result);
