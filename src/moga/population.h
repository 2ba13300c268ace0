/* moga/population.h -- a set of designs: population, offspring, the pool of both.
 *
 * A member is either evaluated (row: its row of the archive) or predicted (row PREDICTED).
 *
 * Life cycle  population_create -> population_add ... population_keep ... -> population_free; n_max is fixed
 * Threads     one writer. */
#pragma once

#include "base/pack.h"
#include "moga/archive.h"

static const size_t PREDICTED = SIZE_MAX;

typedef struct {
    size_t n, n_max, n_var, n_obj;
    double *X, *F;       /* (n, n_var) (n, n_obj) */
    double *error;       /* (n, n_obj) predicted error, 0: evaluated */
    double *violation;   /* (n) */
    double *uncertainty; /* (n) predicted error, share of the range, of the worst objective; 0: evaluated */
    double *chance;      /* (n) probability that it succeeds and keeps every limit; 1: evaluated */
    size_t *row;         /* (n) */
    void *store;
} Population;

Status population_create(Population *p, size_t n_max, size_t n_var, size_t n_obj, Err *err);
void population_free(Population *p);

/* Appends a member with this design and returns its index; its row is PREDICTED, the rest 0. */
size_t population_add(Population *p, const double x[]);
void population_append(Population *to, const Population *from, size_t i); /* member i of another one */
void population_copy(Population *to, const Population *from);             /* replaces all members */
void population_keep(Population *p, size_t n, const size_t kept[]);       /* ascending; drops the rest */

/* All members, which are evaluated: rows of the archive, with objectives and violation as they were estimated. */
void population_pack(Population *population, Pack *p, const Archive *a);
