/* base/stat.h -- mean and standard deviation, defined once.
 *
 *   mean = sum_i v_i / n        sd = root(sum_i (v_i - mean)^2 / (n - 1))        NAN: no value, less than two
 *
 * Threads  no state */
#ifndef IMTET_BASE_STAT_H
#define IMTET_BASE_STAT_H

#include <stddef.h>

/* Of the values value(i, user), i = 0..n-1; sd may be NULL. */
void mean_and_sd(size_t n, double (*value)(size_t i, const void *user), const void *user, double *mean, double *sd);

/* Of v (n). */
void mean_and_sd_of(size_t n, const double v[], double *mean, double *sd);

#endif
