/* moga/control.h -- surrogate management: whether the surrogate is used, and how a batch is shared among criteria.
 *
 *   agreement     running mean of Kendall's tau between predicted and evaluated objectives of the batches. The
 *                 surrogate is used while it is above AGREEMENT_MIN. Small batches are taken together until they have
 *                 AGREEMENT_RESULTS_MIN results
 *   credit        two alternatives share a batch: infill and variation, or the criteria PBI and hypervolume. Running
 *                 means of each one's share of the gain, c_i, and of the designs, n_i, give its part of the next batch:
 *                   (c_i / n_i)^p / sum_j (c_j / n_j)^p         p = GENERATOR_POWER, CRITERION_POWER
 *                 The gain of a result is what it adds to the front that the generation began with, by both criteria
 *                 (infill_gain). Probability matching with a power: Thierens, GECCO 2005, 1539-1546
 *   probes        a find is a probe whose objectives, in their ranges, are better than predicted by PROBE_FIND in the
 *                 mean. The share of a batch is a running mean of PROBE_PAY for a find and 0 for any other probe: where
 *                 the surrogate is right along every variable there is little to probe
 *   failure rate  running mean of the share of infill designs that failed; variation gets that part at least
 *
 * Threads  pure functions of their arguments */
#ifndef IMTET_MOGA_CONTROL_H
#define IMTET_MOGA_CONTROL_H

#include "base/pack.h"
#include "evaluate/evaluation.h"
#include "moga/infill.h"

enum { AGREEMENT_RESULTS_MIN = 4 }; /* Kendall's tau of fewer says nothing */

enum { CRITERION_NONE = INFILL_KINDS }; /* of a probe, which no generator is credited with */

typedef enum { GENERATOR_INFILL, GENERATOR_VARIATION, GENERATORS } Generator;

/* Two alternatives: running means of their shares. */
typedef struct {
    double gain[2], designs[2];
} Credit;

/* Wall time of this session [s]. */
typedef struct {
    double waiting;   /* for simulations */
    double surrogate; /* fits, predictions, descents */
} SearchTimes;

typedef struct {
    double agreement, failure_rate;
    double probe_share;          /* of a batch, before it is kept within its bounds */
    Credit generators, criteria; /* by Generator, by InfillKind */
    SearchTimes times;           /* not part of the state */
    size_t n_kept;               /* results since agreement was judged last: */
    double *F, *predicted;       /* (AGREEMENT_RESULTS_MIN - 1 + results of a batch, n_obj) the caller's memory */
} SurrogateControl;

/* Results of a batch, and what was known of them when they were asked for. */
typedef struct {
    size_t n, n_obj;
    const double *F, *predicted;                                /* (n, n_obj) */
    const double *range;                                        /* (n_obj) of the objectives in the archive */
    const unsigned char *ok, *kind, *criterion, *was_predicted; /* (n) EvaluationKind; InfillKind of infill designs */
} BatchResults;

/* What the next batch of `size` designs is made of. */
typedef struct {
    size_t n_variation; /* the rest is infill */
    double hypervolume; /* share of the infill that is selected by INFILL_HYPERVOLUME, the rest by INFILL_PBI */
} BatchShares;

void control_begin(SurrogateControl *c);
void control_pack(SurrogateControl *c, Pack *p, size_t n_obj);

int control_agrees(const SurrogateControl *c); /* predictions have come true in their order */

/* n evaluations so far of n_var variables: before INFILL_ALONE n_var of them variation gets the failure rate alone. */
BatchShares control_batch_shares(const SurrogateControl *c, size_t size, size_t n, size_t n_var);

double control_probe_share(const SurrogateControl *c);

/* gain[] has measured the front that the generation began with. */
void control_judge(SurrogateControl *c, const BatchResults *r, Infill *const gain[INFILL_KINDS]);

#endif
