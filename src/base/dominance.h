/* base/dominance.h -- which design is better.
 *
 *   a dominates b   no worse in every objective and better in one
 *   ... surely      the same of a + its error and b - its error, one standard error of the means each: better by more
 *                   than both errors together, in every objective. Of equal errors that is 1.4 standard deviations of
 *                   the difference, 92 % in each objective; intervals that overlap decide nothing.
 *   constrained     a feasible design dominates an infeasible one, of two infeasible ones the less violating one
 *
 * All are strict partial orders (surely: a product of interval orders): transitive whatever the errors, and a dominated
 * design is dominated by a nondominated one. With errors of 0 surely is the same as plainly.
 *
 * Threads  pure functions
 * Sources  Deb, Pratap, Agarwal and Meyarivan, IEEE Trans. Evol. Comput. 6 (2002) 182-197 (constrained domination)
 *          Zhang, Tian, Cheng and Jin, IEEE Trans. Evol. Comput. 19 (2015) 201-213 (efficient nondominated sort)
 *          Fishburn, J. Math. Psychol. 7 (1970) 144-149 (interval orders)
 *          Teich, EMO 2001, LNCS 1993, 314-328 (Pareto fronts of objectives known as intervals). */
#pragma once

#include <stddef.h>

/* A NAN is worse than anything. */
static inline int is_no_worse(size_t n_obj, const double a[], const double b[])
{
    for (size_t k = 0; k < n_obj; k++)
        if (!(a[k] <= b[k]))
            return 0;
    return 1;
}

int dominates(size_t n_obj, const double a[], const double b[]);
int dominates_surely(size_t n_obj, const double a[], const double error_a[], const double b[], const double error_b[]);

/* violation: sum of max(0, g); 0 is feasible. */
int dominates_constrained(size_t n_obj, const double a[], double violation_a, const double b[], double violation_b);

/* Layers of F (n, n_obj), row-major: rank[i] = 0 of the nondominated, 1 of those that only rank 0 dominates, ...
 * Returns the number of layers. violation (n) may be NULL. scratch holds 3 n numbers. */
size_t nondominated_sort(size_t n, size_t n_obj, const double F[], const double violation[], size_t rank[],
                         size_t scratch[]);
