/* study/polish.h -- a weighted sum of objectives lowered from a given design on, by NLopt on the simulator itself.
 *
 *   minimise   value(x) = sum_k weight_k f_k(x) / scale_k      while  f_k(x) <= bound_k,  g(x) <= 0,  lower <= x <=
 *              upper
 *
 * Method    in the unit cube of the box; COBYLA (Powell 1994: linear models of every function), where nothing is
 *           bounded BOBYQA (Powell 2009: a quadratic model). One that has converged begins again at its best design,
 *           until two in a row gain no more than gain_min
 * Guards    a failed simulation is a finite wall, never NaN; the answer is the best allowed design that was seen,
 *           whatever NLopt returns, the start at worst; simulations are counted here
 * Repeats   both methods are deterministic
 * Threads   asks the queue for one design at a time */
#pragma once

#include "evaluate/queue.h"

typedef struct {
    const double *weight, *scale; /* (n_obj) */
    const double *bound;          /* (n_obj) INFINITY: free */
    size_t max_evals;
    double gain_min; /* of the value: less is not worth a descent */
} PolishGoal;

typedef struct {
    double *x, *f; /* (n_var) (n_obj) minimised: the start, which is allowed whatever it is, then the best */
    size_t n_evaluated, n_failed;
} Polished;

Status polish_run(Queue *queue, const PolishGoal *goal, Polished *p, Err *err);
