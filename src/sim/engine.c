#include "sim/engine.h"

static const EngineEntry ENTRIES[] = {
    [ENGINE_FAST] = {"fast", "exact modal flow, resolved contacts, certified flights", TOLERANCE_STEPS_PER_CONTACT,
                     engine_fast},
    [ENGINE_CVODE] = {"cvode", "SUNDIALS CVODE, Adams, contacts by roots", TOLERANCE_RELATIVE, engine_cvode},
    [ENGINE_CVODE_BDF] = {"cvode_bdf", "CVODE, BDF, dense Jacobian by differences, contacts by roots",
                          TOLERANCE_RELATIVE, engine_cvode_bdf},
    [ENGINE_CVODE_BDF_TUNED] = {"cvode_bdf_tuned", "CVODE, BDF up to order 2, own linear solver, contacts by roots",
                                TOLERANCE_RELATIVE, engine_cvode_bdf_tuned},
    [ENGINE_ARKODE_ERK] = {"arkode_erk", "ARKODE, explicit, contacts by roots", TOLERANCE_RELATIVE, engine_arkode_erk},
    [ENGINE_ARKODE_ERK_NOEVENTS] = {"arkode_erk_noevents", "ARKODE, explicit, contacts as they are met",
                                    TOLERANCE_RELATIVE, engine_arkode_erk_noevents},
    [ENGINE_ARKODE_DIRK] = {"arkode_dirk", "ARKODE, implicit of order 5, own linear solver, contacts by roots",
                            TOLERANCE_RELATIVE, engine_arkode_dirk},
    [ENGINE_ARKODE_IMEX] = {"arkode_imex", "ARKODE, ARK436, modes implicit, contacts explicit and by roots",
                            TOLERANCE_RELATIVE, engine_arkode_imex},
    [ENGINE_ETDRK4] = {"etdrk4", "exponential Runge-Kutta of order 4, fixed step", TOLERANCE_STEP, engine_etdrk4},
    [ENGINE_LAGGED] = {"lagged", "exact modal flow, contact forces held over a fixed step", TOLERANCE_STEP,
                       engine_lagged},
    [ENGINE_NEWMARK] = {"newmark", "Newmark's average acceleration, Newton, fixed step", TOLERANCE_STEP,
                        engine_newmark},
    [ENGINE_HHT] = {"hht", "generalised alpha (0.8 at infinity), Newton, fixed step", TOLERANCE_STEP, engine_hht},
    [ENGINE_CENTRAL] = {"central", "central differences, fixed step", TOLERANCE_STEP, engine_central},
    [ENGINE_RADAU] = {"radau", "Radau IIA of order 5, Newton, fixed step", TOLERANCE_STEP, engine_radau},
};
_Static_assert(sizeof ENTRIES / sizeof ENTRIES[0] == ENGINE_COUNT, "every engine of the setting has a line here");

const EngineEntry *engine_entry(Engine engine)
{
    return &ENTRIES[engine];
}
