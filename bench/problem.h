/* bench/problem.h -- `imtet-bench problem`: the search on a problem from a textbook, every design as CSV. */
#ifndef IMTET_BENCH_PROBLEM_H
#define IMTET_BENCH_PROBLEM_H

#include "cmd/args.h"

Status problem_run(const Args *args, Err *err);

#endif
