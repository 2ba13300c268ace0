/* report/history.h -- one response over time, as the engine fast goes through it: a floor's displacement and where
 * the input energy has gone so far.
 *
 * sim/samples.h says which energies.
 * Instants   every sample of the motion, from t = 0
 * Ownership  history_run allocates, history_free releases (an empty History is fine) */
#pragma once

#include "evaluate/scenario.h"
#include "sim/samples.h"

typedef struct {
    size_t n;
    double dt_s;
    double *t, *u;              /* (n) [s], [m] of the floor relative to the ground */
    double *energy[N_ENERGIES]; /* (n) [J] */
} History;

/* floor: from 0. x as for sim_run. A run that does not finish gives an empty History. */
Status history_run(const Scenario *scenario, SceneKind kind, const double x[], int floor, History *out, Err *err);
void history_free(History *h);
