/* store/rows.h -- evaluations as rows of the table `evaluation` (store/store.h has its columns), written and read back.
 *
 *   x, f, sd, extra   JSON lists [1,2.5,null]; NULL where no number is known, f also where the design failed
 *   kind              NULL: KIND_UNFINISHED
 *   digest            of all of it, by which a row is found that the disk has changed (store/digest.h)
 *
 * Threads  as Database
 * Errors   a row that cannot be read, or is not what was written: STATUS_IO with its id */
#ifndef IMTET_STORE_ROWS_H
#define IMTET_STORE_ROWS_H

#include <stdio.h>

#include "evaluate/evaluation.h"
#include "store/database.h"

/* Shapes are those of the evaluation's table. A row with that id is replaced. */
typedef struct {
    size_t n_var, n_obj, n_extra;
} RowShape;
Status rows_insert(Database *db, RowShape shape, const Evaluation *e, Err *err);

/* A row that had no kind yet gets it, and the generation that it belongs to; or loses it again. */
Status rows_finish(Database *db, long id, EvaluationKind kind, long generation, Err *err);
Status rows_unfinish(Database *db, long id, EvaluationKind kind, long generation, Err *err);

/* The evaluations first..last, in the order of their ids, behind those of the table. A table whose n_var or n_extra is 0
 * goes without those numbers, which take most of the time. */
Status rows_read(Database *db, EvaluationTable *table, long first, long last, Err *err);

/* evaluations.csv behind its header, which is read on. */
typedef struct {
    FILE *f;
    char *line; /* getline's, of its `room` */
    size_t room;
    int are_same;      /* all lines so far are those of the rows */
    const char *cells; /* of the last line, if so: ",x,...,f,..." of n_cells characters */
    size_t n_cells;
    char buffer[1 << 16]; /* of f */
} RowLines;

/* The same one after the other, in the one row of the table `room`, and compared with lines; a row that is not what was
 * written is found a few rows later, or at the end. */
Status rows_each(Database *db, EvaluationTable *room, long first, long last, RowLines *lines, EvaluationFn take,
                 void *user, Err *err);

/* The same as lines of evaluations.csv, the texts as this program has written them; n: how many. A row that is not
 * finished is one where it is wanted. */
Status rows_print(Database *db, FILE *f, RowShape shape, long first, long last, int unfinished_too, size_t *n,
                  Err *err);

/* Numbers of every row, in the order of their ids, as they are stored; unchecked. */
typedef struct {
    long id;
    const char *x, *f, *extra; /* "": none */
} RowNumbers;
typedef Status (*RowTextFn)(const RowNumbers *row, void *user, Err *err);
Status rows_each_text(Database *db, RowTextFn take, void *user, Err *err);

/* n numbers of such a list; no text at all: n times NAN. It may have n_least alone, the others are not known. 0: it is none. */
int rows_numbers(const char *list, size_t n_least, size_t n, double values[]);

/* The same as text, `before` the first and a comma before every other one; `missing`: for one that is not known. Only
 * what may be of a number goes out; 0: there is something else. */
int rows_put_texts(FILE *f, const char *list, size_t n, const char *before, const char *missing);

/* Columns of any query. */
const char *column_text(sqlite3_stmt *row, int column);           /* NULL: "" */
double column_number(sqlite3_stmt *row, int column);              /* NULL: NAN */
long column_whole(sqlite3_stmt *row, int column, long otherwise); /* NULL: otherwise */

#endif
