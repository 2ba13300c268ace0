/* study/final_polish.h -- some designs of a finished run polished at its end (search.polish); of other problems than
 * the tower where they are not noisy.
 *
 * Designs that are spread over the front, the knee first (run_spread_out), each in all objectives at once, none of
 * which may get worse (study/polish.h). Together they take a tenth of the simulations of the search; where that
 * leaves too few for each there is no polishing. The better design is stored together with the note that this one was
 * tried: a run that is interrupted is resumed behind it.
 *
 * Threads  those of the search are shared out over several designs at a time; the results and their order do not
 *          depend on how many there are */
#pragma once

#include "store/store.h"
#include "study/improver.h"

typedef struct {
    const Settings *used;
    size_t n_simulated;       /* evaluations of the finished search */
    int (*go_on)(void *user); /* as in ImproveConfig */
    void *user;
} FinalPolish;

typedef struct {
    size_t n_tried, n_better; /* designs; of these better by more than their spread */
    ImproveCost cost;         /* of all */
} FinalPolished;

/* Adds to *out. STATUS_STOPPED: go_on said so, it can be resumed. */
Status final_polish(RunStore *store, const FinalPolish *p, FinalPolished *out, Err *err);
