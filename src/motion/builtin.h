/* motion/builtin.h -- ground motions that the program generates, so that a study can start without a record.
 *
 * Ownership  m->accel is allocated; motion_free releases it (after a failure there is nothing to free)
 * Threads    no state; the same samples every time */
#pragma once

#include "base/option.h"
#include "motion/motion.h"

#define BUILTIN_MOTION_LIST(X)                                                                                         \
    X(KOBE, "builtin:kobe-like") X(ELCENTRO, "builtin:elcentro-like") X(SYLMAR, "builtin:sylmar-like")

/* builtin:suite is a suite (motion/suite.h): builtin:suite-01, ... (motion/synthetic.h). */
#define SUITE_SOURCE "builtin:suite"

/* What follows "builtin:"; NULL: the source is a file. */
const char *builtin_name(const char *source);

/* source: with "builtin:". */
Status builtin_motion(Motion *m, const char *source, Err *err);
