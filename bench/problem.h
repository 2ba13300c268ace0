/* bench/problem.h -- the search on a textbook problem, every evaluated design as a row of a CSV: what scripts/compare and
 * scripts/ablation score.
 *
 * Threads  call it from one thread; the search uses several */
#ifndef IMTET_BENCH_PROBLEM_H
#define IMTET_BENCH_PROBLEM_H

#include "cmd/args.h"

extern const ArgOption PROBLEM_OPTIONS[];
Status problem_run(const Args *args, Err *err);

#endif
