/* bench/stability/stability.h -- where methods fail: every engine is put through every case, a row of CSV for each cell.
 *
 * Each cell runs in a process of its own, as many at a time as there are processors: a crash is a failure of that cell,
 * no answer in time a refusal. A line per cell goes to standard output.
 *
 * Errors  an engine answers wrongly in silence, or the engine `fast` does anything but hold */
#pragma once

#include "bench/stability/trial.h"

typedef struct {
    TrialSize size;
    const char *engine, *one_case; /* NULL: all */
    const char *out;               /* the table as CSV; NULL: none */
    long seconds;                  /* of processor time for one cell; `fast` has 120 at least */
} StabilityPlan;

Status stability(const StabilityPlan *plan, Err *err);
