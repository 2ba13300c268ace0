/* motion/motion_scale.h -- opens a record, and what is done to it: its base line and filters, and how strong it is
 * made.
 *
 * Base line and filters of a recorded acceleration, on request (motion.baseline, highpass_hz,
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
 * Scaling, one of
 *
 *   motion.pga_g                  max |a| becomes pga_g
 *   motion.factor                 a times factor
 *   motion.sa_g, sa_period_s      the pseudo-acceleration at that period, 5 % damping, becomes sa_g
 *   motion.target                 the spectrum comes nearest to a code spectrum between two periods: the factor f that
 *                                 makes the mean square of ln(f PSa / target) least over TARGET_PERIODS periods,
 *                                 equally spaced in their logarithm,
 *                                     ln f = mean of ln(target / PSa)          (PEER ground motion data base)
 *
 * after t -> motion.stretch t: periods are those of what shakes the building. None: as recorded.
 *
 *   eurocode8 ag=0.3 soil=C     EN 1998-1:2004, 3.2.2.2, 5 % damping: ag S [1 + 1.5 T / TB] | 2.5 ag S | 2.5 ag S TC
 *                               / T | 2.5 ag S TC TD / T^2; soil gives S, TB, TC, TD by Table 3.2, type 1; s= tb= tc=
 *                               td= change them
 *   asce7 sds=1 sd1=0.6 tl=8    ASCE 7-16, 11.4.6: SDS (0.4 + 0.6 T / T0) | SDS | SD1 / T | SD1 TL / T^2,  TS = SD1 /
 *                               SDS, T0 = 0.2 TS
 *   from=0.2 to=2               [s] the periods of the fit
 *
 * Errors   STATUS_BAD_DATA: a cutoff beyond half the sampling rate, fewer samples than the base line has
 *          coefficients, a motion of zeros, one that does not move an oscillator of that period, an absurd scale
 * Threads  no state */
#pragma once

#include "motion/motion.h"
#include "motion/options.h"

/* The motion that a user names: builtin:kobe-like | builtin:elcentro-like | builtin:sylmar-like (motion/builtin.h),
 * else the path of a file (motion/motion_read.h has the kinds). unit: UNIT_FROM_FILE demands that the file says it;
 * otherwise it must not contradict the file; it does not matter to a built-in motion. */
Status motion_load(Motion *m, const char *source, MotionUnit unit, Err *err);

/* The record of the options, a source (motion/suite.h), read and processed as they say; not scaled yet. */
Status motion_open(Motion *m, const MotionOptions *o, Err *err);

/* Base line and filters; m->accel may be another one afterwards. */
Status motion_process(Motion *m, const MotionOptions *o, Err *err);

/* Whether the displacement of such a motion means something: its long periods were looked at. */
int motion_is_corrected(const MotionOptions *o);

enum { TARGET_PERIODS = 101 };

/* Beyond the first and its inverse a scale is warned about; one beyond the second that nobody gave is refused. */
static const double SCALE_PLAUSIBLE = 10, SCALE_MAX = 1000;

/* Stretches and scales; m->scale is the factor of the acceleration. */
Status motion_scale(Motion *m, const MotionOptions *o, Err *err);

typedef enum { TARGET_NONE, TARGET_EUROCODE8, TARGET_ASCE7 } TargetKind;

typedef struct {
    TargetKind kind;
    double from_s, to_s;
    double plateau_g, tb_s, tc_s, td_s; /* from 0.4 to the plateau at TB; ASCE 7: TB = T0, TC = TS, TD = TL */
} CodeSpectrum;

/* motion.target; STATUS_BAD_DATA names what is missing, unknown or out of range. */
Status target_parse(const char *text, CodeSpectrum *out, Err *err);

/* [m/s2] of the code spectrum at period T [s]; 0 where there is none. */
double target_psa(const CodeSpectrum *c, double T);

/* Root mean square of ln(PSa / target) over the range of periods, of a motion as it is. */
double target_misfit(const Motion *m, const CodeSpectrum *c);

/* How many of the scalings are asked for (no more than one makes sense), and a sentence of what they are. */
enum { SCALINGS_TEXT_MAX = 160 };
int motion_scalings(const MotionOptions *o, char text[SCALINGS_TEXT_MAX]);

/* As recorded: none of them. */
void motion_unscale(MotionOptions *o);
