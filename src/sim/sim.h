/* sim/sim.h -- from a design and a ground motion to a response: the one door to every engine.
 *
 *     M  u'' + C  u' + K  u - f = -M  1 a(t)        u (n_floors)  floors relative to the ground [m]
 *     Mc v'' + Cc v' + Kc v + f = -Mc 1 a(t)        v (n_floors)  core nodes
 *     f_j = -s F,  s = sign(u_j - v_j),  p = |u_j - v_j| - gap_j,  F = k p^1.5 (1 + a p'/v0) for p > 0, never tensile
 *
 * Both sides in mass-normalised modal coordinates, so that every modal energy is in joules.
 *
 * Life cycle  scene_create -> (sim_worker_create -> sim_run ... -> sim_worker_free) per thread -> scene_free
 * Ownership   the Scene copies what it needs of the Settings and borrows the Motion, which must outlive it
 * Threads     a Scene is read-only after scene_create and shared; a SimWorker belongs to one thread
 * Errors      a simulation that does not finish is information about a design, not an error: sim_run returns
 *             STATUS_OK with outcome != RUN_OK and a reason. Status is for designs that are no designs, no memory */
#ifndef IMTET_SIM_SIM_H
#define IMTET_SIM_SIM_H

#include <math.h>

#include "settings/settings.h"
#include "base/status.h"
#include "scene/building.h"
#include "scene/motion.h"

typedef enum {
    SCENE_IMPACT,  /* building and core with gaps */
    SCENE_NO_CORE, /* the building alone */
    SCENE_TIED     /* floors and core move together: the linear zero-gap building */
} SceneKind;

#define RUN_OUTCOME_LIST(X)                                                                                            \
    X(OK, "ok")                                                                                                        \
    X(NOT_FINITE, "the response is not finite")                                                                        \
    X(OUT_OF_STEPS, "the integrator ran out of steps")                                                                 \
    X(BOOKS_OPEN, "the energy books do not close")                                                                     \
    X(ENGINE_FAILED, "the integrator failed")
typedef enum {
#define X(name, words) RUN_##name,
    RUN_OUTCOME_LIST(X)
#undef X
} RunOutcome;
/* Hertz's theory wants a contact that is small against the radius. What lies beyond is flagged: the figures are those
 * of the model, but the model is no longer that of two bodies of steel. */
#define PENETRATION_RATIO_MAX 0.1
const char *run_outcome_words(RunOutcome outcome);

typedef struct {
    RunOutcome outcome;
    char reason[160]; /* empty when outcome is RUN_OK */

    double j1_m, j2_m, j3_g;              /* max |u|, max interstorey drift, max absolute acceleration / 9.81 */
    double ed1_pct, ed5_10_pct, edcs_pct; /* shares of input_energy_j dissipated by modes 1, 5..10, the core */
    double mcore_kg;
    double input_energy_j;  /* - int a (1'M u' + 1'Mc v') dt */
    double energy_residual; /* |input - kinetic - strain - damped - contacts| / input */
    long impacts, floored;  /* closings of any gap; those slower than the floor under v0 */

    int n_floors, n_modes;
    double peak_displacement_m[FLOORS_MAX], peak_drift_m[FLOORS_MAX], peak_acceleration_g[FLOORS_MAX];
    double mode_share_pct[FLOORS_MAX];                /* of input_energy_j, dissipated by each building mode */
    double contact_loss_j, contact_stored_j, clamp_j; /* lost in contacts, still stored, removed by the tension clamp */
    double damped_building_j, damped_core_j, kinetic_strain_j; /* the last at the end of the run */
    double penetration_max_m, penetration_ratio;               /* [-] over the contact's radius */
    int beyond_contact_law;                                    /* penetration_ratio is above PENETRATION_RATIO_MAX */
    long steps, force_evaluations;                             /* what the run cost */
    double seconds;                                            /* wall time */
} SimResult;

/* What the residual is a share of: the input, or what came out where the ground has taken back all that it gave. */
static inline double energy_books_scale(double input, double out)
{
    const double scale = input > 0 ? input : fmax(-input, out);
    return scale > 0 ? scale : 1;
}

typedef struct Scene Scene;
typedef struct SimWorker SimWorker;

Status scene_create(Scene **out, const Settings *s, const Motion *motion, Err *err);
void scene_free(Scene *scene); /* NULL is fine */

int scene_n_floors(const Scene *scene);

/* Undamped natural frequencies [Hz], ascending; each array has room for FLOORS_MAX. x: the design variables, gap_1..n
 * [m], t_base, t_top [m] (n_floors + 2). */
Status scene_frequencies(const Scene *scene, const double x[], double building_hz[], double core_hz[],
                         double zero_gap_hz[], double *core_mass_kg, Err *err);

Status sim_worker_create(SimWorker **out, const Scene *scene, Err *err);
void sim_worker_free(SimWorker *worker); /* NULL is fine */

/* The state at one instant, the energies since the start: modes 0..n_building-1 are the building's, the others the
 * core's, each group padded with idle ones. What a mode has damped is ground + contact - (v^2 + omega^2 q^2) / 2. */
typedef struct {
    double t; /* [s] */
    int n_modes, n_building;
    const double *omega, *q, *v;            /* (n_modes) [rad/s], [m sqrt(kg)], [m sqrt(kg)/s] */
    const double *ground_j, *contact_j;     /* (n_modes) work done on the mode by the ground and by the contacts */
    double contact_loss_j, contact_clamp_j; /* as in SimResult */
} SimSample;

/* Called by the engine fast at t = 0 and at every sample of the motion, again from t = 0 when the run has to be
 * repeated with shorter steps. NULL: never. */
typedef void (*SimSampleFn)(const SimSample *sample, void *user);
void sim_worker_sample(SimWorker *worker, SimSampleFn sample, void *user);

/* Displacements u (n_floors) [m] of the floors at a sample. */
void sim_worker_floors(const SimWorker *worker, const SimSample *sample, double u[]);

/* x (n_floors + 2) as above; ignored for SCENE_NO_CORE. */
Status sim_run(SimWorker *worker, SceneKind kind, const double x[], SimResult *result, Err *err);

#endif
