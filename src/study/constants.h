/* study/constants.h -- every tuned constant of polishing on a surrogate, one a line; see moga/constants.h. */
#ifndef IMTET_STUDY_CONSTANTS_H
#define IMTET_STUDY_CONSTANTS_H

/* -- local.c ------------------------------------------------------------------------------------------------------- */

enum { LOCAL_STEPS = 60 };               /* evaluations of the surrogate for one proposal */
enum { LOCAL_RETUNE_SHARE = 8 };         /* tuned again when the designs have grown by n / this */
static const double TRUST_FIRST = 0.1;   /* half width of the first box, share of the range */
static const double TRUST_MAX = 0.4;     /* largest half width */
static const double TRUST_MIN = 1e-5;    /* half width that ends polishing */
static const double TRUST_SHRINK = 0.95; /* factor of the half width after a round without success */
static const double FREE_SHARE = 0.5;    /* share of the variables that are free in a box */
static const double ERROR_MIN = 1e-5;    /* least error of a prediction, share of the objective's value at the start */

#endif
