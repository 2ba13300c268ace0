/* base/csv.h -- lines and cells of CSV text as people and spreadsheets write it.
 *
 *   # comment and blank lines are skipped, and so are lines of empty cells
 *   a UTF-8 byte order mark, lines that end in LF, CRLF or CR, cells in double quotes, blanks around cells
 *   cells are separated by commas, semicolons or tabs: the first line that is no comment decides, or "sep=;" above it
 *
 * A comma inside a cell is a decimal one; decimal points and decimal commas in one file are refused.
 *
 * Ownership  borrows path and text. Threads  no state */
#ifndef IMTET_BASE_CSV_H
#define IMTET_BASE_CSV_H

#include <stddef.h>

#include "base/status.h"

typedef struct {
    const char *from, *to; /* without the blanks and the quotes around it */
} CsvCell;

typedef struct {
    const char *path;           /* names the text in messages */
    int line;                   /* the one at hand, from 1 */
    const char *at, *end;       /* what is left of it; at > end: nothing, not even an empty cell */
    const char *next, *stop;    /* the lines below */
    char separator, line_end;   /* separator 0: not yet known */
    int point_line, comma_line; /* the first number with a decimal point, with a decimal comma; 0: none */
} CsvReader;

/* Does the line begin with the error of a spreadsheet, "#VALUE!" or "#N/A", which is a cell and no comment? */
int csv_is_error(const char *line, const char *end);

/* Refuses text in UTF-16 and text with NUL bytes. */
Status csv_open(CsvReader *r, const char *path, const char *text, size_t length, Err *err);

/* The next line with something in it; 0: there is none. */
int csv_line(CsvReader *r);

/* The next cell of the line; where none is left an empty one. */
CsvCell csv_cell(CsvReader *r);

/* Cells that are left of the line. */
size_t csv_count(const CsvReader *r);

/* Notes the decimal mark of a cell that looks like a number; decimal points and decimal commas in one file are refused. */
Status csv_note_mark(CsvReader *r, CsvCell c, Err *err);

/* The finite number in a cell; column of n_columns (from 1) is for the message. */
Status csv_number(CsvReader *r, CsvCell c, size_t column, size_t n_columns, double *value, Err *err);

#endif
