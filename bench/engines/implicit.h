/* bench/engines/implicit.h -- contact forces of an implicit step, by Newton.
 *
 * With everything linear eliminated mode by mode, what is left of a step are the forces themselves. At the points
 * (stage, floor) numbered k = stage n + j, N = stages n of them,
 *
 *     w = w_free + A f,   w' = wd_free + B f,   f_k = -s F(|w_k| - gap, s w'_k, v0),  s = sign(w_k)
 *
 * v0: contacts_speed, constant over the step. Life cycle  implicit_create -> implicit_solve ... -> implicit_free */
#pragma once

#include "sim/cvode/contacts.h"

typedef struct {
    int n, N;                /* floors, points */
    double *A, *B;           /* (N, N) [m/N], [m/(N s)] by columns: entry (k, l) at [l N + k] */
    double *w_free;          /* (N) [m] */
    double *wd_free;         /* (N) [m/s] */
    double *f;               /* (N) [N] in: where Newton starts; out: the forces */
    double *w, *wd;          /* (N) */
    double *jacobian, *rhs;  /* (N, N), (N) of the points that are in contact */
    int *in_contact, *pivot; /* (N) */
    long evaluations;
    void *store;
} Implicit;

Status implicit_create(Implicit *x, int n, int stages, Err *err);
void implicit_free(Implicit *x);

/* 0: Newton did not converge. */
int implicit_solve(Implicit *x, const Contacts *c);
