/* sim/force_monitor.h -- forces of one response, beyond SimResult: contacts, storey shears and moments, stresses.
 *
 * Elastic forces of the nodes are K u and Kc v; storey s = 1..n ends at floor s at height z_s, z_0 = 0:
 *
 *   V_s = sum_{j >= s} (K u)_j,   M_s = sum_{j >= s} (K u)_j (z_j - z_{s-1})       shear, bending moment at its foot
 *
 * less k_j p_j of the plastic drift p_j of a storey that yields (sim/storey.h), and likewise of the core, with forces
 * Kc v - Kc z g where its mat lifts (scene/uplift.h); overturning is M_1. Both are linear in the modal coordinates:
 * row i of a table of outputs belongs to mode i. K is of the floors alone, also where the building's model has more
 * degrees of freedom: what the others carry acts on the floors as statics distribute it. Core modes that an engine
 * left out follow quasi-statically, w_i^2 q_i = -gamma_i a + sum_j R_ij f_j (mode acceleration method). Peaks are
 * taken from points that the engine gives in the order of time, with a parabola through three of them wherever the
 * middle one is the largest: spaced by h they miss (w h)^4 / 400 of a component of frequency w.
 *
 *   stress of storey s      max(|M_s|, |M_s+1|) c / I_s [Pa], c the distance of the extreme fibre
 *   shear stress            largest in the section: box V Q / (2 t I), plate 1.5 V / A
 *   foundation              rotation M_1 / K_theta, translation V_1 / K_x, uplift ratio M_1 / M_up (scene/foundation.h)
 *   plate buckling          k pi^2 E / (12 (1 - nu^2)) (t/b)^2, k = 4: a long wall of clear width b = B - 2t between
 *                           its neighbours, simply supported, without stiffeners, in uniform compression; elastic
 *
 * Contacts: the engine says when one begins, what it did in a step, and when it ends.
 *
 * Life cycle  force_monitor_create -> (force_monitor_set -> force_monitor_start -> points, contacts ->
 *             force_monitor_report)
 * Threads     one monitor per simulation under way
 * Source      R. W. Clough, J. Penzien, Dynamics of Structures (1993), ch. 12; S. Timoshenko, J. Gere, Theory of
 *             Elastic Stability (1961), section 9.2 */
#pragma once

#include "scene/core_beam.h"
#include "sim/floor_set.h"
#include "sim/options.h"
#include "sim/result.h"

typedef struct ForceMonitor ForceMonitor;

/* nb: of the building's model. */
Status force_monitor_create(ForceMonitor **out, int n_floors, int nb, Err *err);
void force_monitor_free(ForceMonitor *m); /* NULL is fine */

/* Another scene or design. core NULL: the building alone, else it must outlive the runs. joined: the core moves in the
 * modes of the building (sim/joined.h). thickness: of the core's wall in the first and in the last storey. */
void force_monitor_set(ForceMonitor *m, const SceneOptions *o, const Building *b, const CoreBeam *core, int joined,
                       const double thickness[2]);
/* contact is called for every contact that ends or is open where the run ends, and with NULL where a run begins. */
void force_monitor_on_contact(ForceMonitor *m, SimContactFn contact, void *user);

/* --- for engines ---------------------------------------------------------------------------------------------- */

/* A run from rest to end [s]. core_modes: those that points have, from the lowest; the others are quasi-static. */
void force_monitor_start(ForceMonitor *m, int core_modes, double end);

/* Modal coordinates and velocities of the building, coordinates of the core; force (n) [N] on the floors by their
 * contacts, in_contact where it is not zero; ground acceleration [m/s2]. */
typedef struct {
    double t, ground;
    const double *building_q, *building_v, *core_q, *force;
    const double *plastic; /* (n) [m] drifts of storeys that yield; NULL: none does */
    double mat_nm;         /* [N m] F of a mat that lifts (scene/uplift.h) */
    FloorSet in_contact;
} ForcePoint;
void force_monitor_point(ForceMonitor *m, const ForcePoint *p);

/* Points may be left out where no peak can rise, by the energies of the modes e_i = q_i'^2 + w_i^2 q_i^2. With any
 * E_i > 0,
 *
 *   |sum_i r_i q_i| <= sqrt(sum_i r_i^2 E_i / w_i^2) sqrt(sum_i e_i / E_i)                       (Cauchy-Schwarz)
 *
 * and it is sharp where E_i are the largest e_i of the run; the first mode, which swings longest, apart from the
 * others. energies: E_i [2 J] of nb building modes and of the core's, when they have risen. may_rise: can any output
 * exceed its peak by so much? The next points follow those of which it can, up to the next look. */
enum {
    REACH_BUILDING_1,
    REACH_BUILDING,
    REACH_CORE_1,
    REACH_CORE,
    REACH_FORCE,
    REACH_GROUND,
    REACH_PLASTIC,
    REACH_MAT,
    N_REACHES
};
typedef struct {
    /* sqrt(sum e_i / E_i) of modes; for core modes left out [N] sum of |f| on the floors, [m/s2]; [m] plastic drift;
     * [N m] F of the mat */
    double by[N_REACHES];
} ForceReach;
void force_monitor_energies(ForceMonitor *m, const double building[], const double core[]);
int force_monitor_may_rise(ForceMonitor *m, const ForceReach *reach);

/* Contacts of a floor with one side of the core: side = sign(u - v). While one is open: impulse [N s], energy lost [J],
 * largest force [N] and indentation [m] of a part of it. */
void force_monitor_onset(ForceMonitor *m, int floor, int side, double t, double speed);
void force_monitor_contact(ForceMonitor *m, int floor, double impulse, double lost, double force, double indentation);

/* Whether contacts are not wanted one by one and the largest force and indentation of this floor and side are not below
 * these: then the impulse alone is enough. */
int force_monitor_is_below(const ForceMonitor *m, int floor, int side, double force, double indentation);
void force_monitor_impulse(ForceMonitor *m, int floor, double impulse);
void force_monitor_end(ForceMonitor *m, int floor, double t, double speed);

/* --- for who asks --------------------------------------------------------------------------------------------- */

/* After a run that ended at time t. */
void force_monitor_report(ForceMonitor *m, double t, SimForces *out);
