/* evaluate/replicates.h -- one design simulated several times, changed a little: the only rule for it.
 *
 *   replicate 0 is the design, replicate k has every gap changed: max(gap (1 + REPLICATE_CHANGE z) + tolerance z', 0),
 *   z and z' standard normal from the stream (seed, k): the same errors for every design, so that differences between
 *   designs are theirs. With sim.uncertain it is also built otherwise (AsBuilt): restitution r + sd z, a factor exp(s
 *   z - s^2/2), s^2 = log(1 + sd^2), of mean 1 and standard deviation sd, for stiffnesses and damping ratios; a
 *   stream of their own
 *
 *   of one record   mean and standard deviation (n - 1) over the replicates (base/stat.h)
 *   worst           of several records: the mean of the record that is worst in that result, with its deviation
 *   mean            mean over the records, with the root mean square of their deviations
 *   mean_plus_sd    all replicates of all records: mean and standard deviation on the bad side of it
 *   quantile        of all replicates of all records, on the bad side, linear between ranks
 *   cvar            conditional value at risk: mean of the worst share of all replicates of all records, the last of
 *                   them counted in part (Rockafellar and Uryasev, J. Risk 2 (2000) 21-41)
 *   chances         (evaluate/measures.h) mean and deviation of all, by every rule
 *
 * Standard errors of these numbers, of records drawn from those that could come, are by the bootstrap: the deviation
 * over BOOTSTRAP suites of as many records, drawn with replacement by a stream of their own; of one record NAN
 * (Efron, Ann. Statist. 7 (1979) 1-26). That of the worst is a lower bound, for no suite has a worse record.
 *
 * Two standard deviations that differ by orders of magnitude have two names. Predictability: no tolerance, nothing
 * uncertain; replicates differ by chaos alone (after some hundreds of impacts even the smallest change may have made
 * another run of it). As built: gap tolerance or sim.uncertain. A design with a replicate that failed has failed.
 *
 * Threads  pure functions */
#pragma once

#include "evaluate/measures.h"
#include "scene/design.h"
#include "sim/as_built.h"

enum { TOWER_RECORDS_MAX = 64 }; /* of one design */

/* Small against anything that could be built. */
static const double REPLICATE_CHANGE = 1e-8;

/* x becomes replicate k; its first n_gaps numbers are gaps [m] of one side, of which none gets negative. */
void replicate_design(uint32_t seed, int is_left, size_t k, double tolerance_m, size_t n_gaps, double x[]);

/* Perturbs the gaps of a design. Both sides of a floor change alike where they are one variable, else separately. */
void replicate_gaps(uint32_t seed, size_t k, double tolerance_m, const DesignSpace *s, Design *d);

/* Says how replicate k is built; 0: as designed. */
AsBuilt replicate_as_built(uint32_t seed, size_t k, const UncertainOptions *u);

/* "as built", or "predictability": what the deviation of replicates is. */
const char *spread_word(double tolerance_m, const UncertainOptions *u);

typedef struct {
    size_t n_records, n_replicates;
    Robust rule;
    double quantile;    /* of ROBUST_QUANTILE; of ROBUST_CVAR: where its tail begins */
    const char *spread; /* spread_word of the replicates; NULL: not known */
} ReplicatePlan;

typedef struct {
    size_t shown;              /* the part that failed first, else 0: the design under the first record */
    Outcome outcome;           /* of that part */
    const char *rule, *spread; /* what `mean` is, "mean" or the rule of several records; of the plan */
    size_t n_records, n_replicates, n_failed; /* n_replicates of each record; n_failed of all simulations */
    double mean[N_MEASURES], sd[N_MEASURES];  /* natural; not finite where a simulation failed; sd NAN: one replicate */
    double error[N_MEASURES];                 /* standard errors; NAN: one record, or not asked for */
    double seconds;                           /* of all simulations */
} ReplicateSummary;

/* Plans the replicates of a study whose simulations have these options. */
ReplicatePlan replicate_plan(const SimOptions *o, size_t n_records);

/* SimResult.rate_per_year [1/year] under a record (motion/suite.h): its own, times the records of which a mean
 * is taken; 0: not known. */
double replicate_rate(const ReplicatePlan *plan, const char *record);

enum { BOOTSTRAP = 200 };

/* parts (n_replicates, n_records), each of `size` bytes that begin with its Measured numbers. wants_errors 0: error is
 * NAN. */
void replicates_summarise(const ReplicatePlan *plan, const void *parts, size_t size, int wants_errors,
                          ReplicateSummary *out);

/* The Measured numbers of part i. */
static inline const Measured *measured_part(const void *parts, size_t size, size_t i)
{
    return (const void *)((const char *)parts + i * size);
}

/* v (n), sorted by this call: mean_plus_sd, quantile or cvar, sense +1: large values are bad. sd NAN: one value. */
double robust_pooled(const ReplicatePlan *plan, double sense, size_t n, double v[], double *sd);
