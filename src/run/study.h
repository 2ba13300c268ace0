/* run/study.h -- the whole study: settings -> world -> search over simulated designs -> run folder.
 *
 *   f = (j1, j2, j3, ed1, -ed5_10, -edcs, mcore), all minimised; t_top > t_base is repaired by swapping the two
 *
 * A simulation that does not finish, or whose numbers are not finite, is a failed design: kept in evaluations.csv with
 * its reason, never on the front.
 *
 * Reproducible  front.csv and evaluations.csv are the same bytes at any thread count; times stand in log.txt only. */
#ifndef IMTET_RUN_STUDY_H
#define IMTET_RUN_STUDY_H

#include <limits.h>

#include "moga/search.h"
#include "sim/sim.h"

typedef void (*StudyProgressFn)(const SearchView *view, void *user);

typedef struct {
    char folder[PATH_MAX];
    StopReason stopped;
    size_t n_simulated, n_failed, n_front;
    double seconds;
    SimResult no_core; /* the building alone under the same motion */
} StudySummary;

/* exact: run.out must be free; otherwise a number is added to it where it is not. progress may be NULL. */
Status study_run(const Settings *s, int exact, StudyProgressFn progress, void *user, StudySummary *summary, Err *err);

#endif
