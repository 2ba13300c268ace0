/* motion/options.h -- how the ground moves: section [motion].
 *
 * Plain values, SI units. */
#ifndef IMTET_MOTION_OPTIONS_H
#define IMTET_MOTION_OPTIONS_H

#include "base/option.h"

#define MOTION_UNIT_LIST(X)                                                                                            \
    X(UNIT_FROM_FILE, "from_file")                                                                                     \
    X(UNIT_M_S2, "m_s2")                                                                                               \
    X(UNIT_CM_S2, "cm_s2")                                                                                             \
    X(UNIT_G, "g")
typedef enum { MOTION_UNIT_LIST(CHOICE_NAME) } MotionUnit;

#define MOTION_BASELINE_LIST(X)                                                                                        \
    X(BASELINE_NONE, "none")                                                                                           \
    X(BASELINE_MEAN, "mean")                                                                                           \
    X(BASELINE_LINEAR, "linear")                                                                                       \
    X(BASELINE_QUADRATIC, "quadratic")
typedef enum { MOTION_BASELINE_LIST(CHOICE_NAME) } MotionBaseline;

#define MOTION_TARGET_LIST(X) X(TARGET_NONE, "none") X(TARGET_EUROCODE8, "eurocode8") X(TARGET_ASCE7, "asce7")
typedef enum { MOTION_TARGET_LIST(CHOICE_NAME) } MotionTarget;

typedef struct {
    char record[OPTION_TEXT_MAX];  /* a file or builtin:NAME */
    char records[OPTION_TEXT_MAX]; /* further ones, a comma list, or none */
    MotionBaseline baseline;
    double highpass_hz, lowpass_hz; /* 0: none */
    double stretch;                 /* t -> stretch t */
    double pga_g, factor;           /* scalings, of which at most one is not at its default (motion/motion_scale.h) */
    double sa_g, sa_period_s;
    MotionTarget target;
    double target_from_s, target_to_s;
    double ec8_ag_g, ec8_s, ec8_tb_s, ec8_tc_s, ec8_td_s;
    double asce7_sds_g, asce7_sd1_g, asce7_tl_s;
    MotionUnit unit;
    char channel[OPTION_TEXT_MAX]; /* name, number or auto */
    double dt_s, resample_dt_s;    /* 0: from the file; 0: never */
    double counts_per_m_s2;        /* gain of a record in counts; 0: not known */
    double peak_error_max;         /* [-] by which the samples may miss the peak that their header states */
} MotionOptions;

#endif
