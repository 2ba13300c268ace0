/* bench/stability/laws.h -- the contact laws measured: rebound against r, what the no-tension condition removes, what law
 * and smallest approach speed change in the tower. */
#ifndef IMTET_BENCH_LAWS_H
#define IMTET_BENCH_LAWS_H

#include "base/status.h"

/* Prints the checks and writes two tables as CSV (either path may be NULL). Errors  a law is not what it should be */
Status laws(const char *curves, const char *tower, Err *err);

#endif
