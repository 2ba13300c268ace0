/* bench/stability/need.h -- set-up that must succeed: a case that cannot begin ends its process, which counts as a
 * failure of the case. */
#pragma once

#include <stdio.h>
#include <stdlib.h>

#include "base/status.h"

static inline void need(Status status, const Err *why)
{
    if (status == STATUS_OK)
        return;
    fprintf(stderr, "imtet-bench: %s: %s\n", status_words(status), why->text);
    abort();
}
