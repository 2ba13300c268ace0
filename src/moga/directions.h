/* moga/directions.h -- evenly spread reference directions: points of the simplex sum_k w_k = 1, w >= 0.
 *
 *   one layer   all w whose entries are multiples of 1/p: (p + m - 1 over m - 1) of them
 *   two layers  an outer one and a smaller inner one, shrunk by half towards the middle: in many objectives one layer
 *               either has only border points or far too many
 *
 * Life cycle  directions_create -> read W -> directions_free
 * Sources     Das and Dennis, SIAM J. Optim. 8 (1998) 631-657
 *             Deb and Jain (see moga/search.h), the two layers */
#pragma once

#include "base/status.h"

typedef struct {
    size_t n, n_obj;
    double *W; /* (n, n_obj) */
} Directions;

/* Divisions of the two layers, inner 0: one layer. For a population: the largest number of directions that it can fill,
 * but at least one per objective. */
void directions_choose(size_t n_obj, size_t population, size_t *outer, size_t *inner);

Status directions_create(Directions *d, size_t n_obj, size_t outer, size_t inner, Err *err);
/* n >= n_obj directions as far from each other as can be on the sphere, the axes among them: as dense in the middle as
 * on the border, for any n. */
Status directions_spread(Directions *d, size_t n_obj, size_t n, Err *err);
void directions_across(const Directions *d, double across[]); /* (n_obj, n) the same at length 1 */
void directions_free(Directions *d);
