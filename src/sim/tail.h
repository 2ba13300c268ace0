/* sim/tail.h -- the energy that the rest of a ground motion can still put into a building.
 *
 *   W(t) = sum_i gamma_i^2 int_t^T a(s) int_t^s g_i'(s - r) a(r) dr ds      g_i the impulse response of mode i
 *
 * (with the forces on the floors in the load of every mode) is what the motion from t on gives to the building at rest
 * at t. Read from the end it is what the motion played backwards gives between 0 and T - t: one backward integration
 * has it for every t. From a state of energy E at t no linear building dissipates or holds more than (sqrt(E) +
 * sqrt(W(t)))^2 afterwards, since the root of what is dissipated is a seminorm of the response, which is the sum of
 * the free and the forced one.
 *
 * Threads  pure function */
#pragma once

#include "scene/building.h"
#include "motion/motion.h"

/* input (motion->n) [J]: the largest W(s), s from sample k on. */
Status tail_input(const BuildingModel *b, const Motion *motion, double input[], Err *err);
