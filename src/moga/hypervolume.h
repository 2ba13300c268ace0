/* moga/hypervolume.h -- volume of what a set dominates, up to a reference point.
 *
 *   exact     WFG: the sum over points of what each adds to those after it; exponential in the objectives
 *   estimate  share of uniform samples of the box lower..reference that is dominated, with its standard error
 *
 * Points that do not dominate the reference point add nothing; order does not matter.
 *
 * Memory   a workspace is allocated and released inside
 * Threads  the estimate shares its samples out over OpenMP threads; the answer does not depend on how many
 * Source   While, Bradstreet and Barone, IEEE Trans. Evol. Comput. 16 (2012) 86-95 (WFG). */
#ifndef IMTET_MOGA_HYPERVOLUME_H
#define IMTET_MOGA_HYPERVOLUME_H

#include <stddef.h>
#include <stdint.h>

#include "base/status.h"

typedef struct {
    double volume, standard_error; /* the latter 0 when exact */
} Hypervolume;

/* F (n, n_obj) row-major, minimised. */
Status hypervolume_exact(size_t n, size_t n_obj, const double F[], const double reference[], Hypervolume *out,
                         Err *err);
Status hypervolume_estimate(size_t n, size_t n_obj, const double F[], const double lower[], const double reference[],
                            size_t samples, uint32_t seed, Hypervolume *out, Err *err);

/* Exact for up to 3 objectives or 40 points, else an estimate with 100,000 samples. */
Status hypervolume(size_t n, size_t n_obj, const double F[], const double lower[], const double reference[],
                   uint32_t seed, Hypervolume *out, Err *err);

#endif
