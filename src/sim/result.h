/* sim/result.h -- what a simulation answers: the response to one ground motion, and the state sample by sample.
 *
 * Energies in joules. Threads  no state */
#ifndef IMTET_SIM_RESULT_H
#define IMTET_SIM_RESULT_H

#include "scene/building.h"

#define RUN_OUTCOME_LIST(X)                                                                                            \
    X(OK, "ok")                                                                                                        \
    X(NOT_FINITE, "the response is not finite")                                                                        \
    X(OUT_OF_STEPS, "the integrator ran out of steps")                                                                 \
    X(ENERGY_BALANCE, "the energy balance does not close")                                                             \
    X(ENGINE_FAILED, "the integrator failed")
typedef enum {
#define X(name, words) RUN_##name,
    RUN_OUTCOME_LIST(X)
#undef X
} RunOutcome;
const char *run_outcome_words(RunOutcome outcome);

typedef struct {
    RunOutcome outcome;
    char reason[160]; /* empty when outcome is RUN_OK */

    double j1_m, j2_m, j3_g;              /* max |u|, max interstorey drift, max absolute acceleration / 9.81 */
    double ed1_pct, ed5_10_pct, edcs_pct; /* shares of input_energy_j dissipated by modes 1, 5..10, the core */
    double mcore_kg;
    double input_energy_j;       /* - int a (1'M u' + 1'Mc v') dt */
    double energy_balance_error; /* |input - kinetic - strain - damped - contacts| / input */
    long impacts, v0_limited;    /* contact onsets on all floors; those slower than the lower limit of v0 */

    int n_floors, n_modes;
    double peak_displacement_m[FLOORS_MAX], peak_drift_m[FLOORS_MAX], peak_acceleration_g[FLOORS_MAX];
    double mode_share_pct[FLOORS_MAX];                /* of input_energy_j, dissipated by each building mode */
    double contact_loss_j, contact_stored_j, clamp_j; /* lost in contacts, still stored, removed by the no-tension
                                                         condition */
    double damped_building_j, damped_core_j, kinetic_strain_j; /* the last at the end of the run */
    double indentation_max_m, indentation_ratio;               /* [-] over the contact's radius */
    long steps, force_evaluations;                             /* what the run cost */
    double seconds;                                            /* wall time */
} SimResult;

/* Hertz's theory requires an indentation that is small against the radius. Beyond it the figures are those of the
 * model, but the model is no longer that of two bodies of steel. */
#define INDENTATION_RATIO_MAX 0.1
static inline int beyond_contact_law(const SimResult *r)
{
    return r->indentation_ratio > INDENTATION_RATIO_MAX;
}

/* The state at one instant, the energies since the start: modes 0..n_building-1 are the building's, the others the
 * core's, each group padded with idle ones. What a mode has damped is ground + contact - (v^2 + omega^2 q^2) / 2. */
typedef struct {
    double t; /* [s] */
    int n_modes, n_building;
    const double *omega, *q, *v;            /* (n_modes) [rad/s], [m sqrt(kg)], [m sqrt(kg)/s] */
    const double *ground_j, *contact_j;     /* (n_modes) work done on the mode by the ground and by the contacts */
    double contact_loss_j, contact_clamp_j; /* as in SimResult */
} SimSample;

/* Called at t = 0 and at every sample of the motion, again from t = 0 when the run is repeated with shorter steps. */
typedef void (*SimSampleFn)(const SimSample *sample, void *user);

#endif
