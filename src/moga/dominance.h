/* moga/dominance.h -- who is better than whom.
 *
 *   a dominates b   no worse in every objective and better in one
 *   constrained     a feasible design beats an infeasible one, of two infeasible ones the less violating wins
 *
 * Threads  pure functions
 * Sources  Deb, Pratap, Agarwal and Meyarivan, IEEE Trans. Evol. Comput. 6 (2002) 182-197 (constrained domination);
 *          Zhang, Tian, Cheng and Jin, IEEE Trans. Evol. Comput. 19 (2015) 201-213 (efficient nondominated sort). */
#ifndef IMTET_MOGA_DOMINANCE_H
#define IMTET_MOGA_DOMINANCE_H

#include <stddef.h>

int dominates(size_t n_obj, const double a[], const double b[]);

/* violation: sum of max(0, g); 0 is feasible. */
int dominates_constrained(size_t n_obj, const double a[], double violation_a, const double b[], double violation_b);

double violation_of(size_t n_con, const double g[]);

/* Layers of F (n, n_obj), row-major: rank[i] = 0 for the nondominated, 1 for those that only they dominate, ...
 * Returns the number of layers. violation (n) may be NULL. scratch holds 3 n numbers. */
size_t nondominated_sort(size_t n, size_t n_obj, const double F[], const double violation[], size_t rank[],
                         size_t scratch[]);

#endif
