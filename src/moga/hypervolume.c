#include "moga/hypervolume.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/random.h"

struct Hypervolume {
    size_t n_obj, n_left;
    double sample[]; /* (n_left, n_obj) not dominated yet */
};

Status hypervolume_create(Hypervolume **out, size_t n_obj, const double lower[], const double reference[],
                          uint32_t seed, Err *err)
{
    Hypervolume *h = malloc(sizeof *h + HYPERVOLUME_SAMPLES * n_obj * sizeof h->sample[0]);
    *out = h;
    if (!h)
        return fail(err, STATUS_NO_MEMORY, "no memory for %d samples of %zu objectives", HYPERVOLUME_SAMPLES, n_obj);
    h->n_obj = n_obj;
    h->n_left = HYPERVOLUME_SAMPLES;
    for (size_t i = 0; i < HYPERVOLUME_SAMPLES; i++) {
        Random r = random_stream(seed, RANDOM_HYPERVOLUME, 0, (uint32_t)i);
        for (size_t k = 0; k < n_obj; k++)
            h->sample[i * n_obj + k] = lower[k] + (reference[k] - lower[k]) * random_uniform(&r);
    }
    return STATUS_OK;
}

void hypervolume_add(Hypervolume *h, const double f[])
{
    const size_t m = h->n_obj;
    size_t left = 0;
    for (size_t i = 0; i < h->n_left; i++) {
        const double *s = h->sample + i * m;
        size_t k = 0;
        while (k < m && f[k] <= s[k])
            k++;
        if (k == m)
            continue;
        if (left < i)
            memcpy(h->sample + left * m, s, m * sizeof *s);
        left++;
    }
    h->n_left = left;
}

double hypervolume_share(const Hypervolume *h)
{
    return 1.0 - (double)h->n_left / HYPERVOLUME_SAMPLES;
}

double hypervolume_error(double share)
{
    return sqrt(share * (1.0 - share) / HYPERVOLUME_SAMPLES);
}

void hypervolume_free(Hypervolume *h)
{
    free(h);
}
