/* moga/order.h -- questions about the order of numbers. Threads: pure functions. */
#ifndef IMTET_MOGA_ORDER_H
#define IMTET_MOGA_ORDER_H

#include <stddef.h>

/* Ascending, in place. */
void sort_numbers(size_t n, double v[]);

/* Kendall's tau of the columns a[i stride], b[i stride]: pairs in the same order less pairs in the opposite one, as a
 * share of the pairs whose rows are both ok; 0 where there is none. */
double kendall_tau(size_t n, size_t stride, const double a[], const double b[], const unsigned char ok[]);

#endif
