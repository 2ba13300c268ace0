/* base/sheet.h -- a CSV file of words and numbers below a header (base/csv.h has the forms of its lines).
 *
 *   sheet_read, sheet_expect, then cell by cell: sheet_text, sheet_number
 *
 * Columns are found by name, in any order. Every fault names file, line and column.
 *
 * Ownership  sheet_read allocates, sheet_free releases (an empty Sheet is fine). Threads  no state */
#ifndef IMTET_BASE_SHEET_H
#define IMTET_BASE_SHEET_H

#include <stddef.h>

#include "base/status.h"

enum { SHEET_NAME_MAX = 48 };

typedef struct {
    char path[600];
    size_t n_rows, n_cols;
    char (*names)[SHEET_NAME_MAX]; /* (n_cols) */
    char *text;                    /* the cells, each closed by a zero */
    size_t *cell;                  /* (n_rows, n_cols) where it begins in text */
    int *line;                     /* (n_rows) of the file, from 1 */
} Sheet;

Status sheet_read(Sheet *s, const char *path, Err *err);

/* The same from text in memory; `path` only names it in messages. */
Status sheet_parse(Sheet *s, const char *path, const char *text, size_t length, Err *err);

/* Columns by name, separated by blanks: all of `required` must be there, and no other than those of `optional`. */
Status sheet_expect(const Sheet *s, const char *required, const char *optional, Err *err);

/* Column of that name, or -1. */
int sheet_column(const Sheet *s, const char *name);

/* The text of a cell; empty where there is no such column. */
const char *sheet_text(const Sheet *s, size_t row, const char *column);

/* The number of a cell, decimal point or comma; `otherwise` where column or content are missing. NAN as `otherwise`: it
 * must be there. */
Status sheet_number(const Sheet *s, size_t row, const char *column, double otherwise, double *value, Err *err);
void sheet_free(Sheet *s);

#endif
