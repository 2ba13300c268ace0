/* report/history.h -- the response over time of a design and of the building without core, as the engine fast goes
 * through them: rows of sim/samples.h at every sample of the motion, until both displacements of a floor stay below 2 %
 * of their peak.
 *
 * Ownership  for track_free, also after an error */
#pragma once

#include "evaluate/scenario.h"
#include "sim/samples.h"

/* Of a history a page has at most so many points, and these energies. HISTORY_U: column of the first floor's
 * displacement. */
enum { HISTORY_POINTS = 3000, HISTORY_U = 2 };
extern const char *const ENERGY_KEYS[N_ENERGIES];

/* floor: from 0. x as for sim_run. A run that does not finish has no rows. */
Status history_run(const Scenario *scenario, SceneKind kind, const double x[], Track *out, Err *err);
Status histories_run(const Scenario *scenario, const double x[], int floor, Track out[2], Err *err);
