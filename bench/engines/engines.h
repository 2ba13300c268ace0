/* bench/engines/engines.h -- every engine that is compared: those of the program, then the fastest of each family of
 * methods beside it.
 *
 * A further engine is a function of type EngineFn and a line of REFERENCE_ENGINES: name, kind of its tolerance. */
#pragma once

#include "sim/engine.h"

#define REFERENCE_ENGINES(X)                                                                                           \
    X(CVODE_BDF, cvode_bdf, TOLERANCE_RELATIVE)                                                                        \
    X(ARKODE_IMEX, arkode_imex, TOLERANCE_RELATIVE)                                                                    \
    X(ETDRK4, etdrk4, TOLERANCE_STEP)                                                                                  \
    X(NEWMARK, newmark, TOLERANCE_STEP)                                                                                \
    X(RADAU, radau, TOLERANCE_STEP)

/* Continues Engine. */
enum {
    BEFORE_REFERENCE_ENGINES = ENGINE_COUNT - 1,
#define X(upper, lower, tolerance) ENGINE_##upper,
    REFERENCE_ENGINES(X)
#undef X
        BENCH_ENGINES
};

#define X(upper, lower, tolerance) EngineFn engine_##lower;
REFERENCE_ENGINES(X)
#undef X

/* 0 <= engine < BENCH_ENGINES */
const EngineEntry *bench_engine(int engine);

/* The engine of this name; BENCH_ENGINES: there is none. */
int bench_engine_named(const char *name);
