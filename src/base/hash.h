/* base/hash.h -- FNV-1a, 64 bit: tells whether two files or matrices are the same bytes; not for adversaries. */
#pragma once

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
