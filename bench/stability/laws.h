/* bench/stability/laws.h -- the contact laws measured: rebound against r, what the no-tension condition removes, what law
 * and smallest approach speed change in the tower, and whether engines that share no method agree there under each. */
#pragma once

#include "base/status.h"

/* Paths of tables, as CSV; NULL: not made. */
typedef struct {
    const char *curves, *tower, *engines;
} LawTables;

/* Prints the checks. Errors  a law is not what it should be; with the table of engines, one is outside the promise */
Status laws(const LawTables *tables, Err *err);
