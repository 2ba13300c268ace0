/* report/history.h -- one response over time, as the engine fast goes through it: a floor's displacement and where
 * the input energy has gone so far.
 *
 *   input = kinetic + strain (building) + core (kinetic and strain) + damped_building + damped_core + contacts
 *
 * at every instant; contacts: lost in impacts, stored in them, taken by the tension clamp.
 * Instants   every sample of the motion, from t = 0
 * Ownership  history_run allocates, history_free releases (an empty History is fine) */
#ifndef IMTET_REPORT_HISTORY_H
#define IMTET_REPORT_HISTORY_H

#include "evaluate/scenario.h"

typedef enum {
    ENERGY_KINETIC,
    ENERGY_STRAIN,
    ENERGY_DAMPED_BUILDING,
    ENERGY_CORE,
    ENERGY_DAMPED_CORE,
    ENERGY_CONTACTS,
    ENERGY_INPUT,
    N_ENERGIES
} EnergyKind;

typedef struct {
    size_t n;
    double dt_s;
    double *t, *u;              /* (n) [s], [m] of the floor relative to the ground */
    double *energy[N_ENERGIES]; /* (n) [J] */
} History;

/* Of one sample; NAN where the engine has none. */
void history_energies(const SimSample *s, double energy[N_ENERGIES]);

/* floor: from 0. x as for sim_run. A run that does not finish gives an empty History. */
Status history_run(const Scenario *scenario, SceneKind kind, const double x[], int floor, History *out, Err *err);
void history_free(History *h);

#endif
