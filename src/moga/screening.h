/* moga/screening.h -- most designs are evaluated by the cheap level of the problem alone; screening.c says how.
 *
 * Life cycle  screening_begin -> (screening_enter, screening_update ...) ... -> screening_free
 * Memory      grows with the screened designs
 * Threads     one */
#pragma once

#include "moga/batch.h"
#include "moga/levels.h"

/* An evaluation as it enters the archive. */
typedef struct {
    const double *x, *f; /* f: minimised, then g */
    int ok;
    EvaluationKind kind;
    size_t generation;
    const void *parts; /* of the cheap level; NULL: not known */
} Answer;

/* A design of which the cheap level was evaluated first. */
typedef struct {
    size_t row, finished; /* of the archive; of its evaluation in full, SIZE_MAX: there is none */
    void *parts;          /* (n_cheap) of part_size, parts of the whole; NULL: not kept */
} Screened;

typedef struct {
    const Problem *problem;
    LevelCosts cost; /* whole 1: nothing is screened in this search */
    size_t is_on;    /* 0: the levels do not agree, or nothing is screened */
    int is_biased;   /* the cheap level has errors that are functions of the design: its records are always the same */
    size_t n_out;    /* objectives and constraints */
    size_t n, n_max, n_finished;
    size_t n_open;    /* on that front, not finished */
    Screened *design; /* (n) by row */
    double *y;        /* (n, n_out) objectives and constraints of the cheap level */
    double agreement; /* Kendall's tau of the two levels; NAN: not known yet */
    size_t n_front;   /* of the archive's expected front */
    size_t n_rows;    /* designs that have both levels */
} Screening;

void screening_begin(Screening *q, const Common *c);
void screening_free(Screening *q);

size_t screening_evaluations(const Screening *q,
                             const Common *c); /* of max_evals; a screened design is a part of one */
int screening_is_spent(const Screening *q, const Common *c);

/* New designs, n_max at most, that there is room for beside what the screened ones are finished with. */
size_t screening_room(const Screening *q, const Common *c, size_t n_max);

Status screening_enter(Screening *q, Common *c, const Answer *answer, Err *err); /* into the archive */
Status screening_update(Screening *q, Common *c, Err *err); /* after results: predictions, agreement, front */
void screening_exchange(Screening *q, Archive *a); /* predictions in the archive for what was evaluated, and back */
const void *screening_parts(const Screening *q, const Common *c, const double x[]); /* of the cheap level; NULL: none */

/* Screened designs to be finished, beside what is in the batch. */
Status screening_finish(Screening *q, Common *c, Batch *b, Err *err);
/* A batch of them where no evaluation of a new design is left, or no new design. */
Status screening_last(Screening *q, Common *c, Batch *b, int is_exhausted, Err *err);
