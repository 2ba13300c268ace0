/* tests/wfg.h -- exact hypervolume of a set up to a reference point, which the program's estimate is compared with.
 *
 * WFG: the sum over the points of what each adds to those after it; exponential in the number of objectives.
 * Source  While, Bradstreet and Barone, IEEE Trans. Evol. Comput. 16 (2012) 86-95. */
#pragma once

#include "check.h"

#include "base/dominance.h"

/* Rows in descending order of the last objective. */
static inline int wfg_compare(const void *a, const void *b, void *m)
{
    const double x = ((const double *)a)[*(size_t *)m - 1], y = ((const double *)b)[*(size_t *)m - 1];
    return (x < y) - (x > y);
}

/* Of the points after i in the order, what lies behind point i in the first m - 1 objectives, dominated ones left out:
 * L (count, m - 1). */
static inline size_t wfg_limit_set(size_t m, size_t n, const double P[], size_t i, double L[])
{
    const size_t w = m - 1;
    size_t count = 0;
    for (size_t j = i + 1; j < n; j++) {
        double *limited = L + count * w;
        size_t kept = 0;
        int hidden = 0;
        for (size_t k = 0; k < w; k++)
            limited[k] = fmax(P[i * m + k], P[j * m + k]);
        for (size_t l = 0; l < count && !hidden; l++)
            hidden = dominates(w, L + l * w, limited) || memcmp(L + l * w, limited, w * sizeof *L) == 0;
        if (hidden)
            continue;
        for (size_t l = 0; l < count; l++)
            if (!dominates(w, limited, L + l * w))
                memmove(L + kept++ * w, L + l * w, w * sizeof *L);
        memmove(L + kept * w, limited, w * sizeof *L);
        count = kept + 1;
    }
    return count;
}

/* P (n, m) is sorted; `level` has room for the sets of all levels below. */
static inline double wfg_volume_of(size_t m, size_t n, double P[], const double reference[], double *level)
{
    double sum = 0.0;
    if (n == 0)
        return 0.0;
    qsort_r(P, n, m * sizeof *P, wfg_compare, &m);
    if (m == 1)
        return reference[0] - P[n - 1];
    for (size_t i = 0; i < n; i++) {
        double own = 1.0;
        for (size_t k = 0; k + 1 < m; k++)
            own *= reference[k] - P[i * m + k];
        own -= wfg_volume_of(m - 1, wfg_limit_set(m, n, P, i, level), level, reference, level + (n + 1) * (m - 1));
        sum += (reference[m - 1] - P[i * m + m - 1]) * own;
    }
    return sum;
}

/* F (n, m) minimised; points that are not below the reference in every objective add nothing. */
static inline double wfg_hypervolume(size_t n, size_t m, const double F[], const double reference[])
{
    FREED double *store = calloc((n + 1) * m * (m + 1), sizeof *store);
    size_t count = 0;
    assert_non_null(store);
    for (size_t i = 0; i < n; i++) {
        int inside = 1;
        for (size_t k = 0; k < m; k++)
            inside &= F[i * m + k] < reference[k];
        if (inside)
            memcpy(store + count++ * m, F + i * m, m * sizeof *F);
    }
    const double volume = wfg_volume_of(m, count, store, reference, store + (n + 1) * m);
    return volume;
}
