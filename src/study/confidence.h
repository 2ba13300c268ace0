/* study/confidence.h -- with what probability designs of a noisy run are nondominated (moga/front_confidence.h): of all
 * designs that keep the limits each objective is its mean with its standard error, sd / root(replicates).
 *
 * Threads  no state */
#ifndef IMTET_STUDY_CONFIDENCE_H
#define IMTET_STUDY_CONFIDENCE_H

#include "store/run.h"

static const double CONFIDENT = 0.9; /* a design counts as confident from this probability on */

/* Of n rows of the run: p (n). NAN: the run is not noisy, the design's error is not known (one of its simulations failed, or
 * none of the run was repeated), or the row is none that was searched with (polished, infeasible). */
Status confidence_of_designs(const Run *run, size_t n, const size_t rows[], double p[], Err *err);

/* How many designs of the front are nondominated with the probability CONFIDENT or more, of *n_known whose probability
 * is known. */
Status confidence_of_front(const Run *run, size_t *n_confident, size_t *n_known, Err *err);

#endif
