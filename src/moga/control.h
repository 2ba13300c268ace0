/* moga/control.h -- surrogate management: whether the surrogate is used, and how a batch is shared.
 *
 *   agreement     running mean of Kendall's tau between predicted and evaluated objectives of the batches. The
 *                 surrogate is used while it is above AGREEMENT_MIN. Small batches are taken together until they have
 *                 AGREEMENT_RESULTS_MIN results
 *   probes        a find is a probe whose objectives, in their ranges, are better than predicted by PROBE_FIND in the
 *                 mean. The share of a batch is a running mean of PROBE_PAY for a find and 0 for any other probe: where
 *                 the surrogate is right along every variable there is little to probe
 *   failure rate  running mean of the share of infill designs that failed: variation gets that part of a batch
 *
 * Threads  pure functions of their arguments */
#ifndef IMTET_MOGA_CONTROL_H
#define IMTET_MOGA_CONTROL_H

#include <stddef.h>

#include "base/pack.h"

enum { AGREEMENT_RESULTS_MIN = 4 }; /* Kendall's tau of fewer says nothing */

typedef struct {
    double agreement, failure_rate;
    double probe_share;    /* of a batch, where that is not too much */
    size_t n_kept;         /* results since agreement was judged last: */
    double *F, *predicted; /* (AGREEMENT_RESULTS_MIN - 1 + results of a batch, n_obj) the caller's memory */
} SurrogateControl;

/* Results of a batch, and what was known of them when they were asked for. */
typedef struct {
    size_t n, n_obj;
    const double *F, *predicted;                               /* (n, n_obj) */
    const double *range;                                       /* (n_obj) of the objectives in the archive */
    const unsigned char *ok, *kind, *is_probe, *was_predicted; /* (n) EvaluationKind */
} BatchResults;

void control_begin(SurrogateControl *c);
void control_pack(SurrogateControl *c, Pack *p, size_t n_obj);

int control_agrees(const SurrogateControl *c); /* predictions have come true in their order */

/* Children of variation in a batch of `size` designs, of which the rest is infill. */
size_t control_variation(const SurrogateControl *c, size_t size);

double control_probe_share(const SurrogateControl *c);

void control_judge(SurrogateControl *c, const BatchResults *r);

#endif
