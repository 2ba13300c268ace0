/* moga/nd_tree.h -- the nondominated of very many points, kept while points are added (ND-tree).
 *
 * A node holds points that lie near each other and bounds of them: no point is below `ideal` or above `nadir`. Most
 * nodes are passed over, or removed as a whole, by a look at their bounds; so that a point is compared with few others.
 * Bounds are not drawn in when points leave. Which points are nondominated does not depend on how they lie in the tree.
 *
 * Dominance  base/dominance.h; equal points do not dominate each other, all of them stay
 * Life cycle nd_tree_create -> nd_tree_insert ... -> nd_tree_free
 * Memory     grows with the points that are in, some 40 bytes each; the points themselves stay in F
 * Threads    one at a time
 * Errors     STATUS_NO_MEMORY
 * Source     Jaszkiewicz and Lust, ND-tree-based update: a fast algorithm for the dynamic nondominance problem,
 *            IEEE Trans. Evol. Comput. 22 (2018) 778-791 */
#pragma once

#include "base/status.h"

typedef struct NdTree NdTree;

Status nd_tree_create(NdTree **out, size_t n_obj, Err *err);
void nd_tree_free(NdTree *t); /* NULL is fine */

/* Row `row` of F (.., n_obj), whose rows must be the same in every call. is_in: no point dominates it; then the points
 * that it dominates are out, their rows in removed (n_removed), which holds until the next call. */
typedef struct {
    int is_in;
    size_t n_removed;
    const size_t *removed;
} NdChange;
Status nd_tree_insert(NdTree *t, const double F[], size_t row, NdChange *change, Err *err);
