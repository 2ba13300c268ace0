/* motion/synthetic.h -- builtin:suite: motions made to fit a code spectrum in their mean, so that a study under many
 * earthquakes needs no file.
 *
 *   a_i(t) = e_i(t) sum_k c_k A_k cos(2 pi f_k t + phi_ik)          f_k = k / SUITE_SECONDS, phi uniform
 *
 * where the c are corrected until the pseudo-acceleration (5 % damping) at SUITE_PERIODS periods, equally spaced in
 * their logarithm, is that of the motion's own target
 *
 *   S_i(T) = S(T) exp(eps_i(T)) / mean_j exp(eps_j(T))              S: asce7 sds=1 sd1=0.6
 *
 * eps_i are smooth random functions of ln T of standard deviation SUITE_SPREAD, so that records differ as recorded
 * ones do, and their mean is S. The envelope e_i rises as a square, stays, falls as exp(-t / decay), its times drawn
 * too; two terms along the envelope leave the ground at rest, without velocity and displacement. Random numbers are
 * those of streams keyed by the number of the motion: the same samples every time, to whole millionths of m/s2.
 *
 * Sources  sum of sines, corrected by the ratio of spectra: Gasparini and Vanmarcke, Simulated earthquake motions
 *          compatible with prescribed response spectra, MIT R76-4 (1976); targets that scatter: Jayaram, Lin and Baker,
 *          Earthquake Spectra 27 (2011) 797-815; the code spectrum: ASCE 7-16, 11.4.6 (motion/motion_scale.h)
 * Threads  no state */
#pragma once

#include "motion/motion.h"

enum { SUITE_MOTIONS = 22, SUITE_PERIODS = 32 };
static const double SUITE_SPREAD = 0.35;                            /* of ln S: some 40 % is usual of recorded ones */
static const double SUITE_SHORTEST_S = 0.06, SUITE_LONGEST_S = 6.0; /* [s] periods that are fitted */

/* [m/s2] the code spectrum that the mean is fitted to. */
double synthetic_target(double T);

/* Motion i = 0..SUITE_MOTIONS-1, its samples for motion_free; name and format are the caller's. */
Status synthetic_motion(Motion *m, size_t i, Err *err);
