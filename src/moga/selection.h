/* moga/selection.h -- environmental selection: which designs form the next population.
 *
 *   1 layers of constrained nondominance fill the population until one does not fit whole
 *   2 objectives are normalised (moga/normalisation.h), each design is associated with the reference direction nearest
 *     to it
 *   3 from the layer that does not fit, designs are taken for the directions with the fewest members
 *
 * With aspiration levels (search.aspire) the designs that are least behind them, after those that violate less.
 *
 * Nothing is kept from one call to the next.
 *
 * Life cycle  selection_create -> selection_select ... -> free
 * Memory      all of it in selection_create, for at most n_max designs
 * Threads     one Selection per thread
 * Source      Deb and Jain (see moga/search.h). */
#pragma once

#include "base/random.h"
#include "moga/directions.h"

typedef struct Selection Selection;

/* Borrows the directions, and the aspiration levels (n_obj), NAN where there is none; NULL: of no objective. */
Status selection_create(Selection **out, size_t n_max, const Directions *directions, const double aspire[], Err *err);

/* Selects min(n, keep) of F (n, n_obj), violation (n) or NULL; selected holds their rows in ascending order. */
size_t selection_select(Selection *s, size_t n, const double F[], const double violation[], size_t keep, Random *random,
                        size_t selected[]);
