/* store/store.h -- the folder of one run, while it is worked on.
 *
 *   run.sqlite        everything (tables below); what is in it is on the disk and stays, however the program ends
 *   settings.ini      the settings as used, defaults filled in, paths absolute     these four are made from the
 *   provenance.json   program, libraries, machine, seed, hashes                    database: removed, or out of step
 *   evaluations.csv   every evaluation of the finished generations                 after a crash, they are regenerated
 *   front.csv         the nondominated designs                                     when the run is resumed
 *   log.txt           what happened when; log.jsonl: the same for programs         (store/logs.h)
 *   lock              which process works on it                                    (store/lock.h)
 *
 * One evaluation is one row, committed when it is done: at once where it took longer than COMMIT_S, else at the latest
 * COMMIT_S after the one before, and at the end of its batch. Generations that take less than GENERATION_S are committed
 * together, likewise. What a kill can cost is what was under way and COMMIT_S of evaluations. The end of a generation is
 * whole or not there: kinds, front, hypervolume, state of the search.
 *
 *   run          settings (INI), provenance (JSON), planned_evals, n_var, created, tried_to_polish, polished_at, digest
 *   evaluation   id, generation, kind (NULL: its generation is not finished), outcome, reason, seconds,
 *                x, f, spread (JSON lists; NULL: none), violation, extra, digest (store/rows.h)
 *   generation   number, simulated, failed, front, predicted, surrogate_error, hypervolume, seconds, finished,
 *                digest
 *   front        evaluation, entered, left: it was on the front of the generations entered <= g < left
 *   state        generation, bytes (moga/search.h), digest, front: of the last two generations
 *   session      started, ended, host, pid, program, threads, simulated_before, seconds, stopped, is_final,
 *                search, waited, surrogate
 *   designs      a view: the evaluations with their columns by name
 *
 * Damage      digests of all rows but those of `session` are checked when a run is read (store/digest.h), and the text of
 *             the tables. A run that lost its journal is refused: evaluations.csv has more than the database. A database
 *             that is removed while the run goes on is put back at the end of a generation, which ends the session
 *
 * Life cycle  store_open -> store_begin or store_resume -> ... -> store_close, or store_free after a fault
 *             store_open_run -> store_add_evaluations -> store_free
 * Threads     one at a time
 * Errors      STATUS_IO with file and cause */
#ifndef IMTET_STORE_STORE_H
#define IMTET_STORE_STORE_H

#include <jansson.h>

#include "moga/search.h"
#include "store/run.h"
#include "store/tables.h"
#include "evaluate/adapter.h"

typedef struct Settings Settings;

typedef struct RunStore RunStore;

static const double COMMIT_S = 0.2, GENERATION_S = 0.025;

/* Takes the folder, made where it is not there, and its lock. fresh: the first of folder, folder-2, folder-3, ... that
 * holds no run. */
Status store_open(RunStore **out, const char *folder, int fresh, Err *err);
Status store_open_run(RunStore **out, const char *folder, Err *err); /* one that is there */
const char *store_folder(const RunStore *store);

/* The run that the folder held when it was opened, with fresh = 0 as RUN_ENDED says (store/run_read.h); NULL: none. */
const Run *store_run(const RunStore *store);
/* All of it passes to the caller, for run_free; evaluations.csv and front.csv are regenerated. */
Status store_give_run(RunStore *store, Run *run, Err *err);

/* The finished evaluations of a run that was resumed, in their order, one after the other (store/rows.h); evaluations.csv and
 * front.csv are mended meanwhile (store/csv_files.h). */
Status store_each_finished(RunStore *store, EvaluationFn take, void *user, Err *err);

/* A run in which nothing was simulated is removed: the next one begins with whatever settings. */
Status store_forget_empty(RunStore *store, Err *err);

/* A new run, or the one that is there, with other limits or threads. goes_on: a session follows, and a run that was finished
 * is not any more. Borrow the schema. */
Status store_begin(RunStore *store, const Schema *schema, const Settings *used, const char *provenance, Err *err);
Status store_resume(RunStore *store, const Schema *schema, const Settings *used, int goes_on, Err *err);

/* Where store_run's state is not that of the last generation, which is damaged: as if that generation were not finished. Its
 * evaluations stay. Before store_resume; store_run is read again. */
Status store_step_back(RunStore *store, Err *err);

/* A start of the program on this run; to be called after one of the two. */
Status store_session(RunStore *store, const char *program, int threads, size_t n_simulated, Err *err);

/* With id and generation; its kind comes with the end of the generation (KIND_UNFINISHED). */
Status store_evaluation(RunStore *store, const Evaluation *e, Err *err);
Status store_flush(RunStore *store, Err *err); /* commits what waits */

/* The end of a generation. seconds: of work on the run, this session: of it alone. */
Status store_generation(RunStore *store, const SearchView *view, double seconds, double session, Err *err);
double store_hypervolume(const RunStore *store); /* of the last generation; NAN: none */

/* As store/logs.h says. */
__attribute__((format(printf, 3, 4))) Status store_log(RunStore *store, Err *err, const char *format, ...);
Status store_event(RunStore *store, json_t *event, Err *err);

/* The run as the database has it now. */
Status store_read(RunStore *store, Run *run, Err *err);

/* One more design of the finished search has been tried to polish; `better` (NULL: it did not become better) joins the
 * run as in store_add_evaluations. */
Status store_polished(RunStore *store, const Evaluation *better, size_t n_tried, size_t n_simulated, Err *err);

/* Why the session ends. is_final: there is nothing to be resumed. run (NULL: not wanted) becomes the run as it is then
 * (at least RUN_REVIEWED, store/run_read.h), for run_free. The store is released in any case. */
Status store_close(RunStore *store, const char *stopped, int is_final, double session, Run *run, Err *err);
void store_free(RunStore *store); /* NULL is fine */

/* Designs from outside the search, polished ones say, into a run that was opened and neither begun nor resumed: they get
 * ids from POLISHED_FIRST (run.h) on and the kind `polished`, and front.csv and evaluations.csv are written again. The search does
 * not see them: a run that is resumed later does what it would have done without them. first_id may be NULL. */
Status store_add_evaluations(RunStore *store, size_t n, const Evaluation designs[], long *first_id, Err *err);

#endif
