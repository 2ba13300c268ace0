/* base/number.h -- numbers as text and back, exactly, ten times as fast as by printf and strtod.
 *
 *   number_text   the fewest of 15, 16 or 17 significant digits that strtod reads back to the same bits, in the form of
 *                 printf's %g: 0.1, 12345.678, 1e+15, -3.25e-07
 *   number_read   as strtod
 *
 * Both compute with whole numbers of 128 bits: a double below 1e15 and not below 1e-11 is m 2^-s / 5^q with m < 2^53
 * and q <= 27, so that m 5^q, its digits, and whether they are within half a unit in the last place are exact. What is outside of that
 * range goes by printf and strtod.
 *
 * Threads  pure functions; the locale's decimal point is a point */
#ifndef IMTET_BASE_NUMBER_H
#define IMTET_BASE_NUMBER_H

#include <stddef.h>

enum { NUMBER_TEXT_MAX = 32 };

/* Finite value; returns the length. */
size_t number_text(double value, char text[NUMBER_TEXT_MAX]);

/* *end: behind the number; text itself where there is none. */
double number_read(const char *text, const char **end);

#endif
