/* serve/detail_cache.h -- designs of a run simulated on demand, each once: JSON of report/detail.h.
 *
 *   {"id", "objectives": [n_obj] as the run has them, "detail"}
 *
 * The knee stands beside all baselines; any other design beside no core and rigidly connected, since the devices are searched
 * for anew for each core. The last DETAILS_KEPT are kept. One is simulated at a time, on one thread.
 *
 * Life cycle  detail_cache_open -> detail_cache_ask ... -> detail_cache_close
 * Threads     any
 * Errors      no such design, or a run without a tower: STATUS_MISSING */
#ifndef IMTET_SERVE_DETAIL_CACHE_H
#define IMTET_SERVE_DETAIL_CACHE_H

#include "store/run.h"
#include "study/record_paths.h"

enum { DETAILS_KEPT = 32 };

typedef struct DetailCache DetailCache;

Status detail_cache_open(DetailCache **out, Err *err);
void detail_cache_close(DetailCache *c); /* NULL is fine */

/* text: to be freed. */
Status detail_cache_ask(DetailCache *c, const Run *run, const RecordPaths *moved, long id, char **text, Err *err);

#endif
