/* motion/formats/columns.h -- rows of numbers, each row as wide as the first. */
#ifndef IMTET_MOTION_FORMATS_COLUMNS_H
#define IMTET_MOTION_FORMATS_COLUMNS_H

#include "motion/formats/record.h"

typedef struct {
    size_t width, n_rows;       /* numbers of the first row */
    int odd_line;               /* the first line that is not as wide, 0: none */
    size_t odd_width, odd_row;  /* how wide, and how many rows are above it */
    int is_one;                 /* one column: no comma parts anything */
    int point_line, comma_line; /* the first line with a decimal point, with a decimal comma; 0: none */
} Columns;

/* The numbers of the line, one Row each, behind those of the lines before. */
Status columns_add(Columns *columns, Record *r, const Lines *l, Err *err);

/* All lines were as wide as the first one. */
Status columns_check(const Columns *columns, const Lines *l, Err *err);

/* The names in a line of column names, parted by commas, semicolons or tabs, or else by blanks. *p moves on; 0: none.
 */
int column_name(const Lines *l, const char **p, const char **from, const char **to);

/* A channel for each column, named by that line, the rest as `all` has it; scale 1. */
Status columns_name(const Columns *columns, Record *r, const Lines *names, const Channel *all, Err *err);

#endif
