/* serve/on_demand.h -- designs of a run simulated when a page asks for them, with the run's settings.
 *
 * Design   any of the run as report/detail.h has it, and under the built-in motions that the study does not use:
 *          {"id", "objectives": [n_obj] as in the run, "detail"}. The knee stands beside all baselines; any other
 *          beside no core and rigidly connected, since the devices are searched for anew for each core. The knee is
 *          kept
 * Scene    what the page needs to simulate other designs itself (report/what_if.h), made once
 *
 * Life cycle  on_demand_open -> on_demand_share ... -> on_demand_close, once for each of both
 * Threads     any; one design is simulated at a time, on one thread
 * Errors      no such design, or a run without a tower: STATUS_MISSING. A simulation that fails is an answer */
#pragma once

#include <jansson.h>

#include "store/run.h"
#include "study/record_paths.h"

typedef struct OnDemand OnDemand;

/* moved: borrowed. */
Status on_demand_open(OnDemand **out, const Run *run, const RecordPaths *moved, Err *err);
OnDemand *on_demand_share(OnDemand *o);
void on_demand_close(OnDemand *o); /* NULL is fine */

/* The run, as it is now, is that of on_demand_open: no other has been made in its place. */
int on_demand_is_of(const OnDemand *o, const Run *run);

/* text: JSON, to be freed. */
Status on_demand_design(OnDemand *o, const Run *run, long id, char **text, Err *err);

/* x (n) simulated as the run does and stored in it, of the kind `kept`, unless the run has it. */
Status on_demand_keep(OnDemand *o, const Run *run, size_t n, double x[], long *id, Err *err);

Status on_demand_scene(OnDemand *o, const Run *run, char **text, Err *err);
