/* report/convergence.h -- how the front grew: hypervolume after every generation of a run.
 *
 *   volume = share of the box [ideal, ideal + 1.1 span] of the last front that the designs so far dominate
 *
 * Up to three objectives it is exact (moga/hypervolume.h), else a share of uniform samples of the box, the same ones
 * for every generation, so that the curve never falls; with its standard error.
 *
 * Source     the run's database: generations that have finished; a design that failed or breaks a limit reaches nothing
 * Ownership  convergence_read allocates, convergence_free releases (an empty Convergence is fine) */
#ifndef IMTET_REPORT_CONVERGENCE_H
#define IMTET_REPORT_CONVERGENCE_H

#include "run/front.h"

typedef struct {
    size_t n_evaluated, n_failed;
    size_t n;                        /* generations */
    double *simulated;               /* (n) designs by the end of each */
    double *volume, *standard_error; /* (n) [-] */
} Convergence;

/* A run without a database is STATUS_OK and an empty Convergence. */
Status convergence_read(const Front *front, const char *folder, Convergence *out, Err *err);

/* generation (n) ascending, F (n, n_obj) minimised, NaN in a row that reaches nothing (counted as failed). */
Status convergence_of(size_t n, size_t n_obj, const double generation[], const double F[], const double ideal[],
                      const double span[], Convergence *out, Err *err);
void convergence_free(Convergence *c);

#endif
