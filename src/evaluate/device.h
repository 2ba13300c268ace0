/* evaluate/device.h -- the tuned mass, or the dashpots, that do best in the place of a core that impacts.
 *
 *   goal = J1 / J1_0 + J2 / J2_0 + J3 / J3_0          _0: the building alone, every J over the records by the same rule
 *
 * is minimised: first a grid, for the tuned mass with Warburton's optimum for white noise in it, then Nelder and Mead
 * from its best point. The simulations end with the strong part of each record: peaks lie in it, and the device that
 * does best is the same.
 *
 * Source   G. B. Warburton, Earthquake Eng. Struct. Dyn. 10 (1982) 381-401
 * Threads  those of the integrators */
#pragma once

#include "evaluate/replicates.h"
#include "evaluate/scenario.h"

/* A scene and an integrator of it. */
typedef struct {
    const Scenario *scenario;
    SimWorker *worker;
} Shaken;

/* For the core of the design x (n_var) under n records, which `plan` combines without replicates. kind: SCENE_TMD or
 * SCENE_LINKS. */
Status device_find(const ReplicatePlan *plan, size_t n, const Shaken at[], SceneKind kind, const double x[],
                   LinearDevice *device, Err *err);

/* [s] Until ARIAS of int a^2 dt has passed, and PERIODS of the building, whose first is `period`. All of a motion with
 * forces on floors. */
double device_strong_part(const Motion *m, double period);

/* f1 and damping of a tuned mass on an undamped structure of frequency hz under white noise at the base; mu: ratio of
 * masses. */
LinearDevice warburton_device(double hz, double mu);
