/* bench/schedule.h -- `imtet-bench schedule`: a finished run replayed on more workers than a machine has.
 *
 * Of the run, made with --threads 1, it takes how long each design was simulated, in equal tasks for its parts, which
 * answers had entered when each group of questions was made (RunGeneration.simulated), and what the search took from
 * group to group: the rest of the time. A worker that is free takes the next task; a group is made when the answers are
 * there, a part of that work by one processor, the rest by all that choose. efficiency: work over time and workers;
 * critical: time on any number of workers; choosing, idle: shares of the time. */
#pragma once

#include <stdio.h>

#include "base/status.h"

typedef struct {
    const char *folder; /* of the run */
    long from;          /* designs before what counts */
    long apart;         /* processors that choose beside the workers, which is no work then; 0: the workers do */
} SchedulePlan;

/* A row for 1, 2, 4, ... 64 workers and 14, as CSV. */
Status schedule(const SchedulePlan *plan, FILE *out, Err *err);
