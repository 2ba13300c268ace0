/* bench/stability/oracle.h -- one mass between two walls, integrated by a method that no engine uses.
 *
 *   q'' + 2 zeta w q' + w^2 q = -a(t) - s F/m
 *
 * Runge-Kutta of order 4 on short fixed steps, events by bisection of the step, the first step of a contact in
 * t = tc + s^2. Slow, and simple enough to be verified by reading.
 * Threads  no state */
#pragma once

#include "bench/stability/bob.h"

#include "motion/motion.h"

typedef struct {
    double q, v;                                               /* at the end [m] [m/s] */
    double input, kinetic_strain, damped, stored, lost, clamp; /* [J] */
    double peak_u, peak_a, penetration;                        /* [m] [m/s2] absolute, [m] */
    double turnover;                                           /* [J] largest input, or loss in contacts, at any time */
    long impacts;
    double opened; /* [s] when the last contact opened */
} Oracle;

/* free_step, contact_step [s]: lengths of the steps. */
void oracle_run(Oracle *o, const Bob *bob, const Contact *contact, const Motion *motion, double duration,
                double free_step, double contact_step);
