/* sim/linear.h -- linear structures under a ground motion: the same core without impacts, and what else its mass
 * could do.
 *
 *   rigid  floors and core rigidly connected (zero gap): M + Mc, K + Kc, and in the modes of both together the damping
 *          ratios of the building's modes
 *   tmd    a tuned mass damper at the roof, with the mass of the core: k_t = m_t w_t^2, c_t = 2 zeta_t m_t w_t
 *   links  floors and core joined by dashpots of one constant: f_j = -c (u_j' - v_j') on the floor
 *
 * In the modes Psi of the undamped structure, u = Psi y, with z = [W y; y'] (so that |z|^2 / 2 is the energy):
 *
 *   z' = [0 W; -W -D] z + [0; -Gamma] a + [0; Psi'] f,   D = P' diag(loss) P,   rate = P y'
 *
 * Every row of P is the rate of something that dissipates loss rate^2: modes of the building and of the core by their
 * own damping (q' and 2 zeta w), dashpots (their relative velocity and c), D is then full; rigidly connected, the
 * modes of both together, whose losses are booked under modes of building and core by their shares of the kinetic
 * energy, P_ik^2 of mode k. f: the forces on the floors. Over a step the loads are straight lines, and the step is
 * exact: (z, a, f, a', f') is multiplied by the exponential of one matrix (C. F. Van Loan, IEEE Trans. Autom. Control
 * 23 (1978) 395); the only error is where we look. Energies are integrated by the trapezoidal rule with its end
 * correction (Euler-Maclaurin), straight stretch by straight stretch:
 *   int f dt = h (f_0/2 + f_1 + ... + f_n/2) + h^2/12 (f_0' - f_n') + O(h^4) (f_0''' - f_n''')
 * Peaks: sim/peak_monitor.h.
 *
 * Storeys that yield (sim/storey.h): their forces c k p are further loads, straight lines over a step, which follow the
 * drifts at its ends; order 2 in the step.
 *
 * Shapes   matrices by columns: entry (i, j) of a matrix with r rows is at [j r + i]
 * Life     linear_system_make -> linear_run ... -> linear_system_free (a zeroed one is fine)
 * Threads  a LinearSystem is read-only after it was made */
#ifndef IMTET_SIM_LINEAR_H
#define IMTET_SIM_LINEAR_H

#include "motion/motion.h"
#include "sim/engine.h"

typedef enum { LINEAR_RIGID, LINEAR_TMD, LINEAR_LINKS } LinearKind;

typedef struct {
    int n, m, n_loss;       /* floors, coordinates, rows of P */
    int n_building, n_core; /* rows of P that are modes: the building's first, then the core's */
    int n_apart;            /* distances that are watched: between floors and core, roof and mass */
    const int *like;        /* (n_building) under which mode a share is booked; of the building (scene/building.h) */
    double *omega, *gamma;  /* (m) [rad/s], [sqrt(kg)] */
    double *psi;            /* (n, m) */
    double *P, *loss;       /* (n_loss, m), (n_loss) */
    double *apart;          /* (n_apart, m) */
    void *store;
} LinearSystem;

/* n_modes: of building and of core, the lowest, each; a mode that is left out moves with the ground. LINEAR_RIGID has
 * all of them. The core gives the tuned mass; device is not read for LINEAR_RIGID. */
Status linear_system_make(LinearSystem *s, LinearKind kind, const Building *b, const CoreBeam *core,
                          const LinearDevice *device, int n_modes, Err *err);
void linear_system_free(LinearSystem *s);

/* From rest at t = 0 to the end; steps of the motion's are divided into parts no longer than step [s]. forces NULL: not
 * wanted. */
typedef struct {
    double duration, step;
    ForceMonitor *forces;
    const EngineOptions *sampling; /* whose samples are wanted; spaced evenly within the motion's; NULL: none */
    const SimModel *storeys;       /* of which some yield: all else of it is left; NULL: none does */
} LinearRun;
Status linear_run(const LinearSystem *s, const Motion *motion, const LinearRun *run, SimResult *result, Err *err);

/* storeys: as of LinearRun. As of an engine (sim/engine.h), all modes, the step of options->accuracy. */
Status engine_linear(LinearKind kind, const Building *b, const CoreBeam *core, const LinearDevice *device,
                     const SimModel *storeys, const Motion *motion, const EngineOptions *options, SimResult *result,
                     Err *err);

#endif
