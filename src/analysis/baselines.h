/* analysis/baselines.h -- what a design is compared with: the building alone, and linear uses of the same core.
 *
 *   no core            the building alone
 *   rigidly connected  floors and core without gaps
 *   tuned mass damper  no core, but its mass on a spring and a dashpot at the roof; frequency and damping optimized
 *   viscous links      the core, and a dashpot between it and every floor; one constant, optimized
 *
 * under the records of the study and by its rule (sim.robust): worst or mean, without replicates. The devices minimise
 *
 *   goal = J1 / J1_0 + J2 / J2_0 + J3 / J3_0          _0: the building alone, every J over the records by the same rule
 *
 * on a sketch (sim_sketch): the lowest MODES modes, steps of STEP, the motion until ARIAS of its intensity and three
 * periods more. First a grid, for the tuned mass with Warburton's optimum for white noise in it, then Nelder and Mead from
 * its best point. The results are those of all modes and the whole motion.
 *
 * Source   G. B. Warburton, Earthquake Eng. Struct. Dyn. 10 (1982) 381-401
 * Threads  shared out over the workers of the tower; the numbers do not depend on how many */
#ifndef IMTET_ANALYSIS_BASELINES_H
#define IMTET_ANALYSIS_BASELINES_H

#include "evaluate/tower.h"

typedef enum { BASELINE_NO_CORE, BASELINE_RIGID, BASELINE_TMD, BASELINE_LINKS, N_BASELINES } BaselineKind;

typedef struct {
    LinearDevice device;      /* as it was found */
    Outcome outcome;          /* of all records together */
    double value[N_MEASURES]; /* over the records; natural */
    SimResult first;          /* under the first record */
} Baseline;

const char *baseline_words(BaselineKind kind); /* "tuned mass damper" */
const char *baseline_key(BaselineKind kind);   /* "tmd" */

/* Its device in words, "0.241 Hz, damping 0.13"; empty where it has none. */
enum { DEVICE_TEXT_MAX = 64 };
void baseline_device_text(BaselineKind kind, const LinearDevice *device, char text[DEVICE_TEXT_MAX]);

/* x (n_var): the design, for its core. p: of a tower. Those up to `last`; what is behind it has failed. */
Status baselines_find(const Problem *p, const double x[], BaselineKind last, Baseline out[N_BASELINES], Err *err);

/* The device alone: kind TMD or LINKS; no_core: J1, J2, J3 of the building alone. */
Status baseline_tune(const Tower *t, size_t worker, BaselineKind kind, const double x[], const double no_core[3],
                     LinearDevice *device, Err *err);

/* f1 and damping of a tuned mass on an undamped structure of frequency hz under white noise at the base; mu: ratio of
 * masses. */
LinearDevice warburton_device(double hz, double mu);

#endif
