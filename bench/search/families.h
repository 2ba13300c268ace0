/* bench/search/families.h -- problems to develop the search on, of other families than those in the program: shifted,
 * rotated, multimodal, degenerate, disconnected, constrained, failing, of mixed scales; 2 to 10 objectives, 4 to 40
 * variables in the unit cube. A third of them is kept aside: looked at when a development is over. Two
 * more of the deceptive kind are in no table: they were written to develop on where only one kept aside failed.
 *
 * Every objective is built on two kinds of parts, with constants drawn once per problem from a keyed stream:
 *   position   where on the front
 *   distance   >= 0, how far from it: a sphere, Rastrigin, Ackley, Rosenbrock or deceptive function of shifted, perhaps
 *              rotated variables, 0 at an inner point
 * or it is a convex quadratic of its own minimum (quadratics). Of mixed problems the last variables are whole numbers 0..10,
 * which stand for tenths, then choices of five words for 0, 3/4, 1/4, 1, 1/2: their distance's zero lies on these.
 *
 * Threads  pure functions of what family_open has made */
#pragma once

#include "evaluate/problem.h"

enum { FAMILY_VAR_MAX = 40, FAMILY_OBJ_MAX = 10, FAMILY_CON_MAX = 2 };

typedef struct {
    const char *name, *what;
    size_t n_var, n_obj, n_con;
    int is_aside; /* 2: in neither table, only where it is named (--problem); 3: in that of mixed problems (--mixed) */
} Family;

size_t family_count(void);
const Family *family(size_t i);

/* Released by problem_close. */
Status family_open(Problem *p, size_t i, Err *err);

/* f (n_obj) of x; returns the violation of the limits, INFINITY where the simulation fails. */
double family_evaluate(const Problem *p, const double x[], double f[]);

/* x (n_var) where no limit and no failure hinders it at the front, at the direction w (n_obj) of the simplex or at a
 * share 0..1 of a curve; of quadratics, which have no such variables, in their midst. Returns how many variables say
 * where on the front; the others hold the distance. */
size_t family_place(const Problem *p, const double w[], double share, double x[]);
