#include "moga/order.h"

#include <stdlib.h>

static int compare(const void *a, const void *b)
{
    const double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

void sort_numbers(size_t n, double v[])
{
    qsort(v, n, sizeof *v, compare);
}

double kendall_tau(size_t n, size_t stride, const double a[], const double b[], const unsigned char ok[])
{
    long same = 0, pairs = 0;
    for (size_t i = 0; i < n; i++)
        for (size_t j = 0; j < i; j++) {
            const double product = (a[i * stride] - a[j * stride]) * (b[i * stride] - b[j * stride]);
            if (!ok[i] || !ok[j])
                continue;
            same += (product > 0.0) - (product < 0.0);
            pairs++;
        }
    return pairs > 0 ? (double)same / (double)pairs : 0.0;
}
