/* study/polish.h -- the goal of study/goal.h pursued with NLopt on the true evaluation.
 *
 * Algorithms  cobyla, isres: bounds handed over; bobyqa, sbplx: bounds as a penalty
 * Guards      a failed evaluation is a finite wall, never NaN or Inf; the answer is the best allowed design that was
 *             seen, whatever NLopt returns; evaluations and seconds are counted here, not by NLopt
 * Start       its own evaluation counts as the first; it is always allowed, so the answer is never worse than it
 * Threads     asks the queue for one design at a time */
#ifndef IMTET_STUDY_POLISH_H
#define IMTET_STUDY_POLISH_H

#include <stdint.h>

#include "study/goal.h"

typedef struct {
    const char *algorithm;
    Goal goal;
    size_t max_evals;
    double max_seconds; /* 0: no limit */
    uint32_t seed;
} PolishConfig;

typedef struct {
    size_t n_evaluated, n_failed;
    double *x, *f; /* (n_var) (n_obj): the caller's, filled */
} PolishResult;

/* Whether there is an algorithm of that name. */
Status polish_knows(const char *algorithm, Err *err);

/* Fails where the start itself cannot be evaluated. */
Status polish_run(Queue *queue, const PolishConfig *config, const double start[], PolishResult *result, Err *err);

#endif
