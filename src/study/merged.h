/* study/merged.h -- several runs of one problem, read as one run.
 *
 *   rows        those of every search, then the polished ones of every run; the ids of the k-th run, from 0, have k
 *               times `id_step`, a power of ten, added
 *   front       what is nondominated among the fronts of all; of a design that is on several the first stays
 *   the rest    settings and provenance of the first; no generations, no sessions, no state; the folder
 *               "results/A + results/B"
 *
 * One problem: the same settings but for search.*, run.* and how the simulator is started, the same objectives and
 * limits, and files of the same content.
 *
 * Ownership  run_free releases the run
 * Errors     STATUS_BAD_DATA: two problems, and what differs */
#pragma once

#include "store/run.h"

Status merged_read(Run *run, size_t n, const char *const folders[], Err *err);
