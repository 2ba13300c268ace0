#include "moga/hypervolume.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/random.h"

/* Samples are bits of words. For each objective and each of so many levels between the bounds of the box: which samples are not
 * below that level. What a design dominates is in all sets of its own levels, which few others are. */
enum { LEVELS = 64, WORD = 64, WORDS = (HYPERVOLUME_SAMPLES + WORD - 1) / WORD };

struct Hypervolume {
    size_t n_obj, n_left;
    uint64_t left[WORDS]; /* samples that are not dominated yet */
    uint64_t *above;      /* (n_obj, LEVELS, WORDS) */
    double *lower, *per;  /* (n_obj) levels per unit of the objective */
    double sample[];      /* (HYPERVOLUME_SAMPLES, n_obj), then lower, per, above */
};

/* Never falls while the value grows. */
static size_t level_of(const Hypervolume *h, size_t k, double value)
{
    const double level = (value - h->lower[k]) * h->per[k];
    return !(level > 0.0) ? 0 : level < LEVELS ? (size_t)level : LEVELS - 1;
}

static uint64_t *samples_above(const Hypervolume *h, size_t k, size_t level)
{
    return h->above + (k * LEVELS + level) * WORDS;
}

static void sample_at(const Hypervolume *h, uint32_t seed, size_t i, double u[])
{
    Random r = random_stream(seed, RANDOM_HYPERVOLUME, 0, (uint32_t)i);
    for (size_t k = 0; k < h->n_obj; k++)
        u[k] = random_uniform(&r);
}

static void fill(Hypervolume *h, const double lower[], const double reference[], uint32_t seed)
{
    const size_t m = h->n_obj;
    for (size_t k = 0; k < m; k++) {
        h->lower[k] = lower[k];
        h->per[k] = LEVELS / (reference[k] - lower[k]);
    }
    for (size_t i = 0; i < HYPERVOLUME_SAMPLES; i++) {
        double *s = h->sample + i * m;
        const uint64_t bit = (uint64_t)1 << i % WORD;
        sample_at(h, seed, i, s);
        h->left[i / WORD] |= bit;
        for (size_t k = 0; k < m; k++) {
            s[k] = lower[k] + (reference[k] - lower[k]) * s[k];
            for (size_t level = 0; level <= level_of(h, k, s[k]); level++)
                samples_above(h, k, level)[i / WORD] |= bit;
        }
    }
}

Status hypervolume_create(Hypervolume **out, size_t n_obj, const double lower[], const double reference[],
                          uint32_t seed, Err *err)
{
    const size_t n = (HYPERVOLUME_SAMPLES + 2) * n_obj;
    Hypervolume *h = calloc(1, sizeof *h + n * sizeof h->sample[0] + n_obj * LEVELS * WORDS * sizeof h->left[0]);
    *out = h;
    if (!h)
        return fail(err, STATUS_NO_MEMORY, "no memory for %d samples of %zu objectives", HYPERVOLUME_SAMPLES, n_obj);
    h->n_obj = n_obj;
    h->n_left = HYPERVOLUME_SAMPLES;
    h->lower = h->sample + HYPERVOLUME_SAMPLES * n_obj;
    h->per = h->lower + n_obj;
    h->above = (uint64_t *)(h->per + n_obj);
    fill(h, lower, reference, seed);
    return STATUS_OK;
}

static int reaches(size_t m, const double f[], const double s[])
{
    for (size_t k = 0; k < m; k++)
        if (!(f[k] <= s[k]))
            return 0;
    return 1;
}

void hypervolume_add(Hypervolume *h, const double f[])
{
    const size_t m = h->n_obj;
    uint64_t near[WORDS];
    memcpy(near, h->left, sizeof near);
    for (size_t k = 0; k < m; k++) {
        const uint64_t *above = samples_above(h, k, level_of(h, k, f[k]));
#pragma omp simd
        for (size_t w = 0; w < WORDS; w++)
            near[w] &= above[w];
    }
    for (size_t w = 0; w < WORDS; w++)
        for (uint64_t rest = near[w]; rest; rest &= rest - 1) {
            const size_t bit = (size_t)__builtin_ctzll(rest);
            if (!reaches(m, f, h->sample + (w * WORD + bit) * m))
                continue;
            h->left[w] ^= (uint64_t)1 << bit;
            h->n_left--;
        }
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
