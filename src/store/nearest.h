/* store/nearest.h -- where no design meets search.limits: those that miss them least.
 *
 *   violation   sum over the limits of max(0, excess / |limit|), as the search ranks designs without a feasible one
 *
 * nearest.csv has them, best first: id, violation, variables, objectives. */
#ifndef IMTET_STORE_NEAREST_H
#define IMTET_STORE_NEAREST_H

#include "store/run.h"

enum { NEAREST_MAX = 10 };

/* Rows of the run with the least violation, the least first, ties by number; none that is screened only. Returns how
 * many; 0: all of those failed. */
size_t nearest_rows(const Run *run, size_t rows[NEAREST_MAX]);

/* folder/nearest.csv; with n = 0 it is removed: a run that was resumed may have a front now. */
Status nearest_write(const char *folder, const Run *run, size_t n, const size_t rows[], Err *err);

#endif
