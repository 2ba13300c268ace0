/* report/convergence.h -- how the front grew: hypervolume after every generation of a run, as `imtet status` tells it.
 *
 *   volume = share of a box about the first sample that the designs so far dominate (moga/cover.h, results/README.md)
 *
 * The samples of the box are the same for every generation, so that the curve never falls; standard_error is that of a
 * share of so many samples.
 *
 * Source     the run's database: generations that have finished
 * Ownership  convergence_read allocates, convergence_free releases (an empty Convergence is fine) */
#ifndef IMTET_REPORT_CONVERGENCE_H
#define IMTET_REPORT_CONVERGENCE_H

#include <stddef.h>

#include "base/status.h"

typedef struct {
    size_t n_evaluated, n_failed;
    size_t n;                        /* generations */
    double *simulated;               /* (n) designs by the end of each */
    double *volume, *standard_error; /* (n) [-] */
} Convergence;

/* A run without a database is STATUS_OK and an empty Convergence. */
Status convergence_read(const char *folder, Convergence *out, Err *err);
void convergence_free(Convergence *c);

#endif
