/* run/study.h -- the whole study: settings -> subject -> search over simulated designs -> run folder.
 *
 *   of the tower, f = (j1, j2, j3, ed1, -ed5_10, -edcs, mcore), all minimised; other subjects: run/subject.h
 *
 * A simulation that does not finish, or whose numbers are not finite, is a failed design: kept in evaluations.csv with
 * its reason, never on the front.
 *
 * Reproducible  front.csv and evaluations.csv are the same bytes at any thread count; times stand in log.txt only. */
#ifndef IMTET_RUN_STUDY_H
#define IMTET_RUN_STUDY_H

#include <limits.h>

#include "base/settings.h"
#include "moga/search.h"
#include "sim/sim.h"

typedef void (*StudyProgressFn)(const SearchView *view, void *user);

typedef struct {
    char folder[PATH_MAX];
    StopReason stopped;
    size_t n_simulated, n_failed, n_front;
    double seconds;
    int has_no_core;   /* of a tower */
    SimResult no_core; /* the building alone under the same motion */
} StudySummary;

/* exact: run.out must be free; otherwise a number is added to it where it is not. progress may be NULL. */
Status study_run(const Settings *s, int exact, StudyProgressFn progress, void *user, StudySummary *summary, Err *err);

/* What the search reads from the settings. */
SearchConfig study_search_config(const Settings *s);

#endif
