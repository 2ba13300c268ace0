/* moga/group.h -- a set of designs that compete: population, offspring, the pool of both.
 *
 * A member is either simulated (row: its place in the archive) or predicted (row PREDICTED).
 *
 * Life cycle  group_create -> group_add ... group_keep ... -> group_free; n_max is fixed
 * Threads     one writer. */
#ifndef IMTET_MOGA_GROUP_H
#define IMTET_MOGA_GROUP_H

#include <stddef.h>
#include <stdint.h>

#include "base/pack.h"
#include "base/status.h"

static const size_t PREDICTED = SIZE_MAX;

typedef struct {
    size_t n, n_max, n_var, n_obj;
    double *X, *F;       /* (n, n_var) (n, n_obj) */
    double *violation;   /* (n) */
    double *uncertainty; /* (n) error estimate, share of range, worst objective; 0 if simulated */
    size_t *row, *age;   /* (n); age: generations for which a prediction has stood */
    void *store;
} Group;

Status group_create(Group *g, size_t n_max, size_t n_var, size_t n_obj, Err *err);
void group_free(Group *g);

/* Appends a new member with this design and returns its place; its other fields are 0, its row is PREDICTED. */
size_t group_add(Group *g, const double x[]);
void group_copy_member(Group *to, const Group *from, size_t i); /* appends */
void group_copy(Group *to, const Group *from);                  /* replaces what was there */
void group_keep(Group *g, size_t n, const size_t chosen[]);     /* chosen ascending: the rest is dropped */

/* All members; rows are below n_rows or PREDICTED. */
void group_pack(Group *g, Pack *p, size_t n_rows);

#endif
