/* moga/batch.h -- the designs of a generation that are asked for together.
 *
 * Threads  one */
#pragma once

#include "moga/common.h"

typedef struct {
    size_t size_max;          /* designs at most */
    size_t room;              /* ... by the evaluations that are left */
    double *X;                /* (size_max, n_var) */
    unsigned char *kind;      /* (size_max) EvaluationKind */
    unsigned char *criterion; /* (size_max) InfillKind that picked it, INFILL_KINDS: none */
    size_t *repeat;           /* (size_max) replicates that the design has already */
} Batch;

/* Designs between two fits of the surrogate: more as evaluations accumulate, so that fitting never dominates; no more
 * than a look-ahead that is given, and one. */
size_t batch_size(const Common *c);
size_t batch_size_max(const SearchConfig *c);

/* Appends x to a batch of n unless it is known, the batch is full or all evaluations are spent; returns the new n. */
size_t batch_add(Batch *b, const Common *c, size_t n, const double x[], EvaluationKind kind);

/* Appends the design of a row of the archive, which has so many replicates. */
size_t batch_repeat(Batch *b, const Archive *a, size_t n, size_t row, size_t replicates);
