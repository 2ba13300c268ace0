/* base/csv.h -- text files of lines and cells, as people, spreadsheets, data loggers and Fortran programs write them.
 *
 *   lines     end in LF, CRLF or CR; a UTF-8 byte order mark is passed over, UTF-16 and NUL bytes are refused
 *   cells     parted by one character (comma, semicolon, tab), or by blanks with at most one comma or semicolon; quotes
 *             and blanks around them are dropped
 *   numbers   1.5, 1,5, 1.5E+3, 1.5D+3; finite ones only, decimal points or decimal commas, not both in one file
 *   tables    rows of equally many cells; lines that are blank, of empty cells, or begin with # are passed over.
 *             Cells are parted by commas, semicolons or tabs, of numbers without names by blanks too: the first line
 *             decides, or "sep=;" above it
 *
 * Ownership  Lines borrow path and text; table_read allocates, table_free releases (an empty one is fine)
 * Threads    no state.   Errors  "PATH:LINE: what was found" */
#pragma once

#include "base/status.h"

/* A whole file as a NUL-terminated string, to be freed by the caller. `largest` [bytes]: where a device or a wrong file
 * is given up. */
enum { FILE_LARGEST = 1 << 28 }; /* far above any record */
Status file_read(const char *path, size_t largest, char **text, size_t *length, Err *err);

/* ---- lines and cells --------------------------------------------------------------------------------------------- */

typedef struct {
    const char *path, *next, *end; /* of the text that is left */
    char mark;                     /* that ends a line: LF, or CR in a text that has no LF */
    int number;                    /* of the line below, from 1 */
    const char *raw;               /* where the line begins */
    const char *from, *to;         /* the line without blanks at its ends */
    int point_line, comma_line;    /* the first number with a decimal point, with a decimal comma; 0: none */
} Lines;

/* bad_data of "PATH:LINE: what", where l is. */
#define fail_at(err, l, what, ...) bad_data(err, "%s:%d: " what, (l)->path, (l)->number, ##__VA_ARGS__)

Status lines_open(Lines *l, const char *path, const char *text, size_t length, Err *err);
int lines_next(Lines *l); /* 0: no further line */

typedef struct {
    const char *from, *to; /* without the blanks and the quotes around it */
    int is_quoted;
} Cell;

/* The cell at *p, which moves on; beyond `end` after the last one. It ends at any of the marks; where the first of
 * them is a blank, at blanks too, of which any number stand between cells, with at most one of the other marks. */
Cell cell_next(const char **p, const char *end, const char *marks);

/* All of the cell is one number? Hexadecimal ones, which strtod would take, are none. */
typedef enum { NUMBER, NO_NUMBER, NOT_FINITE } CellKind;
CellKind cell_number(Cell c, int with_comma, double *x);

/* Notes the decimal mark of a number of the line; both marks in one file are refused. */
Status lines_note_mark(Lines *l, Cell c, Err *err);

/* Does the line begin with the error of a spreadsheet, "#VALUE!" or "#N/A", which is a cell and no comment? */
int csv_is_error(const char *line, const char *end);

/* Does every comma of the line stand between digits? Beside another separator these are decimal commas. */
int csv_has_decimal_commas(const char *line, const char *end);

/* ---- tables ------------------------------------------------------------------------------------------------------ */

enum { TABLE_NAME_MAX = 48 };

typedef struct {
    char path[600];
    size_t n_rows, n_cols;
    char (*names)[TABLE_NAME_MAX]; /* (n_cols), NULL without a header */
    int *line;                     /* (n_rows) of the file, from 1 */
    double *values;                /* (n_rows, n_cols) row-major; of a cell that is no number NAN */
    char *text;                    /* cells of words and numbers, each closed by a zero */
    size_t *cell;                  /* (n_rows, n_cols) where each begins in text */
} Table;

/* Numbers, every one finite, without names of columns; below them, where an empty cell is NAN and there may be no row
 * at all; words and numbers below names. Without a row the others are refused. */
typedef enum { TABLE_PLAIN, TABLE_HEADED, TABLE_WORDS } TableForm;
Status table_read(Table *t, const char *path, TableForm form, Err *err);

/* Reads a table from text in memory; `path` only names it in messages. */
Status table_parse(Table *t, const char *path, const char *text, size_t length, TableForm form, Err *err);

/* Column of that name, or -1. */
int table_column(const Table *t, const char *name);
void table_free(Table *t);

/* Text of a cell of words; empty if there is no such column. */
const char *sheet_text(const Table *s, size_t row, const char *column);

/* The number of a cell; `otherwise` where column or content are missing. NAN as `otherwise`: it must be there. */
Status sheet_number(const Table *s, size_t row, const char *column, double otherwise, double *value, Err *err);
