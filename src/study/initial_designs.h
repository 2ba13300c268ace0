/* study/initial_designs.h -- initial designs: known ones that a search begins with.
 *
 *   search.start = RUN    the front of another run of the same variables, its polished designs too
 *                  FILE   a CSV with a column for every variable, in any order; further columns are not read
 *                  A, B   several of them, one behind the other
 *
 * Ownership  initial_designs_read allocates X (n, n_var), the caller frees it; none: NULL and 0
 * Errors     a column that is missing, a file that is not there: named */
#pragma once

#include "evaluate/problem.h"
#include "store/run.h"

/* where: the setting or option that names them, for messages. */
Status initial_designs_read(const char *where, const char *start, const Schema *schema, double **X, size_t *n,
                            Err *err);

/* Where devices are choices (design.devices), behind the n designs of X: links on every floor of the core of middle
 * thickness, and the mass of the thinnest core as a tuned mass, as far as the space has them. They are tuned as the
 * baselines of these cores are, and have their J1, J2, J3 (analysis/baselines.h). o: of the settings of p. */
Status initial_designs_of_devices(const Problem *p, const DesignOptions *o, double **X, size_t *n, Err *err);

/* Whether designs of the run have the variables of this schema. */
Status initial_designs_fit(const Run *run, const char *where, const Schema *schema, Err *err);
