/* serve/on_demand.h -- designs of a run simulated when a page asks for them, with the run's settings.
 *
 * Design   any of the run as report/detail.h has it, and under the built-in motions that the study does not use:
 *          {"id", "objectives": [n_obj] as in the run, "detail"}. The knee stands beside all baselines; any other
 *          beside no core and rigidly connected, since the devices are searched for anew for each core. The last
 *          DESIGNS_KEPT are kept
 * What if  a design changed a little: gaps, thicknesses, strength and length of the motion, restitution
 *
 *   question  {"turn": T, "x": [n_var], "pga_g": G, "stretch": S, "restitution": R, "whole": 1}
 *             the last four null or left out: as in the run, by one simulation; x within the bounds of the search, the
 *             others within those of on_demand_bounds
 *   answer    {"turn", "outcome", "reason", "objectives": [n_obj] or null, "dominated_by": n, "dominates": n (designs
 *             of the front; null where the front is of another motion or of several simulations), "gap_m", "peaks" and
 *             "no_core": result_json (report/report_json.h), "beyond_law", "seconds"}
 *
 * It is one simulation of the first record, the very one of `imtet simulate --design`; with `whole` all records and
 * replicates by the rule of the run, peaks those of the first. A page asks one
 * question at a time; its number T comes back. The scene is kept while the motion and the restitution stay.
 *
 * Life cycle  on_demand_open -> on_demand_share ... -> on_demand_close, once for each of both
 * Threads     any; one design and one what-if are simulated at a time, on one thread each
 * Errors      no such design, or a run without a tower: STATUS_MISSING; a question that is none, or out of bounds:
 *             STATUS_BAD_DATA. A simulation that fails is an answer */
#pragma once

#include <jansson.h>

#include "store/run.h"
#include "study/record_paths.h"

enum { DESIGNS_KEPT = 32 };

typedef struct OnDemand OnDemand;

/* moved: borrowed. */
Status on_demand_open(OnDemand **out, const Run *run, const RecordPaths *moved, Err *err);
OnDemand *on_demand_share(OnDemand *o);
void on_demand_close(OnDemand *o); /* NULL is fine */

/* The run, as it is now, is that of on_demand_open: no other has been made in its place. */
int on_demand_is_of(const OnDemand *o, const Run *run);

/* text: to be freed. */
Status on_demand_design(OnDemand *o, const Run *run, long id, char **text, Err *err);

/* {"lower": [n_var], "upper", "pga_g": [least, as in the run, most], "stretch", "restitution", "simulations": by which
 * the run judges a design, "options": of `imtet simulate` that make it the same simulation, "pga_options": those where
 * the peak is changed} */
Status on_demand_bounds(OnDemand *o, const Run *run, json_t **bounds, Err *err);
Status on_demand_what_if(OnDemand *o, const Run *run, const char *question, size_t n, json_t **answer, Err *err);
