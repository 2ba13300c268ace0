#include "moga/hypervolume.h"

#include <math.h>

#include "base/carve.h"
#include "base/random.h"
#include "moga/dominance.h"

static int inside(size_t n_obj, const double f[], const double reference[])
{
    for (size_t k = 0; k < n_obj; k++)
        if (!(f[k] < reference[k]))
            return 0;
    return 1;
}

/* Rows in descending order of objective m - 1 (heap sort: in place, no callback). */
static void sink(size_t m, size_t stride, double P[], size_t i, size_t n)
{
    for (size_t child; (child = 2 * i + 1) < n; i = child) {
        if (child + 1 < n && P[(child + 1) * stride + m - 1] < P[child * stride + m - 1])
            child++;
        if (P[i * stride + m - 1] <= P[child * stride + m - 1])
            return;
        for (size_t k = 0; k < stride; k++) {
            const double kept = P[i * stride + k];
            P[i * stride + k] = P[child * stride + k];
            P[child * stride + k] = kept;
        }
    }
}

static void sort_descending(size_t m, size_t stride, double P[], size_t n)
{
    for (size_t i = n / 2; i-- > 0;)
        sink(m, stride, P, i, n);
    for (size_t last = n; last-- > 1;) {
        for (size_t k = 0; k < stride; k++) {
            const double kept = P[k];
            P[k] = P[last * stride + k];
            P[last * stride + k] = kept;
        }
        sink(m, stride, P, 0, last);
    }
}

/* What of the later points lies behind point i in the first m objectives, dominated ones left out. */
static size_t limit_set(size_t m, size_t stride, const double P[], size_t n, size_t i, double L[])
{
    const double *p = P + i * stride;
    size_t count = 0;
    for (size_t j = i + 1; j < n; j++) {
        double *limited = L + count * stride;
        for (size_t k = 0; k < m; k++)
            limited[k] = fmax(p[k], P[j * stride + k]);
        size_t kept = 0;
        int hidden = 0;
        for (size_t l = 0; l < count && !hidden; l++) {
            int no_worse = 1;
            for (size_t k = 0; k < m; k++)
                no_worse &= L[l * stride + k] <= limited[k];
            hidden = no_worse;
        }
        if (hidden)
            continue;
        for (size_t l = 0; l < count; l++)
            if (!dominates(m, limited, L + l * stride)) {
                memmove(L + kept * stride, L + l * stride, m * sizeof *L);
                kept++;
            }
        memmove(L + kept * stride, limited, m * sizeof *L);
        count = kept + 1;
    }
    return count;
}

/* Points worst in objective m first: for each, its slab along m times what it alone covers in the others. */
static double volume_of(size_t m, size_t stride, size_t n, double P[], const double reference[], double *level,
                        size_t level_size)
{
    double sum = 0.0;
    if (n == 0)
        return 0.0;
    sort_descending(m, stride, P, n);
    if (m == 1)
        return reference[0] - P[(n - 1) * stride];
    for (size_t i = 0; i < n; i++) {
        double own = 1.0;
        for (size_t k = 0; k + 1 < m; k++)
            own *= reference[k] - P[i * stride + k];
        const size_t n_limit = limit_set(m - 1, stride, P, n, i, level);
        own -= volume_of(m - 1, stride, n_limit, level, reference, level + level_size, level_size);
        sum += (reference[m - 1] - P[i * stride + m - 1]) * own;
    }
    return sum;
}

Status hypervolume_exact(size_t n, size_t n_obj, const double F[], const double reference[], Hypervolume *out, Err *err)
{
    const size_t level_size = (n + 1) * n_obj;
    double *levels = calloc(level_size * (n_obj + 1), sizeof *levels);
    if (!levels)
        return fail(err, STATUS_NO_MEMORY, "no memory for the hypervolume of %zu points", n);
    size_t count = 0;
    for (size_t i = 0; i < n; i++)
        if (inside(n_obj, F + i * n_obj, reference))
            memcpy(levels + count++ * n_obj, F + i * n_obj, n_obj * sizeof *F);
    *out = (Hypervolume){volume_of(n_obj, n_obj, count, levels, reference, levels + level_size, level_size), 0.0};
    free(levels);
    return STATUS_OK;
}

enum { SAMPLE_BLOCK = 1024 };

static size_t hits_in_block(size_t n, size_t n_obj, const double P[], const double lower[], const double reference[],
                            size_t samples, Random random, double sample[])
{
    size_t hits = 0;
    for (size_t s = 0; s < samples; s++) {
        for (size_t k = 0; k < n_obj; k++)
            sample[k] = lower[k] + random_uniform(&random) * (reference[k] - lower[k]);
        for (size_t i = 0; i < n; i++) {
            size_t k = 0;
            while (k < n_obj && P[i * n_obj + k] <= sample[k])
                k++;
            if (k == n_obj) {
                hits++;
                break;
            }
        }
    }
    return hits;
}

Status hypervolume_estimate(size_t n, size_t n_obj, const double F[], const double lower[], const double reference[],
                            size_t samples, uint32_t seed, Hypervolume *out, Err *err)
{
    const size_t n_blocks = (samples + SAMPLE_BLOCK - 1) / SAMPLE_BLOCK;
    double *P = calloc((n + n_blocks) * n_obj + 1, sizeof *P), *sample = P ? P + n * n_obj : NULL, box = 1.0;
    if (!P)
        return fail(err, STATUS_NO_MEMORY, "no memory for the hypervolume of %zu points", n);
    size_t count = 0, hits = 0;
    for (size_t i = 0; i < n; i++)
        if (inside(n_obj, F + i * n_obj, reference))
            memcpy(P + count++ * n_obj, F + i * n_obj, n_obj * sizeof *F);
    for (size_t k = 0; k < n_obj; k++)
        box *= reference[k] - lower[k];
#pragma omp parallel for schedule(dynamic, 1) reduction(+ : hits)
    for (size_t b = 0; b < n_blocks; b++) {
        const size_t left = samples - b * SAMPLE_BLOCK;
        hits += hits_in_block(count, n_obj, P, lower, reference, left < SAMPLE_BLOCK ? left : SAMPLE_BLOCK,
                              random_stream(seed, RANDOM_HYPERVOLUME, 0, (uint32_t)b), sample + b * n_obj);
    }
    free(P);
    const double share = (double)hits / (double)samples;
    *out = (Hypervolume){box * share, box * sqrt(share * (1.0 - share) / (double)samples)};
    return STATUS_OK;
}

Status hypervolume(size_t n, size_t n_obj, const double F[], const double lower[], const double reference[],
                   uint32_t seed, Hypervolume *out, Err *err)
{
    if (n_obj <= 3 || n <= 40)
        return hypervolume_exact(n, n_obj, F, reference, out, err);
    return hypervolume_estimate(n, n_obj, F, lower, reference, 100000, seed, out, err);
}
