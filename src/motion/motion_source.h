/* motion/motion_source.h -- a ground motion by the name that a user gives: a file or a built-in motion.
 *
 *   builtin:kobe-like | builtin:elcentro-like | builtin:sylmar-like     motion/builtin.h
 *   any other                                                           a path; motion/motion_read.h has the kinds of file
 *
 * Ownership  m->accel is allocated; motion_free releases it (after a failure there is nothing to free)
 * Threads    no state
 * Errors     every fault of a file names file, line and what was found */
#ifndef IMTET_MOTION_MOTION_SOURCE_H
#define IMTET_MOTION_MOTION_SOURCE_H

#include "motion/motion.h"
#include "motion/options.h"

/* unit: UNIT_FROM_FILE demands that the file says it; otherwise it must not contradict the file; it does not matter to a
 * built-in motion. */
Status motion_load(Motion *m, const char *source, MotionUnit unit, Err *err);

/* The record of the options, read and processed as they say; not scaled yet (motion_scale). */
Status motion_open(Motion *m, const MotionOptions *o, Err *err);

#endif
