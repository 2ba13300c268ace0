/* moga/question.h -- what a search asks for: one design to be evaluated, all of it or its first parts. */
#pragma once

#include "evaluate/evaluation.h"

typedef struct {
    size_t number;   /* 1, 2, ... in the order of asking: keys random streams, and names the answer */
    const double *x; /* (n_var), until the next call on the search */
    size_t repeat;   /* evaluations of this design that there are already */
    EvaluationKind kind;
    size_t generation;       /* that it belongs to */
    unsigned char criterion; /* of infill that picked it (moga/infill.h); INFILL_KINDS: none */
    size_t n_parts;          /* the first parts alone; 0: all */
    const void *cheap_parts; /* (Problem.n_cheap) parts of this design that are there; NULL: none */
} Question;
