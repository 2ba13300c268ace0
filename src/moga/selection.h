/* moga/selection.h -- environmental selection: which designs form the next population.
 *
 *   SELECTION_NSGA3   1 layers of constrained nondominance fill the population until one does not fit whole
 *                     2 objectives are normalised (moga/normalisation.h), each design is associated with the reference
 *                       direction nearest to it
 *                     3 from the layer that does not fit, designs are taken for the directions with the fewest members
 *   SELECTION_RVEA    feasible designs before infeasible ones; objectives normalised by their range among the feasible,
 *                     which is what adapted reference vectors come to; then round after round every direction takes,
 *                     of the designs associated with it, the one with the smallest
 *                       |z| (1 + m progress^2 angle / angle to the next direction)
 *                     The first round is RVEA, the next ones fill the population. Better than NSGA-III where no
 *                     surrogate is used, equal where one is (docs/search.md)
 *
 * Nothing is kept from one call to the next.
 *
 * Life cycle  selection_create -> selection_select ... -> selection_free
 * Memory      all of it in selection_create, for at most n_max designs
 * Threads     one Selection per thread
 * Sources     Deb and Jain (see moga/search.h); Cheng, Jin, Olhofer and Sendhoff, IEEE Trans. Evol. Comput. 20 (2016)
 *             773-791 (RVEA). */
#ifndef IMTET_MOGA_SELECTION_H
#define IMTET_MOGA_SELECTION_H

#include "base/random.h"
#include "moga/directions.h"
#include "moga/options.h"

typedef struct Selection Selection;

/* Borrows the directions. */
Status selection_create(Selection **out, SelectionKind kind, size_t n_max, const Directions *directions, Err *err);
void selection_free(Selection *s); /* NULL is fine */

/* Selects min(n, keep) of F (n, n_obj), violation (n) or NULL; selected holds their rows in ascending order. progress:
 * share of the search that is done, 0..1. */
size_t selection_select(Selection *s, size_t n, const double F[], const double violation[], size_t keep,
                        double progress, Random *random, size_t selected[]);

#endif
