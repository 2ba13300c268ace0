/* store/digest.h -- check values of what a run's database holds, by which a bit that the disk has changed is found.
 *
 *   digest_text(s, digest_number(v, digest_whole(n, HASH_SEED)))      of a row, one value after the other (FNV-1a)
 *   digest_kind(kind, generation)                                     joined to a row's digest by exclusive or, and so
 *                                                                     taken out again: both change after it is written
 *   digest_member(id)                                                 of a set, joined in any order
 *
 * Not for adversaries. Threads  no state */
#ifndef IMTET_STORE_DIGEST_H
#define IMTET_STORE_DIGEST_H

#include <math.h>
#include <string.h>

#include "base/hash.h"
#include "evaluate/evaluation.h"

static inline uint64_t digest_whole(long value, uint64_t hash)
{
    return hash_fnv1a(&value, sizeof value, hash);
}

/* As SQLite gives it back: it keeps no -0, and NULL for what is not finite. */
static inline double digest_known(double value)
{
    return isfinite(value) ? value + 0.0 : -1e308;
}

static inline uint64_t digest_number(double value, uint64_t hash)
{
    const double known = digest_known(value);
    return hash_fnv1a(&known, sizeof known, hash);
}

static inline uint64_t digest_text(const char *text, uint64_t hash)
{
    return hash_fnv1a(text ? text : "", text ? strlen(text) + 1 : 1, hash);
}

static inline uint64_t digest_kind(EvaluationKind kind, long generation)
{
    return kind == KIND_UNFINISHED ? 0 : digest_text(kind_word(kind), digest_whole(generation, HASH_SEED));
}

static inline uint64_t digest_member(long id)
{
    return digest_whole(id, HASH_SEED);
}

#endif
