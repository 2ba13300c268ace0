/* report/importance.h -- which variables matter for which objective: total Sobol indices on an interpolant of the run.
 *
 *   T_jk = E_{x without x_j} Var_{x_j} f_k / Var f_k
 *        ~ 1/(2 N) sum_i (f_k(A_i) - f_k(A_i with B_ij in place j))^2 / Var f_k      A, B (N, n_var) uniform
 *
 * the share of the variance of objective k that x_j has a part in, alone or with others; the sum over j exceeds 1 where
 * variables act together. f is the RBF interpolant (rbf/rbf.h) of at most CENTRES designs that are spread evenly over
 * the order of evaluation; x is uniform between the least and the largest value of every variable that was evaluated.
 *
 * Error      where `explained` is small, the interpolant does not know the objective, nor its indices; the sampling
 *            error of an index is about sqrt(2 / N) of it
 * Ownership  importance_of allocates, importance_free releases (an empty Importance is fine)
 * Source     Jansen, Comput. Phys. Commun. 117 (1999) 35-43; Saltelli et al., Comput. Phys. Commun. 181 (2010)
 *            259-270 */
#pragma once

#include "store/run.h"

typedef struct {
    size_t n_centres;  /* 0: too few designs succeeded, nothing below is there */
    double *explained; /* (n_obj) leave-one-out R2 */
    double *total;     /* (n_obj, n_var) T; NAN: the objective does not vary */
} Importance;

Status importance_of(const Run *run, Importance *out, Err *err);
void importance_free(Importance *m);
