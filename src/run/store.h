/* run/store.h -- the folder of one run.
 *
 *   settings.ini      the settings as used, defaults filled in, paths absolute
 *   provenance.json   program, libraries, machine, seed, hashes
 *   evaluations.csv   every simulation, appended and brought to the disk generation by generation
 *   front.csv         the nondominated simulated designs, replaced as a whole each generation
 *   log.txt           the only file with wall-clock times in it
 *
 * A folder that holds a run is never written to. A crash leaves the last finished generation readable.
 *
 * Life cycle  store_create -> ... -> store_close, or store_free after a fault
 * Errors      STATUS_IO with file and cause */
#ifndef IMTET_RUN_STORE_H
#define IMTET_RUN_STORE_H

#include "moga/search.h"
#include "run/schema.h"

typedef struct RunStore RunStore;

/* folder: where the run goes. Where it holds a run already: refused if `exact`, else the first free of folder-2,
 * folder-3, ... is taken. Borrows the schema. */
Status store_create(RunStore **out, const char *folder, int exact, const Schema *schema, Err *err);
const char *store_folder(const RunStore *store);

Status store_settings(RunStore *store, const Settings *s, Err *err);

/* The simulations first .. view->n-1 of the view, whose verdicts these are. */
Status store_evaluations(RunStore *store, const SearchView *view, size_t first, const Verdict verdicts[], Err *err);
Status store_front(RunStore *store, const SearchView *view, Err *err);

/* One line, the time of day in front. */
__attribute__((format(printf, 3, 4))) Status store_log(RunStore *store, Err *err, const char *format, ...);

Status store_close(RunStore *store, Err *err);
void store_free(RunStore *store); /* NULL is fine */

#endif
