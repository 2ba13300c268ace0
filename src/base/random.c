#include "base/random.h"

#include <math.h>
#include <string.h>

#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wconversion"
#pragma GCC diagnostic ignored "-Wmissing-prototypes"
#include <Random123/philox.h>
#pragma GCC diagnostic pop

Random random_stream(uint32_t seed, RandomPurpose purpose, uint32_t generation, uint32_t individual)
{
    return (Random){.key = {seed, purpose}, .counter = {0, individual, generation, 0}};
}

/* Numbers come in blocks of four. */
uint32_t random_bits(Random *r)
{
    if (r->left == 0) {
        const philox4x32_ctr_t counter = {{r->counter[0], r->counter[1], r->counter[2], r->counter[3]}};
        const philox4x32_key_t key = {{r->key[0], r->key[1]}};
        const philox4x32_ctr_t block = philox4x32(counter, key);
        memcpy(r->block, block.v, sizeof r->block);
        r->left = 4;
        if (++r->counter[0] == 0)
            r->counter[3]++;
    }
    return r->block[4 - r->left--];
}

static uint64_t bits64(Random *r)
{
    const uint64_t high = random_bits(r);
    return high << 32 | random_bits(r);
}

double random_uniform(Random *r)
{
    return (double)(bits64(r) >> 11) * 0x1p-53;
}

/* The lowest 2^64 mod n values would make small numbers likelier: they are drawn again. */
size_t random_below(Random *r, size_t n)
{
    const uint64_t span = n, skip = (0 - span) % span;
    uint64_t bits;
    do
        bits = bits64(r);
    while (bits < skip);
    return bits % span;
}

/* Box and Muller; 1 - u lies in (0, 1], so the logarithm is finite. */
double random_normal(Random *r)
{
    const double radius = sqrt(-2.0 * log(1.0 - random_uniform(r)));
    return radius * cos(2.0 * M_PI * random_uniform(r));
}

void random_shuffle(Random *r, size_t n, size_t list[])
{
    for (size_t i = n; i > 1; i--) {
        const size_t j = random_below(r, i), kept = list[i - 1];
        list[i - 1] = list[j];
        list[j] = kept;
    }
}
