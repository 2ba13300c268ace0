/* motion/motion_scale.h -- how strong a motion is made: the one scaling that the settings ask for.
 *
 *   motion.pga_g                  max |a| becomes pga_g
 *   motion.factor                 a times factor
 *   motion.sa_g, sa_period_s      the pseudo-acceleration at that period, 5 % damping, becomes sa_g
 *   motion.target                 the spectrum comes nearest to a code spectrum between two periods: the factor f that
 *                                 makes the mean square of ln(f PSa / target) least over TARGET_PERIODS periods, equally
 *                                 spaced in their logarithm,
 *                                     ln f = mean of ln(target / PSa)          (PEER ground motion data base)
 *
 * after t -> motion.stretch t: periods are those of what shakes the building. None: as recorded.
 *
 *   eurocode8 ag=0.3 soil=C     EN 1998-1:2004, 3.2.2.2, 5 % damping: ag S [1 + 1.5 T / TB] | 2.5 ag S | 2.5 ag S TC / T |
 *                               2.5 ag S TC TD / T^2; soil gives S, TB, TC, TD by Table 3.2, type 1; s= tb= tc= td= change them
 *   asce7 sds=1 sd1=0.6 tl=8    ASCE 7-16, 11.4.6: SDS (0.4 + 0.6 T / T0) | SDS | SD1 / T | SD1 TL / T^2,  TS = SD1 / SDS,
 *                               T0 = 0.2 TS
 *   from=0.2 to=2               [s] the periods of the fit
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

typedef enum { TARGET_NONE, TARGET_EUROCODE8, TARGET_ASCE7 } TargetKind;

typedef struct {
    TargetKind kind;
    double from_s, to_s;
    double ag_g, s, tb_s, tc_s, td_s; /* eurocode8 */
    double sds_g, sd1_g, tl_s;        /* asce7 */
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

#endif
