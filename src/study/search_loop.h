/* study/search_loop.h -- a search and the queue that evaluates what it asks for.
 *
 *   search_ask -> queue_ask ... queue_next -> search_tell                        (moga/search.h, evaluate/queue.h)
 *
 * Known      designs that had been evaluated when the program was interrupted are not simulated again
 * Stops      on a fault, or where the problem's observer says so, at once: what is under way is finished and written
 *            down; the search is resumed from its last step. Where config.max_seconds are over, as the search
 *            does for its own reasons: what was asked for enters first
 * Threads    of the queue as many as the problem has workers; the search's own are OpenMP's */
#pragma once

#include "evaluate/problem.h"
#include "moga/search.h"

/* Seconds of this session. */
typedef struct {
    double all, waiting, choosing; /* since it began; for evaluations; in the search: fits, predictions, selection */
} SearchTime;

/* Called after every step; return non-zero to stop. */
typedef int (*ObserveFn)(const SearchView *view, const SearchTime *time, void *user);

/* From `start` (NULL: from the beginning). A search that has reached its limits evaluates nothing and does not call
 * observe. */
Status search_run(const Problem *problem, const SearchConfig *config, const SearchStart *start, ObserveFn observe,
                  void *user, StopReason *reason, Err *err);
