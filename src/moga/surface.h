/* moga/surface.h -- the response surface as the search uses it: built on the archive, asked for designs.
 *
 * Objectives and constraints are the outputs of one Rbf on the unit cube. Beyond `surrogate_max` simulated designs,
 * three quarters of the centres are those nearest to the front and the rest is spread evenly over the order of
 * simulation, which begins with the Latin hypercube. A mean of n answers has the n-th part of the nugget. Scales are
 * tuned again when the archive has grown by a tenth.
 *
 * Many variables  beyond RBF_DIM_MAX there never is a surface
 * Life cycle  surface_create -> (surface_fit -> surface_predict ...) ... -> surface_free
 * Threads     predictions are shared out over OpenMP threads and stored by index. */
#ifndef IMTET_MOGA_SURFACE_H
#define IMTET_MOGA_SURFACE_H

#include "moga/archive.h"
#include "moga/group.h"
#include "moga/infill.h"
#include "moga/problem.h"
#include "rbf/rbf.h"

typedef struct Surface Surface;

/* Borrows the problem. predict_max: most designs of one surface_predict. */
Status surface_create(Surface **out, const Problem *problem, size_t surrogate_max, size_t predict_max, Err *err);
void surface_free(Surface *s); /* NULL is fine */

/* Fits to the archive; `near` has measured its front. Too few designs for a surface: surface_stands is 0. */
Status surface_fit(Surface *s, const Archive *archive, Infill *near, Err *err);

/* Estimates of the centres among the archive's designs, from their leave-one-out errors (moga/spread.h). */
void surface_estimate(const Surface *s, Archive *archive);

void surface_drop(Surface *s); /* as if it had never been fitted */

/* Whether there is a surface and it explains enough of the objectives to be better than guessing. */
int surface_stands(const Surface *s);

/* Median leave-one-out error as a share of the objective's range, of the worst objective; NaN: no surface. */
double surface_error(const Surface *s);

/* Fills F and violation of the members first..n-1 of the group that are not simulated, and their uncertainty where
 * that is wanted: it costs a third more. */
void surface_predict(Surface *s, Group *group, size_t first, int with_uncertainty);

/* Designs lowered along directions of `near` by descent on the surface (resilient back-propagation), each from the row
 * of the archive that is best in its direction: X (n, n_var). */
void surface_descend(Surface *s, const Archive *a, const Infill *near, size_t n, const size_t directions[], double X[]);

/* What outlives a generation; the surface itself is fitted anew by the next surface_fit. */
void surface_pack(Surface *s, Pack *p);

#endif
