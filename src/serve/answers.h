/* serve/answers.h -- what the server says about runs, as JSON.
 *
 *   status   {"name", "state", "simulated", "max_evals", "failed", "front", "generation", "finished" (UTC),
 *            "hypervolume", "per_second", "seconds", "left_s"}; what is not known: null. A run that can no longer be
 *            read has the state "unreadable", the "reason", and its last numbers if there are any
 *   front    {"generation", "knee", "ids": [n_front], "f": [n_front][n_obj]} in natural signs and units, and
 *            growth_json (report/report_json.h)
 *   against  {"runs": [{"name", "f", "simulated", "volume"}, ...], "differences": settings in which others are another
 *            problem than the first, whose fronts are no comparison}, all volumes in one box: from a fifth of the range
 *            of all fronts below their best to their worst, by fixed samples (base/hypervolume.h), of the designs that
 *            were on a front so far
 *
 * Ownership  the caller's reference; NULL: no memory, or a name that is no UTF-8
 * Threads    pure functions */
#pragma once

#include <jansson.h>

#include "serve/watch.h"

json_t *answer_status(const View *view, const char *name);
json_t *answer_front(const Snapshot *snapshot);

/* Other objectives: STATUS_BAD_DATA. A front that is empty: STATUS_MISSING. */
Status answer_against(size_t n, const Snapshot *const snapshot[], const char *const name[], json_t **out, Err *err);
