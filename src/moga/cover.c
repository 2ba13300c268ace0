#include "moga/cover.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/random.h"

struct Cover {
    size_t n_obj, n_left;
    double sample[]; /* (n_left, n_obj) that nobody dominates yet */
};

Status cover_create(Cover **out, size_t n_obj, const double lower[], const double reference[], uint32_t seed, Err *err)
{
    Cover *c = malloc(sizeof *c + COVER_SAMPLES * n_obj * sizeof c->sample[0]);
    *out = c;
    if (!c)
        return fail(err, STATUS_NO_MEMORY, "no memory for %d samples of %zu objectives", COVER_SAMPLES, n_obj);
    c->n_obj = n_obj;
    c->n_left = COVER_SAMPLES;
    for (size_t i = 0; i < COVER_SAMPLES; i++) {
        Random r = random_stream(seed, RANDOM_HYPERVOLUME, 0, (uint32_t)i);
        for (size_t k = 0; k < n_obj; k++)
            c->sample[i * n_obj + k] = lower[k] + (reference[k] - lower[k]) * random_uniform(&r);
    }
    return STATUS_OK;
}

void cover_add(Cover *c, const double f[])
{
    const size_t m = c->n_obj;
    size_t left = 0;
    for (size_t i = 0; i < c->n_left; i++) {
        const double *s = c->sample + i * m;
        size_t k = 0;
        while (k < m && f[k] <= s[k])
            k++;
        if (k < m)
            memmove(c->sample + left++ * m, s, m * sizeof *s);
    }
    c->n_left = left;
}

double cover_share(const Cover *c)
{
    return 1.0 - (double)c->n_left / COVER_SAMPLES;
}

double cover_error(double share)
{
    return sqrt(share * (1.0 - share) / COVER_SAMPLES);
}

void cover_free(Cover *c)
{
    free(c);
}
