/* base/cell.h -- text of users and their programs as one cell of a CSV file.
 *
 * Commas become semicolons; quotes and control characters become blanks; where a spreadsheet would see the beginning of
 * a formula (= + - @, also the full-width ones of UTF-8, at the start or behind a semicolon, blanks of any kind before
 * it or not) an apostrophe is put in front, which makes it text. What is harmless already stays as it is. Numbers are
 * not for this.
 *
 * Threads  no state */
#ifndef IMTET_BASE_CELL_H
#define IMTET_BASE_CELL_H

#include <stddef.h>

/* At most size - 1 characters and a NUL, none of UTF-8 cut in two; text and cell do not overlap. */
void cell_text(char cell[], size_t size, const char *text);

#endif
