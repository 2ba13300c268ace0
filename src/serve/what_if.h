/* serve/what_if.h -- a design changed a little, simulated at once: gaps, thicknesses, strength and length of the motion,
 * restitution.
 *
 *   question  {"page": P, "turn": T, "x": [n_var], "pga_g": G, "stretch": S, "restitution": R}      the last three null or left
 *             out: as in the run; x within the bounds of the search, the others within those of what_if_bounds
 *   answer    {"turn", "outcome", "reason", "objectives": [n_obj] or null, "dominated_by": n, "dominates": n (designs of the
 *             front; null where the front is of another motion or of several simulations), "gap_m",
 *             "peaks" and "closings" by floor, "impacts", "beyond_law", "no_core": peaks, "seconds"}
 *
 * One simulation of the first record, the very one of `imtet simulate --design`, all digits of the numbers. One at a time;
 * the latest wins: of one page P, a question with a smaller turn than the latest is not simulated (STATUS_STOPPED).
 * The scene is kept while the motion and the restitution stay.
 *
 * Life cycle  what_if_open -> what_if_ask ... -> what_if_close
 * Threads     any
 * Errors      a question that is none, or out of bounds: STATUS_BAD_DATA. A simulation that fails is an answer */
#ifndef IMTET_SERVE_WHAT_IF_H
#define IMTET_SERVE_WHAT_IF_H

#include <jansson.h>

#include "store/run.h"
#include "study/record_paths.h"

typedef struct WhatIf WhatIf;

/* Of a run of the tower; another problem: STATUS_MISSING. */
Status what_if_open(WhatIf **out, const Run *run, const RecordPaths *moved, Err *err);
void what_if_close(WhatIf *w); /* NULL is fine */

/* {"lower": [n_var], "upper", "pga_g": [least, as in the run, most], "stretch", "restitution", "is_comparable",
 * "options": of `imtet simulate` that make it the same simulation, "pga_options": those where the peak is changed} */
json_t *what_if_bounds(const WhatIf *w);

/* run: as it is now, for its front. */
Status what_if_ask(WhatIf *w, const Run *run, const char *question, size_t n, json_t **answer, Err *err);

#endif
