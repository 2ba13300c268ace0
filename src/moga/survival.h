/* moga/survival.h -- who lives on: the environmental selection of NSGA-III, RVEA or MOEA/D.
 *
 * NSGA-III
 *   1 layers of constrained nondominance fill the next population until one does not fit whole
 *   2 objectives normalised (moga/frame.h), each design associated with its nearest reference direction
 *   3 from the layer that does not fit, designs are taken for the directions with the fewest members so far
 *
 * RVEA, MOEA/D
 *   feasible designs before infeasible ones; objectives normalised by their range among the feasible (which is what
 *   adapted vectors come to), then round after round every direction takes the design that is best for it:
 *   RVEA      of those nearest to it, the least |z| (1 + m progress^2 angle / angle to the next direction)
 *   MOEA/D    of all, the least d1 + 5 d2 (PBI)
 *   so that the first round is the method of the source and the next ones fill the population.
 *
 * Nothing is remembered from one call to the next.
 *
 * Life cycle  survival_create -> survival_select ... -> survival_free
 * Memory      all of it in survival_create, for at most n_max designs
 * Threads     one Survival per thread
 * Sources     Deb and Jain (see moga/search.h); Cheng, Jin, Olhofer and Sendhoff, IEEE Trans. Evol. Comput. 20 (2016)
 *             773-791 (RVEA); Zhang and Li, IEEE Trans. Evol. Comput. 11 (2007) 712-731 (MOEA/D). */
#ifndef IMTET_MOGA_SURVIVAL_H
#define IMTET_MOGA_SURVIVAL_H

#include "base/random.h"
#include "moga/directions.h"
#include "moga/options.h"

typedef struct Survival Survival;

/* Borrows the directions. */
Status survival_create(Survival **out, SurvivalKind kind, size_t n_max, const Directions *directions, Err *err);
void survival_free(Survival *s); /* NULL is fine */

/* Chooses min(n, keep) of F (n, n_obj), violation (n) or NULL; chosen holds their rows in ascending order. progress:
 * share of the search that is done, 0..1. */
size_t survival_select(Survival *s, size_t n, const double F[], const double violation[], size_t keep, double progress,
                       Random *random, size_t chosen[]);

#endif
