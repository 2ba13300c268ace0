/* scene/builtin.h -- ground motions that the program generates, so that a study can start without a record.
 *
 * Ownership  m->accel is allocated; motion_free releases it (after a failure there is nothing to free)
 * Threads    no state; the same samples every time */
#ifndef IMTET_SCENE_BUILTIN_H
#define IMTET_SCENE_BUILTIN_H

#include "scene/motion.h"

/* name: kobe-like, elcentro-like or sylmar-like */
Status builtin_motion(Motion *m, const char *name, Err *err);

#endif
