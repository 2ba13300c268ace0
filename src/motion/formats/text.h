/* motion/formats/text.h -- lines, numbers and units of text files that Fortran programs and people have written.
 *
 * Threads  no state.   Errors  "PATH:LINE: what was found" */
#pragma once

#include "base/csv.h"
#include "base/text.h"
#include "base/units.h"
#include "motion/options.h"

int lines_skip(Lines *l, int n);                    /* n lines on; 0: the text is too short */
int lines_next_filled(Lines *l);                    /* the next line that is not blank */
Lines lines_ahead(const Lines *l);                  /* the next line that is not blank, l stays; from == NULL: none */
int line_shown(const Lines *l);                     /* how many of its bytes a message shows */
int line_begins(const Lines *l, const char *words); /* one of the words parted by |, without regard to case */
int line_has(const Lines *l, const char *words);

const char *find_word(const char *from, const char *to, const char *word); /* without regard to case; NULL: none */

/* Does from..to begin with, hold, or equal one of the words parted by |, without regard to case? */
typedef enum { BEGINS, HOLDS, EQUALS } Match;
int text_is(Match how, const char *from, const char *to, const char *words);

/* The first number in `from`..`to` behind `word` and any of " =:(", decimal point or comma: 1, else 0. */
int number_behind(const char *from, const char *to, const char *word, double *x);

/* A step [s] or, is_rate, a rate [1/s] in the same place: "0.005", "1/200 s", "5 ms", "0.1 kHz"; -1: in another
 * unit. */
int quantity_behind(const char *from, const char *to, const char *word, int is_rate, double *x);

/* The number in a cell of the line; with_comma: 1,5 is one and a half. SUB_NO_NUMBER: it is none. */
Status line_number(const Lines *l, Cell c, int with_comma, double *x, Err *err);

/* Numbers of the line, at most max; *n is how many. Parted by blanks, commas or semicolons, unless that gives something
 * that is no number or a whole number longer than `width`: then they run together and are columns of that width (0:
 * none). */
Status line_numbers(const Lines *l, int width, size_t max, double x[], size_t *n, Err *err);

/* w of a Fortran format (8F9.6) that the line names, 0: none. */
int format_width(const Lines *l);

static const double UNIT_IN_M_S2[] = {0, 1, 0.01, GRAVITY, 1}; /* of counts: as many as motion.unit says are a m/s2 */

/* The unit of acceleration that all of the text is, "cm/sec^2", "M_S2", "Gal", "g"; UNIT_FROM_FILE: none. */
MotionUnit unit_of(const char *from, const char *to);

/* Is the text a unit of anything, or a multiple of one, "kN", "m/s", "-", "% of g", and no component or remark, "N-S",
 * "filtered"? */
int is_quantity(const char *from, const char *to);
