#include "bench/engines/engines.h"

static const EngineEntry ENTRIES[] = {
    [ENGINE_CVODE_BDF - ENGINE_COUNT] = {.name = "cvode_bdf",
                                         .words = "CVODE, BDF, dense Jacobian by differences, contacts by roots",
                                         .tolerance = TOLERANCE_RELATIVE,
                                         .run = engine_cvode_bdf},
    [ENGINE_CVODE_BDF_TUNED -
        ENGINE_COUNT] = {.name = "cvode_bdf_tuned",
                         .words = "CVODE, BDF up to order 2, own linear solver, contacts by roots",
                         .tolerance = TOLERANCE_RELATIVE,
                         .run = engine_cvode_bdf_tuned},
    [ENGINE_ARKODE_ERK - ENGINE_COUNT] = {.name = "arkode_erk",
                                          .words = "ARKODE, explicit, contacts by roots",
                                          .tolerance = TOLERANCE_RELATIVE,
                                          .run = engine_arkode_erk},
    [ENGINE_ARKODE_ERK_NOEVENTS - ENGINE_COUNT] = {.name = "arkode_erk_noevents",
                                                   .words = "ARKODE, explicit, contacts by overlap",
                                                   .tolerance = TOLERANCE_RELATIVE,
                                                   .run = engine_arkode_erk_noevents},
    [ENGINE_ARKODE_DIRK - ENGINE_COUNT] = {.name = "arkode_dirk",
                                           .words = "ARKODE, implicit of order 5, own linear solver, contacts by roots",
                                           .tolerance = TOLERANCE_RELATIVE,
                                           .run = engine_arkode_dirk},
    [ENGINE_ARKODE_IMEX - ENGINE_COUNT] = {.name = "arkode_imex",
                                           .words = "ARKODE, ARK436, modes implicit, contacts explicit and by roots",
                                           .tolerance = TOLERANCE_RELATIVE,
                                           .run = engine_arkode_imex},
    [ENGINE_ETDRK4 - ENGINE_COUNT] = {.name = "etdrk4",
                                      .words = "exponential Runge-Kutta of order 4, fixed step",
                                      .tolerance = TOLERANCE_STEP,
                                      .run = engine_etdrk4},
    [ENGINE_LAGGED - ENGINE_COUNT] = {.name = "lagged",
                                      .words = "exact modal flow, contact forces held over a fixed step",
                                      .tolerance = TOLERANCE_STEP,
                                      .run = engine_lagged},
    [ENGINE_NEWMARK - ENGINE_COUNT] = {.name = "newmark",
                                       .words = "Newmark's average acceleration, Newton, fixed step",
                                       .tolerance = TOLERANCE_STEP,
                                       .run = engine_newmark},
    [ENGINE_HHT - ENGINE_COUNT] = {.name = "hht",
                                   .words = "generalised alpha (0.8 at infinity), Newton, fixed step",
                                   .tolerance = TOLERANCE_STEP,
                                   .run = engine_hht},
    [ENGINE_CENTRAL - ENGINE_COUNT] = {.name = "central",
                                       .words = "central differences, fixed step",
                                       .tolerance = TOLERANCE_STEP,
                                       .run = engine_central},
    [ENGINE_RADAU - ENGINE_COUNT] = {.name = "radau",
                                     .words = "Radau IIA of order 5, Newton, fixed step",
                                     .tolerance = TOLERANCE_STEP,
                                     .run = engine_radau},
};
_Static_assert(sizeof ENTRIES / sizeof ENTRIES[0] == BENCH_ENGINES - ENGINE_COUNT, "every reference engine has a line");

const EngineEntry *bench_engine(int engine)
{
    return engine < ENGINE_COUNT ? engine_entry((Engine)engine) : &ENTRIES[engine - ENGINE_COUNT];
}
