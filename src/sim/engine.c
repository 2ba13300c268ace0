#include "sim/engine.h"

static const EngineEntry ENTRIES[] = {
    [ENGINE_FAST] = {.name = "fast",
                     .words = "exact modal flow, resolved contacts, certified flights",
                     .tolerance = TOLERANCE_STEPS_PER_CONTACT,
                     .run = engine_fast,
                     .refines = 1,
                     .work_create = engine_fast_create,
                     .work_free = engine_fast_free},
    [ENGINE_CVODE] = {.name = "cvode",
                      .words = "SUNDIALS CVODE, Adams, contacts by roots",
                      .tolerance = TOLERANCE_RELATIVE,
                      .run = engine_cvode},
};
_Static_assert(sizeof ENTRIES / sizeof ENTRIES[0] == ENGINE_COUNT, "every engine of the setting has a line here");

const EngineEntry *engine_entry(Engine engine)
{
    return &ENTRIES[engine];
}
