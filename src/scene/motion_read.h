/* scene/motion_read.h -- files that hold a ground acceleration.
 *
 *   csv  # comments; perhaps one line that names the columns; then time [s], acceleration per line, equal steps.
 *        The unit is looked for in the column names, and if they do not tell, in the comments: m/s2, cm/s2, gal or g
 *        in the usual spellings (m_s2, m/s^2, m/sec/sec ...).
 *   at2  PEER strong motion data base: four header lines, the last with the number of points and the step in either
 *        of its two usual forms, then the samples
 *
 * The kind of file is told by its content, not by its name. Lines may end in LF or CRLF.
 * Ownership  m->accel is allocated; motion_free releases it (after a failure there is nothing to free)
 * Threads    no state */
#ifndef IMTET_SCENE_MOTION_READ_H
#define IMTET_SCENE_MOTION_READ_H

#include "scene/motion.h"

Status motion_read(Motion *m, const char *path, MotionUnit unit, Err *err);

/* The same from text in memory; `path` only names it in messages. */
Status motion_parse(Motion *m, const char *path, const char *text, size_t length, MotionUnit unit, Err *err);

/* 64-bit FNV-1a of n bytes, http://www.isthe.com/chongo/tech/comp/fnv */
uint64_t motion_hash(const void *data, size_t n);

#endif
