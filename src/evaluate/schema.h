/* evaluate/schema.h -- the columns of a run: variables, objectives, and further results.
 *
 *   column 0..n_var-1, then n_obj objectives, then n_extra: measures of a tower that are only written down, else the
 *   constraint values g_1 ... that external workers answer (ProblemOptions.constraints)
 *
 * Internally every objective is minimised, f = sense * value; every file shows the natural value.
 * Ownership  schema_of allocates, schema_free releases, after a failure too (an empty Schema is fine) */
#pragma once

#include "base/list.h"
#include "evaluate/kinds.h"
#include "scene/design.h"
#include "evaluate/measures.h"

typedef struct Settings Settings;

enum { OBJECTIVES_MAX = 100 };
enum { EXTRA_MAX = (int)CONSTRAINTS_MAX > (int)N_MEASURES ? (int)CONSTRAINTS_MAX : (int)N_MEASURES };

typedef struct {
    char name[TABLE_NAME_MAX];
    double sense; /* of an objective or measure: +1 less is better, -1 more is better */
} Column;

typedef struct {
    size_t n_var, n_obj, n_extra;
    DesignSpace design; /* of a tower */
    Column *column;
    MeasureOrder order;          /* of the tower: measures behind the columns; else empty */
    char kinds[OPTION_TEXT_MAX]; /* problem.kinds; empty: all variables are real */
    long replicates;             /* simulations of each record behind one evaluation: sim.replicates */
    int is_noisy;                /* schema_is_noisy */
    int has_spread; /* front.csv ends with NAME_sd of every objective and replicates: designs are several simulations */
    size_t n_limited, limited[EXTRA_MAX]; /* those of the n_extra that have to keep a limit, ascending */
} Schema;

/* Whether designs are simulated again because they answer differently each time. */
int schema_is_noisy(const Settings *s);

/* n_floors: of a tower, else not read. */
Status schema_of(Schema *schema, const Settings *s, int n_floors, Err *err);
const Column *schema_variable(const Schema *schema, size_t j);
const Column *schema_objective(const Schema *schema, size_t k);
const Column *schema_extra(const Schema *schema, size_t k);

/* Measure m of a design with those objectives and further results; NAN: it has none. */
double schema_value(const Schema *schema, int m, const double f[], const double extra[]);

/* The word that stands for x where variable j is a choice; else 0. */
int schema_word(const Schema *schema, size_t j, double x, char word[KIND_WORD_MAX]);

/* Variable j of a row of a table of words and numbers; STATUS_BAD_DATA: no word of its choice, no whole number. */
Status schema_cell(const Schema *schema, size_t j, const Table *t, size_t row, double *x, Err *err);

/* *k: the one of that name among the first n of objectives and further results. Else "WHERE: NAME is no objective (of
 * more than n_obj: no result); did you mean ...?"; where: an option, "--NAME", for STATUS_USAGE, or what else it was
 * read from, for STATUS_BAD_DATA. */
Status schema_pick(const Schema *schema, size_t n, const char *where, const char *name, size_t *k, Err *err);
void schema_free(Schema *schema);
