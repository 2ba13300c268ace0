/* bench/engines/fixed_step.h -- the fixed-step driver: equal steps from sample to sample of the ground motion.
 *
 *   fixed_step_run(method, work, ...)      every sampling interval in ceil(dt/step) steps; contacts by overlap
 *
 * A method advances q and q' over one step of FixedStep.h and adds what lies between its ends to the account's
 * quadrature; the driver does time, contacts, peaks, the ends of steps and the report. contact and power are those of
 * the current state, at the start of a step and (after fixed_step_forces) at any stage.
 *
 * Threads  no state but the struct */
#pragma once

#include "sim/cvode/energy_account.h"

typedef struct {
    const SimModel *model;
    Contacts contacts;
    EnergyAccount account;
    double t, h, peaks_at; /* [s] the last: when peaks were sampled last */
    double q[MODES_MAX], v[MODES_MAX];
    double contact[MODES_MAX]; /* modal contact forces at q, v */
    ContactPower power;
    const char *trouble; /* why the method gave up */
} FixedStep;

typedef struct {
    double step[3];                                  /* [s] by Accuracy */
    double at_start, at_end;                         /* weights of the step's ends in the quadrature of the energies */
    void (*prepare)(const FixedStep *m, void *work); /* tables for steps of m->h */
    int (*advance)(FixedStep *m, double a0, double a1, void *work); /* ground acceleration from a0 to a1; 0: gave up */
} FixedStepMethod;

Status fixed_step_run(const FixedStepMethod *method, void *work, const SimModel *model, const Motion *motion,
                      const EngineOptions *options, SimResult *result);

/* Contact forces at a state: g (m) is overwritten. */
ContactPower fixed_step_forces(FixedStep *m, const double q[], const double v[], double g[]);
