/* bench/throughput.h -- how many designs a second, and against whom: 24 designs with irregular gaps of 10 to 200 mm,
 * the whole motion, one thread, all in one process. Engines that are too slow for that run fewer designs or only the
 * strong window, and `fast` is timed on the same. Threads  none */
#ifndef IMTET_BENCH_THROUGHPUT_H
#define IMTET_BENCH_THROUGHPUT_H

#include <stdio.h>

#include "bench/observe.h"

/* quick: four designs, shorter comparisons. count: the fast engine on four designs, nothing to compare with. */
Status throughput_print(const SceneOptions *s, const Motion *motion, int quick, int count, FILE *out, Err *err);

#endif
