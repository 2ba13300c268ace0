/* moga/batch.h -- the designs of a generation that are asked for together.
 *
 * Threads  one */
#pragma once

#include "moga/common.h"

typedef struct {
    size_t size_max; /* designs at most */
    size_t room;     /* ... by the evaluations that are left */
    size_t n;
    double *X;   /* (size_max, n_var) */
    Question *q; /* (size_max) of them */
} Batch;

/* Designs between two fits of the surrogate: half of the look-ahead, more as evaluations accumulate, so that fitting
 * never dominates. */
size_t batch_size(const Common *c);

/* Appends x unless it is known, the batch is full or all evaluations are spent; criterion: that picked it. */
void batch_add(Batch *b, const Common *c, const double x[], EvaluationKind kind, InfillKind criterion);

/* Appends the design of a row of the archive, which has so many replicates. */
void batch_repeat(Batch *b, const Archive *a, size_t row, EvaluationKind kind, size_t replicates);
