/* moga/front_confidence.h -- which designs are nondominated, given that their objectives are known with an error.
 *
 *   p_i = P(no other design dominates design i)     objectives independent and normal: mean F, standard error `error`
 *
 * by FRONT_DRAWS draws of all designs at once: standard error root(p (1 - p) / FRONT_DRAWS), 0.016 at most. Designs that
 * are worse in an objective by six standard deviations are not asked whether they dominate. A design
 * may be on the front of the means and have a small p, and the other way round. Without errors p is 0 or 1.
 *
 * Threads  no state */
#ifndef IMTET_MOGA_FRONT_CONFIDENCE_H
#define IMTET_MOGA_FRONT_CONFIDENCE_H

#include <stddef.h>
#include <stdint.h>

#include "base/status.h"

enum { FRONT_DRAWS = 1000 };

/* Of the designs asked[0..n_asked) among n: minimised F (n, n_obj), error (n, n_obj), p (n_asked). */
Status front_confidence(size_t n, size_t n_obj, const double F[], const double error[], uint32_t seed, size_t n_asked,
                        const size_t asked[], double p[], Err *err);

#endif
