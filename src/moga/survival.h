/* moga/survival.h -- who lives on: NSGA-III's environmental selection.
 *
 *   1 layers of constrained nondominance fill the next population until one does not fit whole
 *   2 objectives normalised (moga/frame.h), each design associated with its nearest reference direction
 *   3 from the layer that does not fit, designs are taken for the directions with the fewest members so far
 *
 * Nothing is remembered from one call to the next.
 *
 * Life cycle  survival_create -> survival_select ... -> survival_free
 * Memory      all of it in survival_create, for at most n_max designs
 * Threads     one Survival per thread
 * Source      Deb and Jain (see moga/search.h). */
#ifndef IMTET_MOGA_SURVIVAL_H
#define IMTET_MOGA_SURVIVAL_H

#include "base/random.h"
#include "moga/directions.h"

typedef struct Survival Survival;

/* Borrows the directions. */
Status survival_create(Survival **out, size_t n_max, const Directions *directions, Err *err);
void survival_free(Survival *s); /* NULL is fine */

/* Chooses min(n, keep) of F (n, n_obj), violation (n) or NULL; chosen holds their rows in ascending order. */
size_t survival_select(Survival *s, size_t n, const double F[], const double violation[], size_t keep, Random *random,
                       size_t chosen[]);

#endif
