/* sim/floor_filter.h -- peak floor accelerations after a low-pass filter: what equipment feels, without the spike of
 * milliseconds that an impact makes.
 *
 *   a_k = (u_k-1 - 2 u_k + u_k+1) / h^2 + ground      exactly the mean of the acceleration, weighted by a triangle of
 *                                                     half-width h: no impact falls between two samples, and what lies
 *                                                     near 1/h Hz is not mistaken for a slow motion, sin^2(x)/x^2, x
 *                                                     = pi f h
 *   a_k - (a_k-1 - 2 a_k + a_k+1) / 12                takes that gain away again: 1 - O(x^4)
 *
 * then Butterworth of fourth order forward and backward (base/filter.h), gain 1 / (1 + (f/fc)^8), and the largest
 * magnitude, with a parabola through the largest sample and its neighbours. h <= 1 / (10 fc): at fc the gain is within
 * 0.2 % of that, and a motion at 1/h - fc is seen at fc with 0.6 % of its amplitude.
 *
 * The backward pass goes block by block, each with filter_padding rows of what follows: all that comes later changes it
 * by 6e-7 at most. It leaves out a block that cannot raise a peak: |z| <= sum|g| max|y|, y the forward pass, g the
 * filter's response to an impulse.
 *
 * Where accelerations are below max|z| / (4/3 (sum|g|)^2) samples may be left out, 4/3 the sum of the weights before
 * both passes.
 *
 * Life cycle  floor_filter_create -> (floor_filter_start -> floor_filter_add ... -> floor_filter_peaks) ... -> free
 * Memory      of one block, made by the first start; again where h changes
 * Threads     one filter per simulation under way */
#pragma once

#include "base/status.h"

typedef struct FloorFilter FloorFilter;

Status floor_filter_create(FloorFilter **out, int n_floors, double cutoff_hz, Err *err);
void floor_filter_free(FloorFilter *f); /* NULL is fine */

double floor_filter_spacing(double cutoff_hz); /* [s] most that samples may be apart */

/* Samples may be left out, but not within so many seconds of others: what the passes have of them is 8e-4 of it by
 * then. */
double floor_filter_memory(double cutoff_hz);

/* A run from rest, samples every h [s]. */
void floor_filter_start(FloorFilter *f, double h);

/* Can accelerations (n_floors) [m/s2] of no more than this raise no peak? */
int floor_filter_is_below(const FloorFilter *f, const double acceleration[]);

/* Samples were left out before the next one. */
void floor_filter_interrupt(FloorFilter *f);

/* Where the displacements of the next sample go (n_floors padded to 8) [m], until the next call; ground acceleration
 * [m/s2] there. NULL: no memory. */
double *floor_filter_add(FloorFilter *f, double ground);

/* Peak of every floor (n_floors) [m/s2]; the run is over then. Fails where there was no memory. */
Status floor_filter_peaks(FloorFilter *f, double peaks[], Err *err);
