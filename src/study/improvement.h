/* study/improvement.h -- how far the front has come: IGD+ of what was known earlier from the front that is known now.
 *
 * Normalised by the ranges of the front that is known now (moga/igd.h), minimised; all designs that keep the limits count, which is
 * the same as their front. 0: the front has not moved since. No true front is needed, and none is claimed: a search
 * that stands still at the wrong place has 0 as well. */
#ifndef IMTET_STUDY_IMPROVEMENT_H
#define IMTET_STUDY_IMPROVEMENT_H

#include "moga/igd.h"
#include "moga/search.h"
#include "store/run.h"

/* Of the designs at 90 % of the evaluations against the front now; NAN: no front, or no design was known then. */
Status improvement_lately(const SearchView *v, double *igd, Err *err);

/* From the end of every generation to the search's last front: igd (run->n_generations), NAN where none was known or
 * there is no front. */
Status improvement_of_run(const Run *run, double igd[], Err *err);

/* Hypervolume that as many simulations again would gain (moga/convergence.h), NAN: nothing is known, or designs are finished at the end
 * (search.fidelity). */
Status improvement_expected(const Run *run, double *gain, Err *err);

#endif
