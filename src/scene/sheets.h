/* scene/sheets.h -- the files of a building: those of a folder, or of a built-in model, which are part of the program
 * (Makefile, rule for *.csv.o): guyan and appendix as K.csv and M.csv, guyan also as the frame that it is condensed
 * from. A sheet is read by a table of its columns.
 *
 * Threads  no state */
#pragma once

#include "base/csv.h"
#include "base/status.h"

int model_is_built_in(const char *model);

/* file: "nodes.csv" */
int model_has(const char *model, const char *file);

Status model_table(Table *t, const char *model, const char *file, TableForm form, Err *err);

typedef enum { COLUMN_NAME, COLUMN_NUMBER, COLUMN_ABOVE_0, COLUMN_LEAST_0, COLUMN_SWITCH } ColumnKind;

typedef struct {
    const char *name;
    ColumnKind kind;
    double otherwise; /* where column or content are missing; NAN: they must be there */
} Column;

/* One row: of column i the word, or the number. */
enum { COLUMNS_MAX = 10 };
typedef struct {
    size_t n_rows, row;
    const char *word[COLUMNS_MAX];
    double x[COLUMNS_MAX];
} SheetRow;

/* Column names may be there or not by `otherwise`, no others; a NAME has 1 to TABLE_NAME_MAX - 1 characters. take:
 * what is done with a row; to what it says is wrong file and line are added. */
typedef struct {
    const char *file;
    Status (*take)(void *user, const SheetRow *row, Err *err);
    Column column[COLUMNS_MAX]; /* the rest has no names */
} SheetForm;
Status sheet_read(const SheetForm *form, const char *model, void *user, Err *err);
