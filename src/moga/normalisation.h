/* moga/normalisation.h -- objectives of any unit brought to one scale: z = (f - ideal) / width.
 *
 *   ideal  minimum of each objective
 *   width  intercepts of the plane through the extreme points, each the best along one axis; maximum minus minimum
 *          where that plane does not exist or cuts an axis behind the maximum; never 0
 *
 * Threads  pure functions on the caller's memory
 * Source   Deb and Jain (see moga/search.h), section IV.C. */
#pragma once

#include "base/status.h"

typedef struct {
    size_t n_obj;
    double *ideal, *width; /* (n_obj), the caller's */
    double *plane;         /* (n_obj + 1, n_obj) scratch of normalisation_fit */
    int *pivot;            /* (n_obj) likewise */
} Normalisation;

/* From the rows list[0..n) of F (., n_obj), n >= 1. */
void normalisation_fit(Normalisation *q, size_t n, const size_t list[], const double F[]);

/* The same with width = maximum minus minimum, for a front that is still growing sideways. */
void normalisation_fit_range(Normalisation *q, size_t n, const size_t list[], const double F[]);

static inline double normalised(const Normalisation *q, size_t k, double f)
{
    return (f - q->ideal[k]) / q->width[k];
}

/* How far f is behind an aspiration level, in widths; NAN: there is none, and nothing is behind it. */
static inline double normalised_behind(const Normalisation *q, size_t k, double level, double f)
{
    return isnan(level) ? -INFINITY : (f - level) / q->width[k];
}
