/* study/front_review.h -- what a front of the tower says about its own search box and contact law: gaps that sit on a
 * bound, gaps that never close, designs beyond the contact law.
 *
 * Errors   none but those of simulations
 * Threads  no state */
#pragma once

#include "evaluate/problem.h"
#include "sim/result.h"
#include "store/run.h"

typedef struct {
    size_t n_front, n_gaps; /* 0 gaps: of another problem; the first n_gaps variables */
    size_t n_beyond;        /* designs beyond the contact law */
    size_t at_smallest[SIDES * FLOORS_MAX],
        at_largest[SIDES * FLOORS_MAX]; /* (n_gaps) designs with this gap on that bound */
    size_t n_simulated, n_floors;       /* designs that were simulated again */
    int has_stop[FLOORS_MAX];           /* (n_floors) any of them has one there */
    size_t closes[FLOORS_MAX];          /* (n_floors) of them those in which the floor's gap closes */
} FrontReview;

/* As the run has stored it; nothing is simulated. */
FrontReview front_review(const Run *run);

/* The same, with some spread-out designs simulated again under the first record. */
Status front_review_closings(const Problem *tower, const Run *run, FrontReview *out, Err *err);

/* ... of a run of the tower alone, whose records are where they were. */
Status front_review_of_run(const Run *run, FrontReview *out, Err *err);
