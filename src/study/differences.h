/* study/differences.h -- whether a run may be resumed with these settings.
 *
 * Settings must be those of the run, and the files that they name must have the content that its provenance has. A free
 * setting (SETTING_FREE) is not compared; limits (SETTING_LIMIT) may be others, but search.max_evals not less than the
 * run holds.
 *
 * Errors  STATUS_BAD_DATA: the differences as far as they fit, all of them in `lines` (NULL: not wanted), a line each
 *         */
#pragma once

#include "evaluate/adapter.h"
#include "store/run.h"

typedef struct {
    const Run *run;
    const Settings *used;
    const Adapter *adapter; /* of the settings */
    FILE *lines;
} Comparison;

/* n_there: evaluations of the search that the run holds. has_new_limits: a limit is another one than in the run. */
Status differences_check(const Comparison *c, size_t n_there, int *has_new_limits, Err *err);
