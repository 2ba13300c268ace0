/* study/local.h -- the goal of study/goal.h solved on a surrogate and the true evaluation in turn.
 *
 *   each round  1 surrogate of the known designs, those tried before among them (rbf/rbf.h)
 *               2 in LOCAL_BATCH boxes about the best design, the first `trust` wide each way and every further one
 *                 half as wide, half of the variables free to move, NLopt (CCSA, with its derivatives)
 *                 looks for the most
 *                     expected improvement of the value  x  probability that each bound is kept,
 *                 of normal errors with the deviation of its leave-one-out errors about the best
 *               3 these designs are evaluated together; the best that keeps everything is the new centre
 *               trust becomes twice the box in which that was found, or a little less where none was
 *
 * The halves matter: where an objective is jagged, proposals that differ find by chance what no surrogate predicts.
 *
 * Guards      a failed evaluation is never believed; the answer is never worse than the start
 * Repeatable  same numbers for the same seed; max_seconds is looked at between rounds
 * Threads     call it from one thread; the queue shares a batch out, the numbers do not depend on how many work
 * Sources     Schonlau, Welch and Jones, Global versus local search in constrained optimization of computer models,
 *             1998 (the product); Regis and Shoemaker, J. Global Optim. 37 (2007) 113-135 (boxes that grow and
 *             shrink); Regis and Shoemaker, Eng. Optim. 45 (2013) 529-555 (some of the variables at a time). */
#ifndef IMTET_STUDY_LOCAL_H
#define IMTET_STUDY_LOCAL_H

#include <stdint.h>

#include "study/goal.h"

enum { LOCAL_BATCH = 4 }; /* designs asked for at once, so that threads have work; the same at any number of them */

/* Designs that were evaluated before. */
typedef struct {
    size_t n;
    double *X, *F; /* (n, n_var) (n, n_obj) */
    double *noise; /* (n) variance of their answers by that of one answer: 1/replicates */
} Known;

typedef struct {
    Goal goal;
    Known known;
    double noise; /* the same of a design that is tried */
    size_t max_evals;
    double max_seconds; /* 0: no limit */
    uint32_t seed;
} LocalConfig;

typedef struct {
    size_t n_evaluated, n_failed;
    double *x, *f; /* (n_var) (n_obj): the caller's; the start and its objectives, then the best */
} LocalResult;

/* With fewer known designs than variables there is no surrogate and nothing is tried. */
Status local_run(Queue *queue, const LocalConfig *config, LocalResult *result, Err *err);

#endif
