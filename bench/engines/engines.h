/* bench/engines/engines.h -- every engine that is compared: those of the program, then those that serve comparison.
 *
 * A further engine is a function of type EngineFn, a line in REFERENCE_ENGINES and one in engines.c. */
#ifndef IMTET_BENCH_ENGINES_H
#define IMTET_BENCH_ENGINES_H

#include "sim/engine.h"

#define REFERENCE_ENGINES(X)                                                                                           \
    X(CVODE_BDF, cvode_bdf)                                                                                            \
    X(CVODE_BDF_TUNED, cvode_bdf_tuned)                                                                                \
    X(ARKODE_ERK, arkode_erk)                                                                                          \
    X(ARKODE_ERK_NOEVENTS, arkode_erk_noevents)                                                                        \
    X(ARKODE_DIRK, arkode_dirk)                                                                                        \
    X(ARKODE_IMEX, arkode_imex)                                                                                        \
    X(ETDRK4, etdrk4)                                                                                                  \
    X(LAGGED, lagged)                                                                                                  \
    X(NEWMARK, newmark)                                                                                                \
    X(HHT, hht)                                                                                                        \
    X(CENTRAL, central)                                                                                                \
    X(RADAU, radau)

/* Continues Engine. */
enum {
    BEFORE_REFERENCE_ENGINES = ENGINE_COUNT - 1,
#define X(upper, lower) ENGINE_##upper,
    REFERENCE_ENGINES(X)
#undef X
        BENCH_ENGINES
};

#define X(upper, lower)                                                                                                \
    Status engine_##lower(const SimModel *model, const Motion *motion, const EngineOptions *options,                   \
                          SimResult *result, Err *err);
REFERENCE_ENGINES(X)
#undef X

/* 0 <= engine < BENCH_ENGINES */
const EngineEntry *bench_engine(int engine);

#endif
