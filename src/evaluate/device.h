/* evaluate/device.h -- the tuned mass, or the dashpots, that do best in the place of a core that impacts.
 *
 *   goal = J1 / J1_0 + J2 / J2_0 + J3 / J3_0          _0: the building alone, every J over the records by the same rule
 *
 * is minimised: on a grid, for the tuned mass with Warburton's optimum for white noise in it, then on finer ones, each
 * of the neighbours of the best point so far at half the distance. The simulations end with the strong part of each
 * record: peaks lie in it, and the device that does best is the same. Of many records the first grid sees a few, the
 * one that moves the building alone most and others evenly spread by that; what is about its best point is seen by all.
 *
 * Source   G. B. Warburton, Earthquake Eng. Struct. Dyn. 10 (1982) 381-401
 * Threads  points and records are tasks of the queue; the device does not depend on how many workers there are */
#pragma once

#include "evaluate/tower.h"

typedef struct {
    SceneKind kind;      /* SCENE_TMD or SCENE_LINKS */
    const double *x;     /* the design, for its core */
    size_t scene;        /* of the tower: the first of its records */
    LinearDevice device; /* is found */
} DeviceSearch;

/* All n side by side. p: of a tower. */
Status devices_find(const Problem *p, size_t n, DeviceSearch search[], Err *err);

/* f1 and damping of a tuned mass on an undamped structure of frequency hz under white noise at the base; mu: ratio of
 * masses. */
LinearDevice warburton_device(double hz, double mu);
