/* motion/options.h -- how the ground moves: section [motion].
 *
 * Plain values, SI units. */
#pragma once

#include "base/option.h"

#define MOTION_UNIT_LIST(X)                                                                                            \
    X(UNIT_FROM_FILE, "from_file") X(UNIT_M_S2, "m_s2") X(UNIT_CM_S2, "cm_s2") X(UNIT_G, "g") X(UNIT_COUNTS, "counts")
typedef enum { MOTION_UNIT_LIST(CHOICE_NAME) } MotionUnit;

#define MOTION_BASELINE_LIST(X)                                                                                        \
    X(BASELINE_NONE, "none")                                                                                           \
    X(BASELINE_MEAN, "mean")                                                                                           \
    X(BASELINE_LINEAR, "linear")                                                                                       \
    X(BASELINE_QUADRATIC, "quadratic")
typedef enum { MOTION_BASELINE_LIST(CHOICE_NAME) } MotionBaseline;

typedef struct {
    char record[OPTION_TEXT_MAX];  /* a file, builtin:NAME, or none: at rest */
    char records[OPTION_TEXT_MAX]; /* further ones, a comma list, or none */
    MotionBaseline baseline;
    double highpass_hz, lowpass_hz; /* 0: none */
    double stretch;                 /* t -> stretch t */
    double pga_g, factor;           /* scalings, of which at most one is not at its default (motion/motion_scale.h) */
    double sa_g, sa_period_s;
    char target[OPTION_TEXT_MAX];  /* a code spectrum in words (target_parse) or none */
    char unit[OPTION_TEXT_MAX];    /* from_file or what motion_unit_parse reads */
    char channel[OPTION_TEXT_MAX]; /* name, number or auto */
    double dt_s;                   /* 0: from the file */
    char text[OPTION_TEXT_MAX];    /* where the numbers of a plain text stand (motion/text_form.h) or auto */
    char forces[OPTION_TEXT_MAX];  /* a CSV file (motion/forces.h) or none */
} MotionOptions;
