/* moga/frame.h -- objectives of any unit brought to one scale: z = (f - ideal) / width.
 *
 *   ideal  the least of each objective
 *   width  intercepts of the plane through the extreme points (the points best along one axis each); where that plane
 *          does not exist or cuts an axis behind the worst point: worst minus ideal; never 0
 *
 * Threads  pure function on the caller's memory
 * Source   Deb and Jain (see moga/search.h), section IV.C. */
#ifndef IMTET_MOGA_FRAME_H
#define IMTET_MOGA_FRAME_H

#include <stddef.h>

typedef struct {
    size_t n_obj;
    double *ideal, *width; /* (n_obj), the caller's */
    double *plane;         /* (n_obj, n_obj + 1) scratch */
} Frame;

/* From the rows list[0..n) of F (., n_obj), n >= 1. */
void frame_fit(Frame *frame, size_t n, const size_t list[], const double F[]);

/* The same with width = worst minus ideal: what a front that is still growing sideways is measured with. */
void frame_fit_box(Frame *frame, size_t n, const size_t list[], const double F[]);

static inline double frame_scale(const Frame *frame, size_t k, double f)
{
    return (f - frame->ideal[k]) / frame->width[k];
}

#endif
