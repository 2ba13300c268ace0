#include "store/output.h"

char *digits_of(char *from, char *to, double value); /* digits.cpp: returns where they end */

/* Numbers with their fewest digits; what is not finite is `missing`. */
static void put_each(FILE *stream, size_t n, const double values[], const char *before, const char *missing)
{
    char text[32];
    for (size_t j = 0; j < n; j++) {
        char *end = stpcpy(text, j == 0 ? before : ",");
        end = isfinite(values[j]) ? digits_of(end, text + sizeof text, values[j]) : stpcpy(end, missing);
        fwrite_unlocked(text, 1, end - text, stream);
    }
}

void print_number(FILE *stream, double value)
{
    put_each(stream, 1, &value, "", "");
}

void print_cells(FILE *stream, size_t n, const double values[])
{
    put_each(stream, n, values, ",", "");
}

void print_list(FILE *stream, size_t n, const double values[])
{
    put_each(stream, n, values, "[", "null");
    fputs(n > 0 ? "]" : "[]", stream);
}
