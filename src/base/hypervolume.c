#include "base/hypervolume.h"

#include "base/clones.h"
#include "base/dominance.h"
#include "base/random.h"

/* Samples are bits of words. For each objective and each of so many levels between the bounds of the box: which
 * samples are not below that level. What a design dominates is in all sets of its own levels, which few others are. */
#define WORDS_OF(n) (((n) + WORD * SOME - 1) / (WORD * SOME) * SOME) /* that n samples take */
enum {
    LEVELS = 128,
    FEW = 2,
    WORD = 64,
    SOME = 8, /* words come in multiples of it: whole vectors */
    WORDS = WORDS_OF(HYPERVOLUME_SAMPLES)
};

struct Hypervolume {
    size_t n_obj, n_left, n_words; /* a multiple of SOME */
    uint64_t left[WORDS];          /* (n_words) samples that are not dominated yet */
    uint64_t *above;               /* (n_obj, LEVELS, WORDS) */
    double *lower, *per;           /* (n_obj) levels per unit of the objective */
    double sample[];               /* (HYPERVOLUME_SAMPLES, n_obj), then lower, per, above */
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

/* Sample i into the sets of its own levels. */
static void note_sample(Hypervolume *h, size_t i)
{
    const uint64_t bit = (uint64_t)1 << i % WORD;
    h->left[i / WORD] |= bit;
    for (size_t k = 0; k < h->n_obj; k++)
        samples_above(h, k, level_of(h, k, h->sample[i * h->n_obj + k]))[i / WORD] |= bit;
}

/* ... and from there into those of the lower ones. */
static void join_levels(Hypervolume *h)
{
    for (size_t k = 0; k < h->n_obj; k++)
        for (size_t level = LEVELS - 1; level-- > 0;)
            for (size_t w = 0; w < h->n_words; w++)
                samples_above(h, k, level)[w] |= samples_above(h, k, level + 1)[w];
}

void hypervolume_box(size_t n_obj, double lower[], double reference[])
{
    for (size_t k = 0; k < n_obj; k++) {
        const double range = reference[k] > lower[k] ? reference[k] - lower[k] : 1.0;
        lower[k] -= 0.2 * range;
        reference[k] = fmax(reference[k], lower[k] + range);
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
    h->n_words = WORDS;
    h->lower = h->sample + HYPERVOLUME_SAMPLES * n_obj;
    h->per = h->lower + n_obj;
    h->above = (void *)(h->per + n_obj);
    for (size_t k = 0; k < n_obj; k++) {
        h->lower[k] = lower[k];
        h->per[k] = LEVELS / (reference[k] - lower[k]);
    }
    for (size_t i = 0; i < HYPERVOLUME_SAMPLES; i++) {
        Random r = random_stream(seed, RANDOM_HYPERVOLUME, 0, (uint32_t)i);
        for (size_t k = 0; k < n_obj; k++)
            h->sample[i * n_obj + k] = lower[k] + (reference[k] - lower[k]) * random_uniform(&r);
        note_sample(h, i);
    }
    join_levels(h);
    return STATUS_OK;
}

/* Of those samples the ones that are in another set. */
CLONED_V3 static void keep_common(size_t n_words, uint64_t near[], const uint64_t above[])
{
#pragma omp simd
    for (size_t w = 0; w < n_words; w++)
        near[w] &= above[w];
}

/* Samples that are left and that f dominates; returns how many. They are among those that are not below the level of f
 * in any objective. */
static size_t find_dominated(const Hypervolume *h, const double f[], uint64_t near[WORDS])
{
    const size_t m = h->n_obj;
    size_t n = 0;
    memcpy(near, h->left, h->n_words * sizeof *near);
    for (size_t k = 0; k < m; k++)
        keep_common(h->n_words, near, samples_above(h, k, level_of(h, k, f[k])));
    for (size_t w = 0; w < h->n_words; w++)
        for (uint64_t rest = near[w]; rest; rest &= rest - 1) {
            const size_t bit = __builtin_ctzll(rest);
            const int is_dominated = is_no_worse(m, f, h->sample + (w * WORD + bit) * m);
            near[w] ^= (uint64_t)!is_dominated << bit;
            n += is_dominated;
        }
    return n;
}

double hypervolume_gain(const Hypervolume *h, const double f[])
{
    uint64_t dominated[WORDS];
    return (double)find_dominated(h, f, dominated) / HYPERVOLUME_SAMPLES;
}

void hypervolume_add(Hypervolume *h, const double f[])
{
    const size_t m = h->n_obj;
    uint64_t dominated[WORDS];
    size_t n = find_dominated(h, f, dominated);
    h->n_left -= n;
    for (size_t w = 0; n > 0 && w < h->n_words; w++)
        h->left[w] ^= dominated[w];
    if (WORDS_OF(FEW * h->n_left) >= h->n_words)
        return;

    /* Samples that are left move together, so that fewer words are looked at. */
    n = 0;
    for (size_t w = 0; w < h->n_words; w++)
        for (uint64_t rest = h->left[w]; rest; rest &= rest - 1, n++)
            memmove(h->sample + n * m, h->sample + (w * WORD + __builtin_ctzll(rest)) * m, m * sizeof *h->sample);
    memset(h->left, 0, sizeof h->left);
    memset(h->above, 0, m * LEVELS * WORDS * sizeof *h->above);
    for (size_t i = 0; i < n; i++)
        note_sample(h, i);
    h->n_words = WORDS_OF(n);
    join_levels(h);
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
