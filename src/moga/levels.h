/* moga/levels.h -- the whole evaluation of a design predicted from the cheap one, output by output:
 *
 *   y(x) = a + b y_cheap(x) + d(x)
 *
 * a and b by least squares over the designs that have both; d, what the line leaves, is an RBF interpolant of its own
 * over the coordinates of the surrogate, where the cheap level is biased: what it does not see differs from region to
 * region, and designs that were selected by it are better by it than they are. Where d explains nothing by its
 * leave-one-out errors, or there are more than RBF_DIM_MAX coordinates, it is 0.
 *
 * Source      Kennedy and O'Hagan, Biometrika 87 (2000) 1-13 (autoregression between levels)
 * Life cycle  levels_fit -> levels_predict ... -> levels_free
 * Threads     levels_fit uses OpenMP threads, of which its result does not depend; levels_predict one */
#pragma once

#include "evaluate/problem.h"

typedef struct Levels Levels;

/* x (n): designs (n_var) each; cheap, whole (n, n_out). n > 0. Where it fails *out is what there is of it, for
 * levels_free. */
Status levels_fit(Levels **out, const Problem *p, int is_biased, size_t n, size_t n_out, const double *const x[],
                  const double cheap[], const double whole[], Err *err);
void levels_free(Levels *q); /* NULL is fine */

void levels_predict(Levels *q, const double x[], const double cheap[], double y[]);
