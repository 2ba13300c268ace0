/* sim/fast/tolerances.h -- what accuracy costs the engine fast. */
#pragma once

typedef struct {
    double steps_per_contact;    /* of an undisturbed Hertz contact at the largest speed between floor and core */
    double solver_tolerance;     /* of the contact forces of one step, relative to what the step moves */
    double energy_tolerance;     /* of one step, share of the input energy so far; 0: all steps are as above */
    double device_error;         /* of a step of devices alone, share of the energy that they turn over */
    double steps_max;            /* steps after which a run is given up */
    double peak_tolerance;       /* share of a peak that may be uncertain inside a step */
    double flexibility_left_out; /* static, of the highest core modes, share of a contact's; 0: all are kept */
    double tail_tolerance;       /* contacts end where no more than this share of the input is left; 0: never ... */
    double tail_share;           /* ... and no more than this of the smallest energy share; 0: it is not looked at */
    int crowd;                   /* so many floors at the core at once halve the steps (kernel.c); 0: no number does */
    int calms_down;              /* solver and energy tolerance of a step grow as what is left falls (is_settled) */
    int core_modes;              /* so many of the core's modes are kept; 0: as flexibility_left_out says */
} FastTolerances;
