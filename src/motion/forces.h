/* motion/forces.h -- forces on the floors over time (blast, wind), beside the ground motion or in its place.
 *
 *   time_s,floor_01_n,floor_07_n     a CSV file: from 0 on, ascending, a column per floor with a force [N] to the
 *   0,0,0                            right (u > 0); linear between the rows, none after the last
 *   0.01,2e6,1e6
 *
 * Both are brought to one time step: the ground's, divided until it is no longer than the shortest distance of two rows
 * (ground at rest: that distance, at most STEP_MAX) and all rows are multiples of it, where that can be: else corners
 * move by less than a step, which Motion.warning says. A force that is not 0 in the last row falls to 0 within a step.
 *
 * Ownership  as of the Motion. Errors  STATUS_BAD_DATA with file, line and column. Threads  no state */
#pragma once

#include "motion/motion.h"

/* The rows of the file into m->force_rows, its hash into m->forces_hash. Forces that are all 0 are refused. */
Status forces_read(Motion *m, const char *path, Err *err);

/* m->force from m->force_rows, on a step for both; nothing where there are none. */
Status forces_place(Motion *m, Err *err);

/* [N] on floor j = 0.. at time t [s]. */
double motion_force(const Motion *m, int j, double t);
