/* store/store.h -- the folder of one run, while it is worked on.
 *
 *   run.sqlite        everything (store/tables.h); what is in it is on the disk and stays, however the program ends
 *   settings.ini      the settings as used, defaults filled in, paths absolute; provenance.json: program, libraries,
 *                     machine, seed, hashes
 *   front.csv         the nondominated designs, written whenever a session ends in good order
 *   log.jsonl         what happened when
 *   lock              which process works on it (store/folder.h)
 *
 * One evaluation is one row. A thread of the session commits what is there COMMIT_S after the last commit, so that
 * neither who simulates nor the search waits for the disk: what a kill can cost is what was under way and COMMIT_S of
 * evaluations. The end of a generation is whole or not there: kinds, front, hypervolume, state of the search.
 *
 * Rivals      what another process writes, as where `lock` was removed, ends the session (database_begin)
 * Faults      on a full disk or without memory SQLite may roll back all that is not committed: then nothing more is
 *             written in this session, what waits is dropped, and the run is resumed from the last commit
 * Damage      digests of all rows but those of `session` are checked when a run is read (store/tables.h), and the text
 *             of the tables. A run that lost its journal is refused: `lock` knows of more evaluations. A database
 *             that is removed while the run goes on is put back with the next commit, which ends the session
 *
 * Life cycle  store_open -> store_begin or store_resume -> ... -> store_close, or store_free after a fault
 *             store_open -> store_polished -> store_write_front -> store_free
 * Threads     one at a time; store_evaluation any, beside it. A fault of a commit is told by the next call
 * Errors      STATUS_IO with file and cause */
#pragma once

#include <jansson.h>

#include "evaluate/adapter.h"
#include "moga/search.h"
#include "store/run.h"

typedef struct RunStore RunStore;

static const double COMMIT_S = 0.2;

/* Takes the folder, made where it is not there, and its lock. fresh: the first of folder, folder-2, folder-3, ... that
 * holds no run. */
Status store_open(RunStore **out, const char *folder, int fresh, Err *err);
const char *store_folder(const RunStore *store);

/* The run that the folder held when it was opened, without its rows (RUN_HEAD); NULL: none. */
const Run *store_run(const RunStore *store);

/* Evaluations of the generation that was cut short, from which a session continues; their ids are their numbers in the
 * search. */
const EvaluationTable *store_unfinished(const RunStore *store);

/* The finished evaluations of the search in their order; for SearchStart, of whose `each` the store is the user. */
Status store_each_finished(EvaluationFn take, void *search, void *store, Err *err);

/* The run as it is now, for run_free, behind store_flush: the search is over, or has not begun. */
Status store_read(RunStore *store, RunParts parts, Run *run, Err *err);

/* A run in which nothing was simulated is removed: the next one begins with whatever settings. */
Status store_forget_empty(RunStore *store, Err *err);

/* A new run, or the one that is there, with other limits or threads. goes_on: a session follows, and a run that was
 * finished is not any more. Borrow the schema. */
Status store_begin(RunStore *store, const Schema *schema, const Settings *used, const char *provenance, Err *err);
Status store_resume(RunStore *store, const Schema *schema, const Settings *used, int goes_on, Err *err);

/* A start of the program on this run; to be called after one of the two. */
Status store_session(RunStore *store, const char *program, int threads, size_t n_simulated, Err *err);

/* Its id is its number in the search; its kind comes with the end of the generation (KIND_UNFINISHED). */
Status store_evaluation(RunStore *store, const Evaluation *e, Err *err);
Status store_flush(RunStore *store, Err *err); /* commits what waits; from then on every call commits itself */

/* [s] of work on the run, of this session; of its search, and of that waiting for evaluations and choosing designs. */
typedef struct {
    double run, session, search, waiting, choosing;
} SessionTimes;

/* The end of a generation. */
Status store_generation(RunStore *store, const SearchView *view, const SessionTimes *times, Err *err);
double store_hypervolume(const RunStore *store); /* of the last generation; NAN: none */

/* A line of log.jsonl, "time" (UTC) added; the event is taken over. */
Status store_event(RunStore *store, json_t *event, Err *err);

/* The run has that provenance, which a run that was read from it has got. */
Status store_provenance(RunStore *store, const Run *run, Err *err);

/* One more design of the finished search has been tried to polish, n_tried of a search of n_simulated; `better` (NULL:
 * it did not become better) joins the run: it gets the next id, *id, and the kind `polished`, unless it is `kept`. The
 * search does not see it: a run that is resumed later does what it would have done without. */
Status store_polished(RunStore *store, const Evaluation *better, size_t n_tried, size_t n_simulated, long *id,
                      Err *err);

/* n designs that are there, by their ids, as they are with more steps, all of them or none: the run has these numbers
 * until the search goes on, which keeps its own. */
Status store_finer(RunStore *store, size_t n, const Evaluation better[], Err *err);

/* store_read of the front, and front.csv written from it. */
Status store_write_front(RunStore *store, Run *run, Err *err);

/* Why the session ends. is_final: there is nothing to be resumed. run (NULL: not wanted) becomes the run as it is then
 * (RUN_FRONT), for run_free; front.csv is written. The store is released in any case. */
Status store_close(RunStore *store, const char *stopped, int is_final, double session, Run *run, Err *err);
void store_free(RunStore *store); /* NULL is fine */
