/* analysis/baselines.h -- what a design is compared with: every case of sim/cases.h but the first.
 *
 * Under the records of the study and by its rule (sim.robust): worst or mean, without replicates. Devices are found
 * by evaluate/device.h.
 *
 * Threads  tasks of the queue; the numbers do not depend on how many workers there are */
#pragma once

#include "evaluate/device.h"
#include "evaluate/tower.h"

typedef struct {
    LinearDevice device;      /* as it was found */
    Outcome outcome;          /* of all records together */
    double value[N_MEASURES]; /* over the records; natural; NAN: it failed */
    SimResult first;          /* under the first record, or the one under which it failed */
} Baseline;

/* x (n_var): the design, for its core. p: of a tower. out: by SceneKind; with_devices 0: without those whose device
 * would have to be found. What is left out has failed. */
Status baselines_find(const Problem *p, const double x[], int with_devices, Baseline out[N_SCENES], Err *err);
