/* sim/reference/march.h -- engines that go through a run in equal steps, from sample to sample of the ground motion.
 *
 *   march(method, work, ...)      every sampling interval in ceil(dt/knob) steps; contacts by sight
 *
 * A method advances q and q' over one step of March.h and adds what lies between its ends to the ledger's quadrature;
 * the march sees to time, contacts, peaks, the ends and the report. contact and power are those of the current state,
 * at the start of a step as well as (after march_feel) at any stage. Threads  no state but the struct */
#ifndef IMTET_SIM_REFERENCE_MARCH_H
#define IMTET_SIM_REFERENCE_MARCH_H

#include "sim/reference/ledger.h"

typedef struct {
    const SimModel *model;
    Contacts contacts;
    Ledger ledger;
    double t, h, looked_at; /* [s] the last when peaks were noted last */
    double q[MODES_MAX], v[MODES_MAX];
    double contact[MODES_MAX]; /* modal contact forces at q, v */
    ContactPower power;
    const char *trouble; /* why the method gave up */
} March;

typedef struct {
    double step[3];                              /* [s] by Accuracy */
    double at_start, at_end;                     /* weights of the step's ends in the quadrature of the energies */
    void (*prepare)(const March *m, void *work); /* tables for steps of m->h */
    int (*advance)(March *m, double a0, double a1, void *work); /* ground acceleration from a0 to a1; 0: gave up */
} MarchMethod;

Status march(const MarchMethod *method, void *work, const SimModel *model, const Motion *motion,
             const EngineOptions *options, SimResult *result);

/* Contact forces at a state: g (m) is overwritten. */
ContactPower march_feel(March *m, const double q[], const double v[], double g[]);

#endif
