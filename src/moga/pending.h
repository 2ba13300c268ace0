/* moga/pending.h -- questions of a search that are asked and whose answers have not entered it yet, in their order.
 *
 * Questions are numbered 1, 2, ... as they are made; answers are told in any order, and enter in that of the numbers.
 *
 * Memory   grows by doubling
 * Threads  one */
#pragma once

#include "base/pack.h"
#include "evaluate/problem.h"
#include "moga/question.h"

/* One question, and its answer where it is told. */
typedef struct {
    Question q; /* q.x: pending_x */
    int is_told;
    unsigned char ok;
    unsigned char *parts; /* of the cheap level, own; NULL: not known */
} Place;

typedef struct {
    size_t n_var, n_obj, n_con;
    size_t n, head, n_max; /* places head .. head+n */
    size_t n_handed;       /* the first of them are handed out */
    size_t n_known;        /* the first of them are told */
    size_t n_entered;      /* ever: number of a place is n_entered + 1 + its index */
    size_t n_of_kind[KIND_COUNT];
    Place *place;
    double *number; /* (n_max, n_var + n_obj + n_con) x, then minimised f and g */
} Pending;

void pending_free(Pending *p);

/* Place i in the order of asking, and its x, behind which are minimised f and g where it is told; they hold until the
 * next question is added. */
Place *pending_at(const Pending *p, size_t i);
double *pending_x(const Pending *p, size_t i);

/* One more question, of which x is copied. */
Status pending_add(Pending *p, const Question *q, Err *err);

/* The next question that is not handed out; 0: there is none. */
int pending_hand(Pending *p, Question *q);

/* Question `number` is told; parts (size bytes) are copied, *f is where minimised f and g are to be put. */
Status pending_tell(Pending *p, size_t number, int ok, const void *parts, size_t size, double **f, Err *err);
void pending_enter(Pending *p); /* the first one is answered and has entered */

int pending_has(const Pending *p, const double x[]);

/* As questions that are not handed out and not told. */
void pending_pack(Pending *p, Pack *pack);
