/* study/goal.h -- the scalar problem of polishing, the same on the surrogate and the true evaluation:
 *
 *   minimise   value(x) = sum_k weight_k f_k(x)      while  f_k(x) <= bound_k,  g(x) <= 0,  lower <= x <= upper
 *
 * Methods work in the unit cube u of the box. */
#ifndef IMTET_STUDY_GOAL_H
#define IMTET_STUDY_GOAL_H

#include "evaluate/queue.h"

typedef struct {
    const double *weight; /* (n_obj) */
    const double *bound;  /* (n_obj) INFINITY: free */
} Goal;

double goal_value(const Goal *goal, size_t n_obj, const double f[]);

/* Every objective a number and every bound kept. */
int goal_holds(const Goal *goal, const Problem *problem, const double f[], const double g[]);

#endif
