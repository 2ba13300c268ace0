/* base/figure.h -- a number for people: with the digits that are known of it, and what is not known behind it.
 *
 *   16 +- 2        error 1.7: it has one digit, the value none below that
 *   13 +- 1 sd     the standard deviation, where it is the larger of the two
 *   0.07664        an error that four digits do not show
 *   16.5           three digits, where no error is known
 *   about 10       an error as large as the value: its order of magnitude alone. A negative value is then not told from
 *                  zero: 0.00 +- 0.01
 *   -              no number
 *
 * with the plus-minus sign of UTF-8. Digits alone from 0.000001 to 1e7, beyond that (1.53 +- 0.02) 10^8, with a dot.
 *
 * Threads  pure functions */
#pragma once

enum { FIGURE_MAX = 64 };

/* error, sd: in the unit of the value; NAN: not known. word: behind a deviation, "sd". */
void figure_text(double value, double error, double sd, const char *word, char text[FIGURE_MAX]);
