/* base/visible.h -- text of files and users as it may stand in a message: nothing in it is invisible or moves a cursor.
 *
 *   control characters   \n \t ... or \x1B
 *   invisible ones       <U+FEFF>: blanks other than the space, marks without width, direction marks (UTF-8)
 *   no UTF-8             \xE4
 *
 * What is visible stays as it is.
 *
 * Or as one cell of a CSV file:
 *
 * Commas become semicolons; quotes and control characters become blanks; where a spreadsheet would see the beginning of
 * a formula (= + - @, also the full-width ones of UTF-8, at the start or behind a semicolon, blanks of any kind before
 * it or not) an apostrophe is put in front, which makes it text. What is harmless already stays as it is. Numbers are
 * not for this.
 *
 * Threads  no state */
#pragma once

#include <stddef.h>

/* Bytes of the text's first characters, so many that they are at most `most`: none is cut in two (UTF-8). */
int visible_cut(const char *text, size_t most);

/* At most size - 1 characters and a NUL, no escape cut in two; text and out do not overlap. Was all of it shown? */
int visible_text(char out[], size_t size, const char *text);

/* At most size - 1 characters and a NUL, none of UTF-8 cut in two; text and cell do not overlap. */
void cell_text(char cell[], size_t size, const char *text);
