/* cmd/asked.h -- designs that are asked of a problem's own simulator, an external worker say, beside any search.
 *
 * Ownership  nothing is kept.   Threads  the problem's own */
#pragma once

#include "base/json.h"
#include "cmd/args.h"
#include "evaluate/adapter.h"

/* For ProblemOptions.constraints: of a worker any number, the first answer tells. */
#define ASKED_CONSTRAINTS(s) ((s)->problem.kind == PROBLEM_EXTERNAL ? -1 : 0)

/* `imtet simulate` of a problem that is no tower: --design, --csv, --json; every other option is refused. */
Status asked_simulate(const Args *args, const Settings *s, Err *err);

/* `imtet check`: the design in the middle of the box is asked for, and again where that took no more than two seconds,
 * so that the start of the worker is no part of the time [s] of an evaluation, *each_s. The answer is put into `worker`
 * of out; *outcome is that of the design, whose reason is in `why`. */
Status asked_check(Adapter *a, json_t *out, double *each_s, Outcome *outcome, Err *why, Err *err);
