#include "sim/engine.h"

#include "sim/fast/fast.h"

static const EngineEntry ENTRIES[] = {
    [ENGINE_FAST] = {"fast", "exact modal flow, resolved contacts, certified flights", KNOB_STEPS_PER_CONTACT,
                     engine_fast},
    [ENGINE_CVODE] = {"cvode", "SUNDIALS CVODE, Adams, contacts by roots", KNOB_TOLERANCE, engine_cvode},
};
_Static_assert(sizeof ENTRIES / sizeof ENTRIES[0] == ENGINE_COUNT, "every engine of the setting has a line here");

const EngineEntry *engine_entry(Engine engine)
{
    return &ENTRIES[engine];
}
