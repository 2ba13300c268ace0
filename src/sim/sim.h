/* sim/sim.h -- from a design and a ground motion to a response: the one interface to every engine.
 *
 *     M  u'' + C  u' + K  u - f = -M  1 a(t)        u (n_floors)  floors relative to the ground [m]
 *     Mc v'' + Cc v' + Kc v + f = -Mc 1 a(t)        v (n_floors)  core nodes
 *     f_j = -s F,  p = s (u_j - v_j) - gap_j on side s = 1, -1,  F = k p^1.5 (1 + a p'/v0) for p > 0, never tensile
 *
 * Both sides in mass-normalised modal coordinates, so that every modal energy is in joules.
 *
 * Life cycle  scene_create -> (sim_worker_create -> sim_run ... -> sim_worker_free) per thread -> scene_free
 * Ownership   the Scene copies its options and borrows the Motion, which must outlive it
 * Threads     a Scene is read-only after scene_create and shared; a SimWorker belongs to one thread
 * Errors      a simulation that does not finish is information about a design, not an error: sim_run returns
 *             STATUS_OK with outcome != RUN_OK and a reason. Status is for designs that are no designs, no memory */
#pragma once

#include "scene/design.h"
#include "motion/motion.h"
#include "sim/cases.h"
#include "sim/options.h"
#include "sim/result.h"

typedef struct Scene Scene;
typedef struct SimWorker SimWorker;

/* Largest energy-balance error of a valid run, as a share of the input. */
double sim_energy_balance_max(const SimOptions *o);

/* Steps per contact that a tolerance needs, a relative error: 2 (0.01 / tolerance)^(2/3), so that J3 and the shares,
 * which converge last, err by less in 95 % of the scenes of docs/promise.md: 1e-2 and 6e-3 at most were measured at 2
 * and 4 steps. Core modes, tolerances of a step and the end of the contacts follow the steps (sim/fast/fast.h). The
 * presets are names: standard of 0.01, coarse of about 0.05. 0: as the preset says. */
double sim_steps_per_contact(const SimOptions *o);

Status scene_create(Scene **out, const SceneOptions *o, const Motion *motion, Err *err);
void scene_free(Scene *scene); /* NULL is fine */

/* The engine of every run, in the place of the options'; before a worker is created. An engine that the setting
 * sim.engine does not have may be given too (sim/engine.h). */
struct EngineEntry;
void scene_set_engine(Scene *scene, const struct EngineEntry *engine);

int scene_n_floors(const Scene *scene);
const Building *scene_building(const Scene *scene);
const DesignSpace *scene_design(const Scene *scene); /* the variables of a design x: SceneOptions.design */

/* Undamped natural frequencies [Hz], ascending, the n_floors lowest, NAN where a neighbour has fewer. x: a design of
 * scene_design. */
typedef struct {
    double building_hz[FLOORS_MAX], core_hz[FLOORS_MAX], joined_hz[FLOORS_MAX]; /* joined: with gaps of zero */
    double core_mass_kg;
} SceneModes;
Status scene_frequencies(const Scene *scene, const double x[], SceneModes *out, Err *err);

Status sim_worker_create(SimWorker **out, const Scene *scene, Err *err);
void sim_worker_free(SimWorker *worker); /* NULL is fine */

/* Every run from now on shows its states to sample, NULL: none does; spacing as EngineOptions.sample_spacing. It does
 * not find SimResult.peak_filtered_g then. */
void sim_worker_sample(SimWorker *worker, double spacing, SimSampleFn sample, void *user);

/* Displacements u (n_floors) [m] of the floors at a sample. */
void sim_worker_floors(const SimWorker *worker, const SimSample *sample, double u[]);

/* Floors and nodes of the core: relative to the ground [m], [m/s]; accelerations of the floors absolute [m/s2]. The
 * core by the modes that the engine follows, 0 where there is none. */
typedef struct {
    double u[FLOORS_MAX], u_dot[FLOORS_MAX], u_ddot[FLOORS_MAX], core[FLOORS_MAX], core_dot[FLOORS_MAX];
} FloorMotion;
void sim_worker_motion(const SimWorker *worker, const SimSample *sample, FloorMotion *out);

/* Every run from now on calls contact for every contact that ends or is open at the end, and with NULL where the run
 * begins; contact NULL: none does. Only with SimOptions.forces. */
void sim_worker_contacts(SimWorker *worker, SimContactFn contact, void *user);

/* Every run from now on is of a structure that was built so; NULL: as the options say. */
Status sim_worker_as_built(SimWorker *worker, const AsBuilt *built, Err *err);

/* Sets the device of SCENE_TMD and SCENE_LINKS in every run from now on. */
void sim_worker_device(SimWorker *worker, const LinearDevice *device);

/* Ends the simulations of this integrator where the strong part of the motion does (motion_strong_part), or where the
 * scene's do. */
void sim_worker_brief(SimWorker *worker, int is_brief);

/* x as above; ignored for SCENE_NO_CORE. */
Status sim_run(SimWorker *worker, SceneKind kind, const double x[], SimResult *result, Err *err);

/* Simulates a design as it is built. */
Status sim_run_built(SimWorker *worker, SceneKind kind, const Design *design, SimResult *result, Err *err);
