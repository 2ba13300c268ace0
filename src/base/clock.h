/* base/clock.h -- seconds of wall time from some moment on, never set back.
 *
 * Threads  no state */
#pragma once

#include <time.h>

static inline double clock_seconds(void)
{
    struct timespec t;
    clock_gettime(CLOCK_MONOTONIC, &t);
    return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}
