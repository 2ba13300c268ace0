/* rbf/constants.h -- every tuned constant of the interpolant, one a line; see moga/constants.h. */
#pragma once

/* -- tune.c: Rprop on the logarithms of scales, warp and nugget ---------------------------------------------------- */

enum { TUNE_CENTRES_MAX = 250 };            /* centres that the likelihood is computed on, at n^3 each */
enum { TUNE_STEPS_FIRST = 16 };             /* steps for every form, at the first tuning */
enum { TUNE_STEPS = 5 };                    /* steps for the present form, and for one other, later */
static const double TUNE_STEP = 0.5;        /* first step of each logarithm, later twice its last, a tenth at least */
static const double CHALLENGE_MAX = 1.5;    /* error of another form, in the present one's, up to which it is tuned */
static const double THETA_PRIOR_SD = 1.4;   /* of log theta about its mean over the variables */
static const double WARP_PRIOR_SD = 0.0015; /* of log a and log b about 0, for each centre */
static const double NUGGET_MIN = 1e-8;      /* least nugget; 1: all of the variance is noise */
static const double NUGGET_START = 1e-4;    /* smallest nugget that tuning starts from */

/* -- kernel.c: the additive part of a kernel; tune.c --------------------------------------------------------------- */

static const double ADDITIVE_REACH = 0.1;       /* of the unit cube, of RBF_ADDITIVE */
static const double ADDITIVE_REACH_LONG = 0.25; /* ... of RBF_ADDITIVE_LONG */
static const double ADDITIVE_GAIN = 0.8;        /* of the mean square leave-one-out error, to take it */
static const double ADDITIVE_ERROR = 1e-3;      /* mean square error, in variances, below which it is not tried */
