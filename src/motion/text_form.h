/* motion/text_form.h -- how a file is read; where the numbers of a plain text stand, as motion.text (--text) says it.
 *
 *   skip=5,columns=time:1,value:3,factor=9.81     lines above the numbers; columns from 1
 *   skip=4,per_line=8                             one motion row by row, so many numbers to a line
 *   pairs=yes                                     time value time value ..., any number of pairs to a line
 *
 * The samples are multiplied by the factor; their unit and step are said as for other files. */
#pragma once

#include "motion/options.h"

typedef struct {
    int is_given;                 /* the file is a plain text, whatever it looks like */
    int skip, pairs;              /* lines; 1: pairs */
    size_t time, value, per_line; /* columns from 1; 0: none was named */
    double factor;                /* 0: none */
} TextForm;

/* How a file is read. */
typedef struct {
    MotionUnit unit;     /* of the acceleration; must not contradict the file */
    const char *channel; /* name or number (from 1) of the one that is wanted; NULL or "auto": there must be only one */
    double dt_s;         /* step of a file that has neither step nor times, or of unequal times, which are
                               resampled to it by straight lines; 0: such files are refused */
    double counts_per_m_s2; /* UNIT_COUNTS: gain of the instrument */
    TextForm text;
} MotionHow;

/* "auto": nothing is given. */
Status text_form_parse(const char *text, TextForm *form, Err *err);
