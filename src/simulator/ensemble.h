/* simulator/ensemble.h -- an objective is a number with a spread: the same design many times, its gaps changed a little.
 *
 *   x^(0) = x,   gap_j^(k) = gap_j (1 + change z_jk),  k = 1..n-1,  z standard normal from the stream (seed, k)
 *
 * After some hundreds of impacts the members have parted: what they share is the answer, what they do not share is its
 * spread. Mean and standard deviation (n - 1) over the members that finished.
 * Threads  the members are shared out over the crew; the numbers do not depend on how many threads it has */
#ifndef IMTET_SIMULATOR_ENSEMBLE_H
#define IMTET_SIMULATOR_ENSEMBLE_H

#include "simulator/crew.h"
#include "simulator/measures.h"

typedef struct {
    int members, finished;
    double mean[N_MEASURES], spread[N_MEASURES]; /* spread NaN where fewer than two finished */
} Ensemble;

/* The change that is used unless told: small against anything that could be built. */
static const double ENSEMBLE_CHANGE = 1e-8;

/* One design x (n_floors + 2); first, where not NULL, gets the response of the design itself. */
Status ensemble_run(Crew *crew, int n_floors, const double x[], int members, double change, uint32_t seed,
                    Ensemble *out, SimResult *first, Err *err);

#endif
