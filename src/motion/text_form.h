/* motion/text_form.h -- where the numbers of a plain text stand, as motion.text (--text) says it.
 *
 *   skip=5,columns=time:1,value:3,factor=9.81     lines above the numbers; columns from 1
 *   skip=4,per_line=8                             one motion row by row, so many numbers to a line
 *   pairs=yes                                     time value time value ..., any number of pairs to a line
 *
 * The samples are multiplied by the factor; their unit and step are said as for other files. */
#pragma once

#include "base/status.h"

typedef struct {
    int is_given;                 /* the file is a plain text, whatever it looks like */
    int skip, pairs;              /* lines; 1: pairs */
    size_t time, value, per_line; /* columns from 1; 0: none was named */
    double factor;                /* 0: none */
} TextForm;

/* "auto": nothing is given. */
Status text_form_parse(const char *text, TextForm *form, Err *err);
