/* sim/reference/ledger.h -- what a reference engine writes down on its way through a run: peaks and joules.
 *
 * Life cycle  ledger_start -> (ledger_look, ledger_add ...) -> ledger_report. Threads  no state but the struct */
#ifndef IMTET_SIM_REFERENCE_LEDGER_H
#define IMTET_SIM_REFERENCE_LEDGER_H

#include "sim/reference/contacts.h"
#include "sim/energy_balance.h"
#include "sim/peak_monitor.h"

typedef struct {
    const SimModel *model;
    PeakMonitor peaks;
    double damped[MODES_MAX], input, lost, clamp; /* [J] */
    long steps, evaluations;
} Ledger;

void ledger_start(Ledger *l, const SimModel *model);

/* Notes the peaks at time t; contact (m): the contacts' modal forces at this state. */
void ledger_look(Ledger *l, double t, const double q[], const double v[], const double contact[]);

/* Adds `seconds` of the powers at modal velocities v, ground acceleration a. */
void ledger_add(Ledger *l, double seconds, const double v[], double a, const ContactPower *power);

/* At the end of a run that arrived: fills result; the state goes into options->end_state if that is wanted. */
void ledger_report(const Ledger *l, const Contacts *c, const EngineOptions *options, const double q[], const double v[],
                   SimResult *result);

#endif
