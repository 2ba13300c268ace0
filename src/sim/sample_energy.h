/* sim/sample_energy.h -- where the input energy has gone so far, at one instant of a response.
 *
 *   input = kinetic + strain (building) + core (kinetic and strain) + damped_building + damped_core + contacts
 *
 * contacts: lost in impacts, stored in them, taken by the tension clamp.
 * Threads  no state */
#pragma once

#include "sim/result.h"

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

typedef struct SimWorker SimWorker;

/* All of a sample that is written down: t [s], ground [g], then of all floors displacement [m] and velocity [m/s]
 * relative to the ground, interstorey drift [m], absolute acceleration [g], displacement and velocity of the core,
 * contact force [N; NAN: the engine has none], then the energies: SAMPLE_FIXED + SAMPLE_PARTS n_floors numbers. */
enum { SAMPLE_PARTS = 7, SAMPLE_FIXED = 2 + N_ENERGIES };
void sample_row(const SimWorker *worker, const SimSample *s, size_t n_floors, double row[]);
