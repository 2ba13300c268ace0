/* analysis/horizon.h -- predictability horizon: the time until two perturbed runs diverge.
 *
 * Two runs of the engine fast, gaps changed relatively by `change` in the second. Their distance is measured in energy:
 *   d(t)^2 = sum_i (dq_i'^2 + w_i^2 dq_i^2) / max_{s <= t} sum_i (q_i'^2 + w_i^2 q_i^2)
 * over all modes of building and core, at every sample of the motion. The predictability horizon is the first time at
 * which d exceeds a level. */
#pragma once

#include "evaluate/scenario.h"

enum { HORIZON_LEVELS = 4 };
static const double HORIZON_LEVEL[HORIZON_LEVELS] = {1e-6, 1e-4, 1e-2, 1e-1};

typedef struct {
    double end_s;                     /* length of the run */
    double reached_s[HORIZON_LEVELS]; /* first time with d above HORIZON_LEVEL; NaN: never */
    double distance_at_end;
} Horizon;

Status horizon_find(const Scenario *scenario, const double x[], double change, Horizon *out, Err *err);
