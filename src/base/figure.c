#include "base/figure.h"

#include <math.h>
#include <stdio.h>

enum { DIGITS_UNKNOWN = 3, DIGITS_MOST = 4 };
static const double LEAST = 1e-6, MOST = 1e7; /* written without a power of ten */

/* Of the first digit of x once it is rounded to so many: 16.48 and 2 digits: 1, tens; 9.96 and 2: 1 too. */
static int first_place(double x, int digits)
{
    char text[40];
    int exponent = 0;
    snprintf(text, sizeof text, "%.*e", digits - 1, fabs(x));
    sscanf(text, "%*[^e]e%d", &exponent);
    return exponent;
}

/* x rounded to 10^place, as a decimal number; never -0. */
static int write_decimal(char *text, size_t size, double x, int place)
{
    const double unit = pow(10, place), rounded = place > 0 ? round(x / unit) * unit : x;
    const double least = 0.5 * unit;
    return snprintf(text, size, "%.*f", place < 0 ? -place : 0, fabs(rounded) < least ? 0.0 : rounded);
}

/* Of a value whose last digit stands at `place`; uncertain: 0 leaves it out. */
static void write_figure(double value, double uncertain, const char *word, int place, char text[FIGURE_MAX])
{
    const double size = fmax(fabs(value), uncertain);
    const int exponent = size > 0 && (size >= MOST || size < LEAST) ? first_place(size, DIGITS_MOST) : 0;
    const double scale = pow(10, exponent);
    const int is_bracketed = exponent && uncertain > 0;
    size_t n = snprintf(text, FIGURE_MAX, "%s", is_bracketed ? "(" : "");
    n += write_decimal(text + n, FIGURE_MAX - n, value / scale, place - exponent);
    if (uncertain > 0) {
        n += snprintf(text + n, FIGURE_MAX - n, " \u00b1 ");
        n += write_decimal(text + n, FIGURE_MAX - n, uncertain / scale, place - exponent);
    }
    if (exponent)
        n += snprintf(text + n, FIGURE_MAX - n, "%s\u00b710^%d", is_bracketed ? ")" : "", exponent);
    snprintf(text + n, FIGURE_MAX - n, "%s%s", *word ? " " : "", word);
}

static void write_digits(double value, int digits, char text[FIGURE_MAX])
{
    write_figure(value, 0, "", value == 0 ? 0 : first_place(value, digits) - digits + 1, text);
}

void figure_text(double value, double error, double sd, const char *word, char text[FIGURE_MAX])
{
    const int is_sd = isfinite(sd) && !(error >= sd);
    const double uncertain = is_sd ? sd : error;
    if (!isfinite(value)) {
        snprintf(text, FIGURE_MAX, "-");
        return;
    }
    if (!isfinite(uncertain) || uncertain == 0) {
        write_digits(value, isfinite(uncertain) ? DIGITS_MOST : DIGITS_UNKNOWN, text);
        return;
    }
    const int place = first_place(uncertain, 1);
    const double unit = pow(10, place);
    if (value != 0 && uncertain < 0.5 * pow(10, first_place(value, DIGITS_MOST) - DIGITS_MOST + 1)) {
        write_digits(value, DIGITS_MOST, text);
    } else if (uncertain < fabs(value) || value <= 0 || fabs(value) < 0.5 * unit) {
        write_figure(uncertain < fabs(value) ? value : 0, uncertain, is_sd ? word : "", place, text);
    } else {
        char order[FIGURE_MAX];
        write_digits(value, 1, order);
        snprintf(text, FIGURE_MAX, "about %.*s", FIGURE_MAX - 8, order);
    }
}
