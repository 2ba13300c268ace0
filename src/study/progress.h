/* study/progress.h -- progress of a run: its rate, the time left, and which process works on it. */
#pragma once

#include "store/folder.h"
#include "store/run.h"
#include "settings/options.h"

/* Of the search and of this start of it. */
typedef struct {
    size_t simulated, session_simulated; /* so far; since this start */
    double session_s, all_s;             /* of this start; of all */
} Progress;

double progress_rate(const Progress *p); /* simulations of this start, else of all; NAN: none yet */

/* Seconds until simulations or hours are spent, whichever is first; NAN: unknown. */
double progress_left(const Progress *p, const SearchOptions *o);

/* "1:05 min", "3:20 h"; "-" where it is not finite. */
void duration_words(double seconds, char text[32]);

typedef enum { RUN_RUNNING, RUN_FINISHED, RUN_PAUSED, RUN_INTERRUPTED } RunState;

typedef struct {
    RunState state; /* paused: stopped in good order; interrupted: killed. Both can be resumed */
    LockHolder holder;
    Progress progress;
    size_t n_failed, n_polished;
    size_t n_lost;      /* evaluations that were stored, as the lock says, and are not there: the journal is missing */
    double seconds;     /* of work, all sessions together */
    double hypervolume; /* of the last generation; NAN: none */
    long max_evals;
    double left_s; /* progress_left; 0: it is finished */
} Standing;

/* What a session's wall time went into, as shares of it: the search waited for simulations, was at its surrogate, did
 * the rest of it (storing included); and how busy with simulations the threads were, at the same time. NAN: not known.
 * In batches no thread simulates while the search works, and some wait for the slowest. */
typedef struct {
    double waiting, surrogate, search, busy;
} Effort;

Effort effort_of(const Run *run, size_t session);

/* Designs that the end of the study named and simulated with more steps (study/named.h), those of them that cannot be
 * predicted so far, and what that cost, as a share of the search's simulations. */
typedef struct {
    size_t n, n_unpredictable;
    double share;
} NamedCost;

NamedCost named_cost(const Run *run);

const char *state_words(RunState state);
void standing_of(Standing *out, const char *folder, const Run *run);
