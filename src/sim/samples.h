/* sim/samples.h -- a response over time: what is written down of a sample, and all samples of a run as rows.
 *
 * Where the input energy has gone so far, at every instant
 *
 *   input = kinetic + strain (building) + core (kinetic and strain) + damped_building + damped_core + contacts
 *
 * contacts: lost in impacts, stored in them, taken by the tension clamp.
 * Ownership  track_run allocates, track_free releases
 * Threads    no state */
#pragma once

#include "sim/sim.h"

typedef enum {
    ENERGY_KINETIC,
    ENERGY_STRAIN,
    ENERGY_DAMPED_BUILDING,
    ENERGY_CORE,
    ENERGY_DAMPED_CORE,
    ENERGY_CONTACTS,
    ENERGY_INPUT,
    N_ENERGIES
} EnergyKind;

/* [J]; NAN where the engine has none. */
void sample_energies(const SimSample *s, double energy[N_ENERGIES]);

/* All of a sample that is written down: t [s], ground [g], then of all floors displacement [m] and velocity [m/s]
 * relative to the ground, interstorey drift [m], absolute acceleration [g], displacement and velocity of the core,
 * contact force [N; NAN: the engine has none], then the energies: SAMPLE_FIXED + SAMPLE_PARTS n_floors numbers. */
enum { SAMPLE_PARTS = 7, SAMPLE_FIXED = 2 + N_ENERGIES };
void sample_row(const SimWorker *worker, const SimSample *s, size_t n_floors, double row[]);

/* Rows of a run, from t = 0 on; of one that was repeated with shorter steps the last. */
typedef struct {
    size_t n, n_floors, width;
    double *rows; /* (n, width) as sample_row has them, or track_modes */
    RunOutcome outcome;
    SimWorker *worker; /* while it runs: */
    size_t room;
    int lacks_memory;
} Track;

/* every_s as EngineOptions.sample_spacing; x as for sim_run. */
Status track_run(const Scene *scene, SceneKind kind, const double x[], const LinearDevice *device, double every_s,
                 Track *out, Err *err);

/* The same of the design x: beside t, w q and q' of every mode, whose squares are twice its energy. A run that does not
 * finish fails. */
Status track_modes(const Scene *scene, const double x[], Track *out, Err *err);
void track_free(Track *t);

/* Column k of the rows, 0: t; those behind the floors are the energies. */
static inline double track_at(const Track *t, size_t i, size_t k)
{
    return t->rows[i * t->width + k];
}
