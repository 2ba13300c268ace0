/* sim/cvode/cvode.h -- the model integrated by CVODE with located contacts; what differs between uses of it.
 *
 * A. C. Hindmarsh et al., SUNDIALS, ACM Trans. Math. Softw. 31 (2005) 363-396.
 *
 * Threads  none: cvode_run owns what it allocates */
#pragma once

#include "sim/cvode/ode.h"

typedef struct {
    int method;          /* CV_ADAMS or CV_BDF */
    int with_energies;   /* energies are integrated beside the motion */
    int stop_at_samples; /* of the ground motion; 0: steps no longer than its sampling interval */
    double panel;        /* [s] Ode.panel */
    double rtol[3];      /* by Accuracy */

    /* Attaches the nonlinear or linear solver to o->memory, with options of its own; 0 or an error. What it creates
     * lies in solver, and is released by `release` before the SUNDIALS context is. */
    int (*attach)(Ode *o, void *solver);
    void (*release)(void *solver);
} CvodeMethod;

/* solver: zeroed, of the type that the method's callbacks know. Errors  out of memory; all else is an outcome. */
Status cvode_run(const CvodeMethod *method, void *solver, const SimModel *model, const Motion *motion,
                 const EngineOptions *options, SimResult *result, Err *err);
