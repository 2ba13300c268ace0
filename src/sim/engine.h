/* sim/engine.h -- what every integrator of the model looks like.
 *
 *   run(model, motion, options, result)    from rest at t = 0 to options.duration
 *
 * An engine fills all of SimResult but mcore_kg, indentation_ratio, bumper_strain and seconds (the caller's).
 * Energies as in sim/energy_balance.h; maxima are over continuous time. After the last sample the ground stands still
 * (a = 0 from there on, also where the last sample is not zero). What an engine cannot do is an outcome with a reason.
 *
 * Threads  an engine may allocate in its own run; it shares nothing. */
#pragma once

#include "motion/motion.h"
#include "sim/force_monitor.h"
#include "sim/model.h"
#include "sim/result.h"

typedef struct {
    int floor;       /* from 0 */
    double t, speed; /* when its gap closed [s], how fast [m/s] */
} ContactOnset;

/* The first contact onsets of any floor, in the order in which the engine found them. */
typedef struct {
    int n, n_max;
    ContactOnset *at; /* (n_max) */
} OnsetLog;

typedef struct {
    double duration; /* [s] > 0 */
    Accuracy accuracy;
    double tolerance;         /* of the kind EngineEntry.tolerance; 0: as `accuracy` says */
    double *end_state;        /* (2 m) q and q' where the run ended; NULL: not wanted */
    OnsetLog *onsets;         /* filled from onsets->n on; NULL: not wanted */
    double steps_per_contact; /* `fast`: all that `accuracy` says follows so many steps; 0: as it is */
    double refinement;        /* `fast`: all that `accuracy` says is refined by this factor; 0: by none */
    const double *tail_input; /* `fast`: (n of the motion) [J] of tail_input, sim/tail.h; NULL: contacts to the end */
    SimSampleFn sample;       /* NULL: not wanted */
    void *sample_user;
    double sample_spacing; /* [s] at most, by halving the motion's samples; 0: every sample of the motion */
    int sample_peaks;      /* samples are wanted for peaks of the floors: the core's modes, force and energies may be
                              anything, and samples may end where no peak can rise any more */
    double sample_memory;  /* [s] samples wanted before and after those that are, where others may be left out */
    SimSkipFn skip;        /* with sample_peaks: which may be left out; NULL: none; `fast` alone does */
    ForceMonitor *forces;  /* set for this design; NULL: not wanted */
    void *work;            /* from EngineEntry.work_create; NULL: the run allocates its own */
} EngineOptions;

typedef Status EngineFn(const SimModel *model, const Motion *motion, const EngineOptions *options, SimResult *result,
                        Err *err);

/* The number by which an engine controls its error. */
typedef enum {
    TOLERANCE_STEP,             /* [s] fixed step */
    TOLERANCE_RELATIVE,         /* [-] relative local error */
    TOLERANCE_STEPS_PER_CONTACT /* [-] */
} ToleranceKind;

typedef struct EngineEntry {
    const char *name, *words;
    ToleranceKind tolerance;
    EngineFn *run;
    int refines; /* follows EngineOptions.refinement: a run whose energy balance does not close may be repeated */
    /* Work space for any number of runs of up to n_floors, nb building modes and so many devices, one at a time, where
     * storeys yield or none does; both NULL: the engine keeps none. */
    Status (*work_create)(void **work, int n_floors, int nb, int yields, int devices, Err *err);
    void (*work_free)(void *work); /* NULL is fine */
} EngineEntry;

/* The deepest approach [m] of a floor to the core, with a bumper the steel's indentation and the bumper's compression.
 */
static inline void result_add_approach(SimResult *r, const Contact *c, double approach)
{
    const double indentation = contact_indentation(c, approach);
    r->indentation_max_m = fmax(r->indentation_max_m, indentation);
    if (c->bumper > 0)
        r->bumper_compression_m = fmax(r->bumper_compression_m, approach - indentation);
}

/* By Engine, the setting sim.engine. */
const EngineEntry *engine_entry(Engine engine);

EngineFn engine_fast, engine_cvode;

/* The work space of engine_fast. */
Status engine_fast_create(void **work, int n_floors, int nb, int yields, int devices, Err *err);
void engine_fast_free(void *work);
