/* moga/convergence.h -- when more evaluations gain no more: SearchConfig.stop_after.
 *
 *   h(n)   share that the first n designs dominate of the box about the front of all designs, from its ideal to
 *          ideal + 1.1 (nadir - ideal), by the fixed samples of base/hypervolume.h
 *   gain   h(now) - h(now - stop_after). A search is over when it is no more than the standard error of h(now)
 *
 * The box follows the front, so that a gain counts wherever the front moves; an objective that hardly differs on the
 * front has a hundredth of its range over all designs. Noisy objectives count with their standard error added: a design
 * that was lucky once is no gain.
 *
 *   expected gain of as many evaluations again: with the gains d1 of the last half and d2 of the quarter before it
 *          d1 min(d1 / d2, 1), what a power law h = h_inf - c n^-a makes of them
 *
 * Threads  pure functions on the caller's memory */
#pragma once

#include "base/status.h"

typedef struct {
    size_t n, n_obj;
    const double *F, *error;       /* (n, n_obj) objectives, standard errors; error: NULL: none */
    const double *sense;           /* (n_obj) 1: minimised, -1: maximised; NULL: all are minimised */
    const unsigned char *counts;   /* (n) succeeded, keeps every limit, and is no further replicate */
    const unsigned char *on_front; /* (n) */
} GrowingFront;

/* h of the first cut[0] <= cut[1] <= ... designs; NAN where the front is empty. */
Status convergence_shares(const GrowingFront *designs, size_t n_cuts, const size_t cut[], double h[], Err *err);

/* Of h(n / 4), h(n / 2), h(n); NAN where nothing is known. */
double convergence_expected(const double h[3]);

/* What a search keeps. */
typedef struct {
    size_t after; /* stop_after by which it was found to be over; 0: it is not */
    size_t end;   /* evaluations with which it ends: those under way and the last replicates are still made */
} Convergence;
