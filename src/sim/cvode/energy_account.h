/* sim/cvode/energy_account.h -- the energy account of a run: energies by quadrature, peaks by a monitor.
 *
 * Life cycle  energy_account_start -> (energy_account_peaks, energy_account_add ...) -> energy_account_report
 * Threads     no state but the struct */
#pragma once

#include "sim/cvode/contacts.h"
#include "sim/energy_balance.h"
#include "sim/peak_monitor.h"

typedef struct {
    const SimModel *model;
    PeakMonitor peaks;
    double damped[MODES_MAX], input, lost, clamp, devices; /* [J] */
    double mat_turned;                                     /* [rad] most of the mat that lifts */
    DevicePeak device[FLOORS_MAX + 2];                     /* (n_devices) */
    long steps, evaluations;
} EnergyAccount;

void energy_account_start(EnergyAccount *l, const SimModel *model);

/* The peaks at time t; contact (m): the contacts' modal forces at this state. */
void energy_account_peaks(EnergyAccount *l, double t, const double q[], const double v[], const double contact[]);

/* Adds `seconds` of the powers at modal velocities v, ground acceleration a. */
void energy_account_add(EnergyAccount *l, double seconds, const double v[], double a, const ContactPower *power);

/* At the end of a completed run: fills result, and options->end_state where it is not NULL. */
void energy_account_report(const EnergyAccount *l, const Contacts *c, const EngineOptions *options, const double q[],
                           const double v[], SimResult *result);
