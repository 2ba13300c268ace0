/* sim/cvode/ode.h -- the model as SUNDIALS sees it: a first-order system, its events and its error weights.
 *
 *   y = [q (m), q' (m)]                                      energies by Gauss-Lobatto quadrature of dense output
 *   y = [q (m), q' (m), damped (m), input, lost, clamp]      with_energies: integrated beside the motion
 *       [by devices]                                       after them, where there are devices
 *       [g, s, W]                                            at the end, of a mat that lifts and has a dashpot: as well
 *       [p (n), W (n)]                                       after them, of storeys that yield: with_energies alone
 *
 * Located contacts and yielding: one root per floor, then one per storey that yields; at a root a flag flips and the
 * integrator is reinitialized. Between events the right-hand side is smooth: a floor keeps its flag past the root until
 * the root is found.
 *
 * Life cycle  ode_prepare -> (the caller sets up its integrator in Ode.memory) -> ode_run -> ode_release
 * Threads     no state but the struct
 * Errors      a run that does not finish is an outcome with a reason in SimResult */
#pragma once

#include <nvector/nvector_serial.h>

#include "sim/cvode/energy_account.h"
#include "sim/cvode/storeys.h"

typedef struct Ode Ode;

/* What differs between the packages. All return 0 or a negative flag; step returns ODE_ROOT where it stopped at one. */
typedef struct {
    const char *package;
    int (*step)(Ode *o, double t_stop, double *t);
    int (*interpolate)(Ode *o, double t, N_Vector y);
    int (*restart)(Ode *o, double t);
    int (*stop_at)(Ode *o, double t_stop);
    int (*found)(Ode *o, int roots[]);
    int (*look_for)(Ode *o, int directions[]);
} OdeSolver;

enum { ODE_ROOT = 2 };

struct Ode {
    const SimModel *model;
    const Motion *motion;
    const EngineOptions *options;
    const OdeSolver *solver;
    int with_energies, stop_at_samples;
    double panel; /* [s] at most: peaks and quadrature between the ends of long steps */
    double rtol;

    Contacts contacts;
    Storeys storeys;
    EnergyAccount account;
    long interval;                          /* stop_at_samples: the sampling interval */
    double v_sampled[MODES_MAX], a_sampled; /* at the last point of the quadrature: velocities, ground, contacts */
    ContactPower power_sampled;
    long samples; /* shown so far */
    long steps_max;
    int stuck;  /* successive steps without progress */
    int finite; /* what was last evaluated */

    SUNContext context;
    N_Vector y, tolerance, between; /* between: dense output */
    void *memory;                   /* the integrator */
    char message[120];              /* its last error */
};

/* Vectors and tolerances; rtol by accuracy unless options->tolerance > 0. The Ode's first block is the caller's. */
int ode_prepare(Ode *o, const double rtol[3]);
void ode_release(Ode *o);

Status ode_run(Ode *o, SimResult *result);

int ode_size(const Ode *o);
int ode_n_roots(const Ode *o);
double *ode_values(N_Vector v);

/* Callbacks; user is the Ode. */
int ode_right_hand_side(sunrealtype t, N_Vector y, N_Vector y_dot, void *user);
int ode_penetrations(sunrealtype t, N_Vector y, sunrealtype *p, void *user);
int ode_error_weights(N_Vector y, N_Vector weight, void *user);
void ode_keep_message(int code, const char *module, const char *function, char *text, void *user);

/* The parts of the right-hand side: dv = -2 zeta w v - w^2 q, and the loads (contacts, ground) added to dv. *a, *power:
 * ground acceleration and contacts at t. Returns 0 where the sum is finite, else -1. */
void ode_structure(const SimModel *model, const double q[], const double v[], double dv[]);
int ode_add_loads(Ode *o, double t, const double y[], double dv[], double *a, ContactPower *power);
