/* base/random.h -- random streams keyed by purpose: none is shared.
 *
 *   stream = (seed, purpose, generation, individual)      draw k of a stream = Philox4x32-10(counter k, key)
 *
 * Two streams with different names are independent; the same name gives the same numbers whatever was drawn elsewhere,
 * by whom and on how many threads.
 *
 * Life cycle  random_stream, then draw; a Random is a plain value, copy it to fork it
 * Threads     a Random belongs to one thread; there is no other state
 * Source      Salmon, Moraes, Dror and Shaw, Parallel random numbers: as easy as 1, 2, 3, SC11 (Random123). */
#pragma once

#include <stddef.h>
#include <stdint.h>

/* One tag for each use, so that no two parts of the program ever draw the same numbers. */
typedef enum {
    RANDOM_SAMPLING = 1,
    RANDOM_PARENTS,
    RANDOM_VARIATION,
    RANDOM_NICHING,
    RANDOM_HYPERVOLUME,
    RANDOM_NOISE,
    RANDOM_REPLICATE,
    RANDOM_TEST,
    RANDOM_DIRECTIONS,
    RANDOM_DESCENT,
    RANDOM_IMPORTANCE = 12,
    RANDOM_PROBES = 14,
    RANDOM_GRAZING,
    RANDOM_MOTION
} RandomPurpose;

typedef struct {
    uint32_t key[2];     /* seed, purpose */
    uint32_t counter[4]; /* block, individual, generation, 0 */
    uint32_t block[4];   /* the numbers at hand */
    int left;            /* how many of them are still unused */
} Random;

Random random_stream(uint32_t seed, RandomPurpose purpose, uint32_t generation, uint32_t individual);

uint32_t random_bits(Random *r);          /* 32 uniform bits */
double random_uniform(Random *r);         /* [0, 1), a multiple of 2^-53 */
size_t random_below(Random *r, size_t n); /* 0..n-1, exactly uniform; n >= 1 */
double random_normal(Random *r);          /* mean 0, variance 1 */
void random_shuffle(Random *r, size_t n, size_t list[]);
