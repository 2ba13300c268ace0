/* simulator/replicates.h -- one design simulated several times, its gaps changed: the only rule for it.
 *
 *   replicate 0 is the design, replicate k has every gap changed: max(gap (1 + REPLICATE_CHANGE z) + tolerance z', 0),
 *   z and z' standard normal from the stream (seed, k): the same errors for every design, so that differences between
 *   designs are theirs
 *
 *   of one record   mean and standard deviation (n - 1) over the replicates (base/stat.h)
 *   of several      worst: the mean of the record that is worst in that objective, with its deviation;
 *                   mean: mean over the records, with the root mean square of their deviations
 *
 * After some hundreds of impacts even the smallest change has made another run of it: what the replicates share is the
 * result, what they do not share is its standard deviation. A design with a replicate that failed has failed.
 *
 * Threads  pure functions */
#ifndef IMTET_SIMULATOR_REPLICATES_H
#define IMTET_SIMULATOR_REPLICATES_H

#include <stdint.h>

#include "simulator/measures.h"

/* Small against anything that could be built. */
static const double REPLICATE_CHANGE = 1e-8;

/* x becomes replicate k; its first n_gaps numbers are gaps [m], of which none gets negative. */
void replicate_design(uint32_t seed, size_t k, double tolerance_m, size_t n_gaps, double x[]);

typedef struct {
    size_t n_records, n_replicates;
    int takes_mean;    /* over the records; else the worst */
    MeasureSet judged; /* what is not finite there has failed */
} ReplicatePlan;

typedef struct {
    const SimResult *shown; /* the first that failed, else the design itself under the first record */
    Outcome outcome;
    const char *reason;
    size_t n_replicates, n_failed;           /* of each record; of all simulations */
    double mean[N_MEASURES], sd[N_MEASURES]; /* natural; not finite where a simulation failed; sd NAN: one replicate */
    double seconds;                          /* of all simulations */
} ReplicateSummary;

/* results (n_records, n_replicates); the summary points into them. */
void replicates_summarise(const ReplicatePlan *plan, const SimResult results[], ReplicateSummary *out);

#endif
