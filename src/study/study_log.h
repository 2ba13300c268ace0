/* study/study_log.h -- what a study writes into log.jsonl of its run (store_event): that it starts, every generation
 * with what it cost, why it ends.
 *
 * Threads  as the store */
#pragma once

#include "store/store.h"
#include "settings/options.h"
#include "study/summary.h"

/* n: evaluations that the run holds already; threads: of the simulations. */
Status study_log_start(RunStore *store, int threads, const SearchOptions *used, size_t n, Err *err);

Status study_log_generation(RunStore *store, const SearchView *view, const SessionTimes *times, Err *err);
Status study_log_end(RunStore *store, const StudySummary *sum, int is_final, Err *err);
