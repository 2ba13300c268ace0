/* report/gnuplot.h -- pictures drawn by gnuplot, which is started without a shell.
 *
 * The script goes to its standard input, the picture comes from its standard output into `path`, which is replaced only
 * by a whole picture (store/output.h). No gnuplot: STATUS_MISSING, and nothing is written. */
#pragma once

#include "base/status.h"

typedef void (*GnuplotScript)(FILE *script, const void *user);

Status gnuplot_draw(const char *path, GnuplotScript write, const void *user, Err *err);

/* A number and a blank; NaN where it is none. */
void gnuplot_number(FILE *script, double value);

/* 'text' in the quotes of a gnuplot script, control characters left out. */
void gnuplot_quote(FILE *script, const char *text);
