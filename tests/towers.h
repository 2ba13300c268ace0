/* tests/towers.h -- one simulation of the tower that settings describe. */
#pragma once
#include "check.h"
#include "evaluate/tower.h"

static inline SimResult simulated_as(SceneKind kind, const Settings *s, const double x[])
{
    OWNED(problem_close) Problem p;
    SimResult r;
    CHECK_OK(tower_open(&p, s, TOWER_SINGLE, 1, &err), &err);
    CHECK_OK(tower_simulate(&p, 1, &(SimTask){.kind = kind, .x = x}, &r, &err), &err);
    return r;
}
