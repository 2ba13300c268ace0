/* study/study_log.h -- what a study writes into log.txt and log.jsonl of its run (store/logs.h): that it starts, every
 * generation, what the session cost, why it ends.
 *
 * Threads  as the store */
#ifndef IMTET_STUDY_STUDY_LOG_H
#define IMTET_STUDY_STUDY_LOG_H

#include "evaluate/adapter.h"
#include "store/store.h"
#include "settings/options.h"
#include "study/summary.h"

/* n: evaluations that the run holds already. */
Status study_log_start(RunStore *store, const Adapter *adapter, const SearchOptions *used, size_t n, Err *err);

/* seconds: of work on the run so far, all sessions. */
Status study_log_generation(RunStore *store, const SearchView *view, double seconds, Err *err);

/* threads: of the simulations. */
Status study_log_end(RunStore *store, const StudySummary *sum, int threads, int is_final, Err *err);

/* Of a study with screened designs: how many, what they cost, and how far the cheap level agrees, as a sentence. */
enum { SCREENING_WORDS = 320 };
void screening_words(const StudySummary *sum, char text[SCREENING_WORDS]);

#endif
