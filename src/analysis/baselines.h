/* analysis/baselines.h -- what a design is compared with: the building alone, and linear uses of the same core.
 *
 *   no core            the building alone
 *   rigidly connected  floors and core without gaps, in the modes of both with the building's damping ratios
 *   tuned mass damper  no core, but its mass on a spring and a dashpot at the roof; frequency and damping optimized
 *   viscous links      the core, and a dashpot between it and every floor; one constant, optimized
 *
 * under the records of the study and by its rule (sim.robust): worst or mean, without replicates. Devices are found
 * by analysis/device.h.
 *
 * Threads  tasks of the queue; the numbers do not depend on how many workers there are */
#pragma once

#include "analysis/device.h"
#include "evaluate/tower.h"

typedef enum { BASELINE_NO_CORE, BASELINE_RIGID, BASELINE_TMD, BASELINE_LINKS, N_BASELINES } BaselineKind;

typedef struct {
    LinearDevice device;      /* as it was found */
    Outcome outcome;          /* of all records together */
    double value[N_MEASURES]; /* over the records; natural; NAN: it failed */
    SimResult first;          /* under the first record, or the one under which it failed */
} Baseline;

const char *baseline_words(BaselineKind kind); /* "tuned mass damper" */
const char *baseline_key(BaselineKind kind);   /* "tmd" */

/* Its device in words, "0.241 Hz, damping 0.13"; empty where it has none. */
enum { DEVICE_TEXT_MAX = 64 };
void baseline_device_text(BaselineKind kind, const LinearDevice *device, char text[DEVICE_TEXT_MAX]);

/* x (n_var): the design, for its core. p: of a tower. Those up to `last`; what is behind it has failed. */
Status baselines_find(const Problem *p, const double x[], BaselineKind last, Baseline out[N_BASELINES], Err *err);
