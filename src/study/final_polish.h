/* study/final_polish.h -- some designs of a finished run polished at its end (search.polish); of other problems
 * than the tower where they are not noisy.
 *
 * Designs that are spread over the front, the knee first (run_spread_out), each in all objectives at once, none of
 * which may get worse (study/refine.h). Together they take a tenth of the simulations of the search; where that
 * leaves too few for each there is no polishing. The better design is stored together with the note that this one was
 * tried: a run that is interrupted is resumed behind it.
 *
 * Threads  those of the search are shared out over several designs at a time; the results and their order do not
 *          depend on how many there are */
#pragma once

#include "store/store.h"

typedef struct {
    const Settings *used;
    size_t n_simulated;       /* evaluations of the finished search */
    int (*go_on)(void *user); /* as in RefineConfig */
    void *user;
} FinalPolish;

/* Adds to n_tried and n_better. STATUS_STOPPED: go_on said so, it can be resumed. */
Status final_polish(RunStore *store, const FinalPolish *p, size_t *n_tried, size_t *n_better, Err *err);
