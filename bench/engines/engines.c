#include "bench/engines/engines.h"

#include <string.h>

static const EngineEntry ENTRIES[] = {
#define X(upper, lower, kind) {.name = #lower, .tolerance = kind, .run = engine_##lower},
    REFERENCE_ENGINES(X)
#undef X
};

const EngineEntry *bench_engine(int engine)
{
    return engine < ENGINE_COUNT ? engine_entry((Engine)engine) : &ENTRIES[engine - ENGINE_COUNT];
}

int bench_engine_named(const char *name)
{
    int k = 0;
    while (k < BENCH_ENGINES && strcmp(name, bench_engine(k)->name) != 0)
        k++;
    return k;
}
