/* motion/motion_process.h -- base line and filters of a recorded acceleration, on request (motion.baseline, highpass_hz,
 * lowpass_hz); the default leaves a record as it is.
 *
 *   base line   the mean, or the straight line or parabola that is nearest to the acceleration (least squares), is
 *               subtracted
 *   high-pass   Butterworth, fourth order, forward and backward (base/filter.h), the record being at rest before and
 *               after: 3 / fc seconds of zeros are put before and behind it and stay, for without them the filtered
 *               acceleration begins and ends with a velocity and its displacement drifts (Boore, Bull. Seism. Soc. Am.
 *               95 (2005) 745-750). All later times count from the new beginning.
 *   low-pass    the same filter; the record keeps its length
 *
 * Frequencies are those of the record, before motion.stretch. m->processed says what was done.
 *
 * Ownership  m->accel may be another one afterwards; it stays the motion's
 * Errors     STATUS_BAD_DATA: a cutoff beyond half the sampling rate, fewer samples than the base line has coefficients;
 *            STATUS_NO_MEMORY
 * Threads    no state */
#ifndef IMTET_MOTION_MOTION_PROCESS_H
#define IMTET_MOTION_MOTION_PROCESS_H

#include "motion/motion.h"
#include "motion/options.h"

Status motion_process(Motion *m, const MotionOptions *o, Err *err);

/* Whether the displacement of such a motion means something: its long periods were looked at. */
int motion_is_corrected(const MotionOptions *o);

#endif
