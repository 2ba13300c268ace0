/* sim/cvode/contacts.h -- which floors touch the core, and the contacts' forces and powers, for step-by-step engines.
 *
 * Two ways to detect contact:
 *   by event     contacts_switch after every step; in between only floors whose contact is closed count, with the law's
 *                smooth continuation past the root
 *   by overlap   (by_overlap = 1) any floor that overlaps the core counts at once, its approach speed extrapolated from
 *                the start of the step to the gap, v0^2 = w'^2 - 2 w'' p; contacts_settle after every step
 *                keeps it
 *
 * f_j = -s F, as in sim/model.h. Threads  no state but the struct */
#pragma once

#include "sim/engine.h"

/* Most modes of building and core here. Rows have 65 cache lines: at 512 doubles, a page, rows fall on the same
 * lines of the cache and etdrk4 takes 1.7 times as long. */
enum { MODES_MAX = 520 };

typedef struct {
    const SimModel *model;
    int by_overlap;
    int side[FLOORS_MAX];  /* 0 open, else the sign of w while closed */
    double v0[FLOORS_MAX]; /* approach speed when it closed, at least v0_floor [m/s] */
    double t_before;       /* [s] by overlap only: the start of the step */
    double q_before[MODES_MAX], v_before[MODES_MAX], a_before[MODES_MAX]; /* modal motion there */
    long closings[FLOORS_MAX];
    long impacts, floored; /* contact onsets, those with v0 limited */
    OnsetLog *log;         /* NULL: none */
    ForceMonitor *forces;  /* NULL: none */
    int mat_at;            /* where the states of the mat stand behind q, 0: it has no dashpot */
    double t_recorded, recorded[FLOORS_MAX], recorded_loss[FLOORS_MAX]; /* [s], [N], [W] at the last record */
} Contacts;

/* Where the contacts' power goes [W]: F p' = F_el p' (stored) + (F_raw - F_el) p' (lost)
 *                                           + (F - F_raw) p' (clamp, never positive) */
typedef struct {
    double lost, clamp;
    double devices; /* [W] that devices take, but what their springs hold */
    double pushed;  /* [W] of the forces on the floors (ode.c), which is no part of that */
} ContactPower;

/* Eight partial sums, then their sum: vectorized, and in the same order on every processor. */
double dot_product(int n, const double a[], const double b[]);

double relative_displacement(const SimModel *model, int j, const double q[]);

/* Adds the modal forces R_ij f_j at the state q, q' to g, and those of the devices. */
ContactPower contacts_add(const Contacts *c, const double q[], const double v[], double g[]);

/* [J] In the springs of the devices. peak (n_devices; NULL: none) is raised to what each reaches here. */
double devices_look(const SimModel *model, const double q[], const double v[], DevicePeak peak[]);

/* The mat of a core that may lift, else 0: F; [rad] by which it is turned while it is up; [J] held, taken from the
 * modes so far. */
typedef struct {
    double force_nm, turned, held, taken;
} MatState;
MatState contacts_mat(const Contacts *c, const double q[]);

/* By overlap: the approach speed that a force on floor j, touching on side s, is to be computed with. */
double contacts_speed(const Contacts *c, int j, int s);

/* By event: flips the floors whose root was found. A floor whose root was not seen, because it was zero when the
 * integrator started or because two roots lay in one step (a graze), is flipped too, at the end of that step. Returns
 * whether any flipped. */
int contacts_switch(Contacts *c, double t, const double q[], const double v[], const int found[]);

/* By overlap, at the end of a step where w (n_pad): what overlaps is closed, what does not is open. */
void contacts_settle(Contacts *c, const double w[]);

/* Gives the monitor what the contacts did since the last call, by the trapezoidal rule, and the forces f_j (n) now.
 * Returns the floors that are in contact. */
FloorSet contacts_record(Contacts *c, double t, const double q[], const double v[], double force[]);

/* By event: the forces f_j (n) at the state q, q', with those of the devices. */
void contacts_forces(const Contacts *c, const double q[], const double v[], double force[]);

int contacts_any(const Contacts *c);
double contacts_stored(const Contacts *c, const double q[]);
