/* bench/schedule.h -- `imtet-bench schedule`: a finished run replayed on more workers than a machine has.
 *
 * What it takes from the run, which was made with --threads 1: how long each design was simulated; which answers had
 * entered when each group of questions was made (RunGeneration.simulated); and what the search itself took from one
 * group to the next, which is the rest of the time. Replayed, a worker that is free takes the next question, and a group
 * is made when the answers that the search waits for are there: a part of that work by one processor, the rest by all, of
 * which the workers lose their share. Behind the search come the ends of the study, of so much work and no shorter than
 * their longest chain.
 *
 *   efficiency   work / (workers x time)
 *   critical     [s] time on any number of workers
 *   waited       of the workers' time: for the search to choose, for answers that it needs, at the end */
#ifndef IMTET_BENCH_SCHEDULE_H
#define IMTET_BENCH_SCHEDULE_H

#include <stdio.h>

#include "base/status.h"

typedef struct {
    const char *folder; /* of the run */
    double serial;      /* share of choosing that one processor does alone */
    double ends, chain; /* [s] behind the search */
} SchedulePlan;

/* A row for 1, 2, 4, ... 64 workers and 14, as CSV. */
Status schedule(const SchedulePlan *plan, FILE *out, Err *err);

#endif
