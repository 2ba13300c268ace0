/* cmd/spectrum.h -- a motion with its figures, histories and response spectrum, and pictures of it.
 *
 * Life cycle  spectrum_open -> ... -> spectrum_close      (a zeroed Spectrum may be closed)
 * Units       SI; 5 % damping */
#ifndef IMTET_CMD_SPECTRUM_H
#define IMTET_CMD_SPECTRUM_H

#include <stdio.h>

#include "motion/motion.h"
#include "motion/motion_scale.h"
#include "motion/options.h"
#include "motion/spectrum.h"

enum { N_PERIODS = 121 }; /* 0.02 to 20 s, equally spaced in their logarithm */

typedef struct {
    Motion motion;
    MotionOptions options;
    CodeSpectrum code; /* motion.target */
    MotionFigures figures;
    double *velocity, *displacement, *husid; /* (n of the motion) */
    double T[N_PERIODS], psa[N_PERIODS], psv[N_PERIODS], sd[N_PERIODS];
    double target[N_PERIODS]; /* [m/s2] of motion.target, else 0 */
    int is_processed; /* by motion.baseline, highpass_hz or lowpass_hz; `recorded` is without them, same scale */
    MotionFigures recorded;
    double recorded_psa[N_PERIODS];
} Spectrum;

/* The record of the options, processed and scaled as they say. */
Status spectrum_open(Spectrum *s, const MotionOptions *o, Err *err);
void spectrum_close(Spectrum *s);

/* Mean of n spectra [m/s2] at each period. */
void spectra_average(size_t n, const Spectrum s[], double mean[N_PERIODS]);

const char *spectrum_name(const Spectrum *s); /* the last part of its path */

/* Drawn by gnuplot: histories and spectra of one motion; spectra of several with mean and target. */
Status spectrum_draw(const Spectrum *s, const char *path, Err *err);
Status spectra_draw(size_t n, const Spectrum s[], const char *path, Err *err);

#endif
