/* sim/reference/ode.h -- the model as SUNDIALS sees it, shared by the engines on CVODE and on ARKODE.
 *
 *   y = [q (m), q' (m)]                                        energies by Gauss-Lobatto quadrature of dense output
 *   y = [q (m), q' (m), damped (m), input, lost, clamp]        with_books: energies integrated beside the motion
 *
 * Located contacts: one root per floor; where one is found a flag flips and the integrator starts anew. Between events
 * the right-hand side is smooth, a floor keeps its flag past the root until the root is found.
 *
 * Life cycle  ode_prepare -> (the caller sets up its integrator in memory) -> ode_run -> ode_release
 * Threads     no state but the struct */
#ifndef IMTET_SIM_REFERENCE_ODE_H
#define IMTET_SIM_REFERENCE_ODE_H

#include <nvector/nvector_serial.h>

#include "sim/reference/ledger.h"

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
    int with_books, locate, stop_at_samples; /* what kind of user wrote it */
    double panel;                            /* [s] at most: looks and quadrature between the ends of long steps */
    double rtol;

    Contacts contacts;
    Ledger ledger;
    long interval;                        /* stop_at_samples: the sampling interval */
    double v_looked[MODES_MAX], a_looked; /* where peaks were last looked for: velocities, ground, contacts */
    ContactPower power_looked;
    long steps_max;
    int stuck;  /* steps in a row that got nowhere */
    int finite; /* what was last evaluated */

    SUNContext context;
    N_Vector y, tolerance, between; /* between: dense output */
    void *memory;                   /* the integrator */
    char message[120];              /* its last error */
};

/* Vectors and tolerances; rtol by accuracy unless the knob says it. The Ode's first block is the caller's. */
int ode_prepare(Ode *o, const double rtol[3]);
void ode_release(Ode *o);

Status ode_run(Ode *o, SimResult *result);

int ode_size(const Ode *o);
int ode_n_roots(const Ode *o);
double *ode_values(N_Vector v);

/* Callbacks; user is the Ode. */
int ode_right_hand_side(sunrealtype t, N_Vector y, N_Vector y_dot, void *user);
int ode_linear_part(sunrealtype t, N_Vector y, N_Vector y_dot, void *user);    /* what the modes do by themselves */
int ode_nonlinear_part(sunrealtype t, N_Vector y, N_Vector y_dot, void *user); /* contacts and ground */
int ode_penetrations(sunrealtype t, N_Vector y, sunrealtype *p, void *user);
int ode_error_weights(N_Vector y, N_Vector weight, void *user);
void ode_keep_message(int code, const char *module, const char *function, char *text, void *user);

#endif
