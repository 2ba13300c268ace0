/* bench/problem.h -- `imtet-bench problem`: the search on a problem from a textbook, every design as CSV. */
#pragma once

#include "cmd/args.h"

Status problem_run(const Args *args, Err *err);
