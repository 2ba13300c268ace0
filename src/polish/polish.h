/* polish/polish.h -- one objective of one design lowered, the others kept, with NLopt on the true evaluation.
 *
 *   minimise f_improve(x)   while   f_k(x) <= kept_k for every kept k,   g(x) <= 0,   lower <= x <= upper
 *
 * Algorithms  cobyla (default), isres: constraints handed over; bobyqa, sbplx: constraints as a penalty
 * Guards      a failed evaluation is a finite wall, never NaN or Inf; the answer is the best allowed design that was
 *             seen, whatever NLopt returns; evaluations and seconds are counted here, not by NLopt
 * Start       its own evaluation counts as the first; it is always allowed, so the answer is never worse than it
 * Threads     evaluates one design at a time from the calling thread */
#ifndef IMTET_POLISH_POLISH_H
#define IMTET_POLISH_POLISH_H

#include <stdint.h>

#include "moga/problem.h"

typedef struct {
    const char *algorithm;
    size_t improve;            /* objective */
    const unsigned char *keep; /* (n_obj) */
    const double *slack;       /* (n_obj) [unit of f] a kept objective may be worse by this */
    const double *guess;       /* (n_var) where the method begins if it is allowed and better than the start; or NULL */
    size_t max_evals;
    double max_seconds; /* 0: no limit */
    uint32_t seed;
} PolishConfig;

typedef struct {
    size_t n_evaluated, n_failed;
    double seconds;
    double *x, *f, *f_start; /* (n_var) (n_obj) (n_obj): the caller's, filled */
} PolishResult;

/* Fails where the start itself cannot be evaluated. */
Status polish_run(const Problem *problem, const PolishConfig *config, const double start[], PolishResult *result,
                  Err *err);

#endif
