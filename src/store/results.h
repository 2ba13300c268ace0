/* store/results.h -- results of evaluations 1, 2, ... as they pass by when a run is resumed, so that its end need not read
 * them again.
 *
 * Kept as long as all succeed and memory is there: n is 0 otherwise.
 *
 * Life cycle  {0} -> results_begin -> results_take, ... -> results_table -> results_free
 * Memory      8 n_obj + 21 bytes each
 * Threads     one at a time */
#ifndef IMTET_STORE_RESULTS_H
#define IMTET_STORE_RESULTS_H

#include "evaluate/evaluation.h"

typedef struct {
    size_t n, n_max, n_obj;
    double *f, *seconds, *violation; /* (n, n_obj) (n) (n) */
    int *generation;                 /* (n) */
    unsigned char *kind;             /* (n) */
    void *store;
} Results;

void results_begin(Results *r, size_t n_max, size_t n_obj);
void results_take(Results *r, const Evaluation *e);

/* Into an empty table whose n_var and n_extra are 0. */
Status results_table(const Results *r, EvaluationTable *table, Err *err);

void results_free(Results *r);

#endif
