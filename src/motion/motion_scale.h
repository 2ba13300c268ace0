/* motion/motion_scale.h -- how strong a motion is made: the one scaling that the settings ask for.
 *
 *   motion.pga_g                  max |a| becomes pga_g
 *   motion.factor                 a times factor
 *   motion.sa_g, sa_period_s      the pseudo-acceleration at that period, 5 % damping, becomes sa_g
 *   motion.target                 the spectrum comes nearest to a code spectrum between target_from_s and target_to_s:
 *                                 the factor f that makes the mean square of ln(f PSa / target) least over
 *                                 TARGET_PERIODS periods, equally spaced in their logarithm,
 *                                     ln f = mean of ln(target / PSa)          (PEER ground motion data base)
 *
 * after t -> motion.stretch t: periods are those of what shakes the building. None: as recorded.
 *
 *   eurocode8   EN 1998-1:2004, 3.2.2.2, 5 % damping: ag S [1 + 1.5 T / TB] | 2.5 ag S | 2.5 ag S TC / T | 2.5 ag S TC TD / T^2
 *   asce7       ASCE 7-16, 11.4.6: SDS (0.4 + 0.6 T / T0) | SDS | SD1 / T | SD1 TL / T^2,  TS = SD1 / SDS, T0 = 0.2 TS
 *
 * Errors   STATUS_BAD_DATA: a motion of zeros, one that does not move an oscillator of that period, an absurd scale
 * Threads  no state */
#ifndef IMTET_MOTION_MOTION_SCALE_H
#define IMTET_MOTION_MOTION_SCALE_H

#include "motion/motion.h"
#include "motion/options.h"

enum { TARGET_PERIODS = 101 };

/* Beyond the first and its inverse a scale is warned about; one beyond the second that nobody gave is refused. */
static const double SCALE_PLAUSIBLE = 10, SCALE_MAX = 1000;

/* Stretches and scales; m->scale is the factor of the acceleration. */
Status motion_scale(Motion *m, const MotionOptions *o, Err *err);

/* [m/s2] of the code spectrum at period T [s]; 0 where motion.target is none. */
double target_psa(const MotionOptions *o, double T);

/* Root mean square of ln(PSa / target) over the range of periods, of a motion as it is. */
double target_misfit(const Motion *m, const MotionOptions *o);

/* How many of the scalings are asked for (no more than one makes sense), and a sentence of what they are. */
enum { SCALINGS_TEXT_MAX = 160 };
int motion_scalings(const MotionOptions *o, char text[SCALINGS_TEXT_MAX]);

/* As recorded: none of them. */
void motion_unscale(MotionOptions *o);

#endif
