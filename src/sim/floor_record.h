/* sim/floor_record.h -- accelerations of the floors sample by sample, from displacements h apart:
 *
 *   a_k = (u_k-1 - 2 u_k + u_k+1) / h^2 + ground      the mean of the acceleration, weighted by a triangle of
 *                                                     half-width h: no impact falls between two samples
 *
 * Life cycle  floor_record_create -> (floor_record_start -> floor_record_add ... -> floor_record_accelerations) ...
 *             -> free
 * Memory      grows with the longest run
 * Threads     one record per simulation under way */
#pragma once

#include "base/status.h"

typedef struct FloorRecord FloorRecord;

Status floor_record_create(FloorRecord **out, int n_floors, Err *err);
void floor_record_free(FloorRecord *f); /* NULL is fine */

/* A run from rest, samples every h [s]. */
void floor_record_start(FloorRecord *f, double h);

/* Where the displacements of the next sample go (n_floors padded to 8) [m]; ground acceleration [m/s2] there. NULL: no
 * memory. */
double *floor_record_add(FloorRecord *f, double ground);

double floor_record_step(const FloorRecord *f); /* [s] h */

/* a_k of every floor, row by row (n, width) [m/s2]; at both ends that of the ground. They hold until the next start.
 * Fails where there was no memory for the samples. */
Status floor_record_accelerations(FloorRecord *f, const double **rows, size_t *n, size_t *width, Err *err);
