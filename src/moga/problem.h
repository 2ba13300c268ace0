/* moga/problem.h -- what the search knows of the world: boxes, counts and one callback.
 *
 *   minimise f(x),  g(x) <= 0,  lower <= x <= upper
 *
 * The true simulator, a response surface and a textbook problem stand behind the same callback. Sets of points travel
 * together: row-major X (n, n_var), F (n, n_obj), G (n, n_con).
 *
 * Threads  evaluate shares a batch out over threads itself and stores by index: the answer does not depend on how many.
 * Errors   a design whose evaluation fails is ok[i] = 0 (F and G of that row are then meaningless); Status is for
 *          what ends the whole search. */
#ifndef IMTET_MOGA_PROBLEM_H
#define IMTET_MOGA_PROBLEM_H

#include <stddef.h>

#include "base/status.h"

/* draws (n): how many answers there are of each design already; where the problem is noisy the next one is a fresh draw.
 * NULL: none of any. */
typedef Status (*EvaluateFn)(size_t n, const double X[], const size_t draws[], double F[], double G[],
                             unsigned char ok[], void *user, Err *err);

/* Moves x into the set of designs that can be built at all (t_top <= t_base, say); NULL where the box is all. */
typedef void (*RepairFn)(double x[], void *user);

typedef struct {
    size_t n_var, n_obj, n_con;
    const double *lower, *upper; /* (n_var) */
    EvaluateFn evaluate;
    RepairFn repair;
    void *user;
    int is_noisy; /* the same design simulated again gives another answer */
} Problem;

#endif
