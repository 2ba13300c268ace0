/* study/study.h -- the whole study: settings -> problem -> search over simulated designs -> run folder.
 *
 *   of the tower, f = (j1, j2, j3, ed1, -ed5_10, -edcs, mcore) or what search.objectives says, all minimised; other
 *   problems: evaluate/adapter.h
 *
 * A simulation that does not finish, or whose numbers are not finite, is a failed design: kept with its reason, never
 * on the front.
 *
 * Resumes       a run that is there already is resumed, however it stopped: from the state at the end of its last
 *               finished generation, evaluations made after that taken from the database. front.csv and the exports are
 *               then the same bytes as of a run that was never interrupted
 * Settings      must be those of the run (study/differences.h). What the first search.max_evals decides beside the end
 *               (size of the first sample, directions of infill) stays as planned: with 1500 raised to 3000 the first
 *               1500 designs are those of the shorter run
 * Stops         when `stop` says so or after search.max_hours of this session (auto: study/job_limit.h), both asked
 *               between simulations: what is under way is finished, or dropped where an external worker takes seconds,
 *               and everything is stored
 * Names     the designs that it names in the end are simulated until their error is known (study/named.h), also of a
 *           search that is interrupted, where that takes a moment
 * Polishes      search.polish spread-out designs of a finished run (study/final_polish.h), with a tenth of its
 *               simulations; not where that is too little to be of use
 * Reproducible  front.csv and the exports are the same bytes at any thread count; times stand elsewhere. */
#pragma once

#include "moga/search.h"
#include "evaluate/scenario.h"
#include "store/store.h"
#include "study/progress.h"
#include "study/summary.h"

typedef struct Settings Settings;

/* The search at the end of a generation, and what the study adds; one at a time, by any thread. */
typedef struct {
    const SearchView *view; /* NULL: within the first generation of the session, of simulations alone */
    double hypervolume;     /* share of a box about the first sample; NAN: that is not complete */
    Progress progress;
    const Settings *settings;
} StudyProgress;

typedef struct {
    RunStore *store;         /* the run to be resumed, passes over to the study; NULL: run.out is opened */
    int fresh;               /* never resume a run: a number is added to run.out where it holds one */
    int (*stop)(void *user); /* a signal's number, 0: goes on; asked from any thread, often; NULL: never */
    /* n_busy: of n_workers so many may have something to simulate at once */
    void (*started)(const char *folder, size_t n_simulated, size_t n_workers, size_t n_busy, void *user);
    void (*model)(const json_t *chosen, void *user); /* of a new run that chose its own (study/study_model.h) */
    void (*record)(const Scenario *w, void *user);   /* for every record, then */
    void (*progress)(const StudyProgress *p, void *user);
    void *user;
    Run *run; /* becomes the finished run, for run_free, of RUN_FRONT, where it returns STATUS_OK; NULL: not wanted */
} StudyOptions;

/* STATUS_STOPPED: it can be resumed, and the summary is filled. Settings that differ: STATUS_BAD_DATA,
 * with the differences in `err` as far as they fit, all of them in `differences` (NULL: not wanted), a line each. */
Status study_run(const Settings *s, const StudyOptions *options, StudySummary *summary, FILE *differences, Err *err);

/* Whether there is nothing more to do within the limits of the run; then it passes over to `run` (RUN_FRONT), and the
 * summary is filled, without the baselines. */
int study_finished(RunStore *store, StudySummary *summary, Run *run);
