/* bench/throughput.h -- designs per second, and ratios to other engines: 24 designs with irregular gaps of 10 to 200
 * mm, the whole motion, one thread, all in one process. Engines too slow for that run fewer designs or only the strong
 * window, and `fast` is timed on the same.
 *
 * Threads  none but those of the worker pool that it times */
#pragma once

#include <stdio.h>

#include "bench/timed_run.h"

/* quick: four designs, shorter comparisons. count: the fast engine on four designs, nothing to compare with. */
Status throughput_print(const SceneOptions *s, const Motion *motion, int quick, int count, FILE *out, Err *err);
