/* motion/formats/text.h -- lines, fields and numbers of text files that Fortran programs and people have written.
 *
 *   fields   parted by blanks, commas or semicolons; or, where numbers run together, columns of a fixed width
 *   numbers  1.5, 1.5E+3, 1.5D+3; finite ones only
 *
 * Threads  no state.   Errors  "PATH:LINE: what was found" */
#ifndef IMTET_MOTION_FORMATS_TEXT_H
#define IMTET_MOTION_FORMATS_TEXT_H

#include <stddef.h>

#include "base/csv.h"
#include "motion/options.h"

int lines_skip(Lines *l, int n);                   /* n lines on; 0: the text is too short */
int lines_next_filled(Lines *l);                   /* the next line that is not blank */
Lines lines_ahead(const Lines *l);                 /* the next line that is not blank, l stays; from == NULL: none */
int line_shown(const Lines *l);                    /* how many of its bytes a message shows */
int line_begins(const Lines *l, const char *word); /* without regard to case */
int line_has(const Lines *l, const char *word);

const char *find_word(const char *from, const char *to, const char *word); /* without regard to case; NULL: none */

/* The first number in `from`..`to` behind `word` and any of " =:(", decimal point or comma: 1, else 0. */
int number_behind(const char *from, const char *to, const char *word, double *x);

/* A step [s] or, is_rate, a rate [1/s] in the same place: "0.005", "1/200 s", "5 ms", "0.1 kHz"; -1: in another unit. */
int quantity_behind(const char *from, const char *to, const char *word, int is_rate, double *x);

/* Drops the blanks around a field, and then a pair of double quotes. */
void field_strip(const char **from, const char **to);

/* All of the field is one number, blanks and quotes around it allowed. with_comma: 1,5 is one and a half. */
Status field_number(const Lines *l, const char *from, const char *to, int with_comma, double *x, Err *err);

/* The field that begins at *p, whose end is returned; *p moves to the next one (to the line's end after the last). What is
 * in quotes is one. */
const char *field_next(const Lines *l, const char **p, int with_comma);

/* Numbers of the line, at most max; *n is how many. Fields parted by blanks, unless that gives something that is no
 * number or a whole number longer than `width`: then they run together and are columns of that width (0: none). */
Status line_numbers(const Lines *l, int width, size_t max, double x[], size_t *n, Err *err);

/* w of a Fortran format (8F9.6) that the line names, 0: none. */
int format_width(const Lines *l);

/* One bit (1 << MotionUnit) for each unit of acceleration that the text names. */
unsigned units_named(const char *from, const char *to);

/* The same of a sentence, in which a letter g may be somebody's name: only where it is stated as a unit. */
unsigned units_stated(const char *from, const char *to);

/* 1: the text names a unit of acceleration, or a multiple of one, that nothing here converts. */
enum { UNIT_SHOWN = 32 };
int unit_unknown(const char *from, const char *to, char shown[UNIT_SHOWN]);

extern const char *const UNIT_NAMES[]; /* by MotionUnit */

#endif
