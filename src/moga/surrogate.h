/* moga/surrogate.h -- the surrogate of the search: an RBF interpolant of the archive (rbf/rbf.h).
 *
 * Objectives and constraints are the outputs of one Rbf on the unit cube. A choice of L words has L - 1 coordinates
 * there: the words are the corners of a regular simplex of edge 1, so that any two of them are as far apart as the
 * bounds of a real variable (Hamming's distance), and each corner gets length scales of its own. Whole numbers are
 * rounded before they are predicted. Beyond `surrogate_max` designs three quarters of the centres are those nearest to
 * the front, the rest is spread evenly over the order of evaluation, which begins
 * with the Latin hypercube. A mean of n replicates has the n-th part of the nugget. Hyperparameters are tuned again
 * when the archive has grown by a tenth, beyond surrogate_max by a fifth.
 *
 *   chance   probability that a predicted design keeps every limit, each normal about its prediction with the local
 *            leave-one-out error, times that it succeeds: another Rbf on 1 where designs succeeded and 0 where they
 *            failed, of all designs (least-squares classification: Rasmussen and Williams, 6.5)
 *   clipped  a limit that is never below 0, and 0 where it is kept, is learned with a slope there: minus the distance
 *            from the nearest design that violates it; where it says no more than 0 and 1 these have their distance too
 *           (choices and whole numbers: Garrido-Merchan and Hernandez-Lobato, Neurocomputing 380 (2020) 20-35)
 *
 * Dimension   more than RBF_DIM_MAX coordinates: there is no surrogate
 * Life cycle  surrogate_create -> (surrogate_fit -> surrogate_predict ...) ... -> surrogate_free
 * Memory      all in surrogate_create
 * Threads     predictions and descents are shared out over OpenMP threads and stored by index */
#pragma once

#include "moga/archive.h"
#include "moga/infill.h"
#include "moga/population.h"
#include "evaluate/problem.h"
#include "rbf/rbf.h"

typedef struct Surrogate Surrogate;

/* How many coordinates a design has, and which: u (surrogate_dimension). */
size_t surrogate_dimension(const Problem *p);
void surrogate_coordinates(const Problem *p, const double x[], double u[]);

/* Borrows the problem. predict_max: most designs of one surrogate_predict. */
Status surrogate_create(Surrogate **out, const Problem *problem, size_t surrogate_max, size_t predict_max, Err *err);
void surrogate_free(Surrogate *s); /* NULL is fine */

/* Fits to the archive, whose front `near` has measured. Too few designs: surrogate_is_usable is 0. */
Status surrogate_fit(Surrogate *s, const Archive *archive, Infill *near, Err *err);
void surrogate_drop(Surrogate *s); /* as if it had never been fitted */

/* It is fitted, and its mean leave-one-out R2 over the objectives exceeds R2_MIN. */
int surrogate_is_usable(const Surrogate *s);

/* Share of the objectives with waves along single variables: their kernels have an additive part (rbf/rbf.h). */
double surrogate_waves(const Surrogate *s);

/* Median leave-one-out error as a share of the objective's range, of the worst objective; NAN: not fitted. */
double surrogate_error(const Surrogate *s);

/* Objectives and constraints that the last fit left out (rbf/rbf.h): their mean stands for them. */
size_t surrogate_left_out(const Surrogate *s);

/* F, violation and chance of the predicted members first..n-1, and where wanted their uncertainty, which costs a third
 * more; without it a limit is kept or not. A predicted failure is a violation. */
void surrogate_predict(Surrogate *s, Population *population, size_t first, int with_uncertainty);

/* Designs X (n, n_var) that lower a criterion along its reference vectors by descents on the surrogate, the first
 * n_first that of hypervolume, each from the design of the archive that is best for its vector; a point that violates
 * no limit is better than one that does. Choices stay, whole numbers are moved as if they were real and not rounded.
 * Resilient back-propagation: Riedmiller and Braun, ICNN 1993, 586-591. */
void surrogate_descend(Surrogate *s, const Archive *a, Infill *const select[], size_t n_first, size_t n,
                       const size_t vectors[], double X[]);

/* State that outlives a generation; surrogate_fit makes the rest. */
void surrogate_pack(Surrogate *s, Pack *p);
