/* sim/floor_set.h -- sets of up to FLOORS_MAX floors: bit j is floor j. Threads  pure functions */
#pragma once

#include "scene/options.h"

__extension__ typedef unsigned __int128 FloorSet;
_Static_assert(FLOORS_MAX == 128, "a set of floors has 128 bits");

/* The lowest floor of a set that is not empty. */
static inline int floor_set_first(FloorSet set)
{
    const uint64_t low = (uint64_t)set;
    return low ? __builtin_ctzll(low) : 64 + __builtin_ctzll((uint64_t)(set >> 64));
}
