/* base/table.h -- a rectangle of numbers read from a CSV file, with or without one header line.
 *
 * Every line (base/csv.h has their forms) holds the same number of finite numbers.
 * Below a header there may be no line at all; without one that is refused.
 *
 * Ownership  table_read allocates names, values and lines; table_free releases them (an empty table is fine).
 * Threads    no state */
#ifndef IMTET_BASE_TABLE_H
#define IMTET_BASE_TABLE_H

#include <stddef.h>

#include "base/status.h"

enum { TABLE_NAME_MAX = 48 };

typedef struct {
    size_t n_rows, n_cols;
    char (*names)[TABLE_NAME_MAX]; /* (n_cols), NULL without a header */
    double *values;                /* (n_rows, n_cols) row-major */
    int *line;                     /* (n_rows) of the file, from 1 */
} Table;

Status table_read(Table *t, const char *path, int has_header, Err *err);

/* The same from text in memory; `path` only names it in messages. */
Status table_parse(Table *t, const char *path, const char *text, size_t length, int has_header, Err *err);

/* Column of that name, or -1. */
int table_column(const Table *t, const char *name);
void table_free(Table *t);

/* A whole file as a NUL-terminated string, to be freed by the caller. `largest` [bytes]: where a device or a wrong file
 * is given up. */
enum { FILE_LARGEST = 1 << 28 }; /* far above any record */
Status file_read(const char *path, size_t largest, char **text, size_t *length, Err *err);

#endif
