/* moga/screening.h -- screening: most designs are evaluated by the cheap level of the problem alone.
 *
 * The whole evaluation is predicted from the cheap one, output by output, over the designs that have both, y = a + b y_cheap
 * by least squares, and the predictions stand in the archive. Of the designs on the front of results and predictions those
 * that add most to the front of the whole evaluations are finished: evaluated as a whole, to the same bytes as if asked for
 * at once, of the first replicates the other simulations alone. A row of the cheap level is never on the front of the
 * archive. One design is finished for SCREENED_PER_FINISHED, LEVEL_PAIRS after the initial sample, most at the end.
 *
 * The levels agree while Kendall's tau, mean over the objectives, is LEVEL_TAU_MIN at least: of the pairs of designs that
 * the whole evaluation tells apart; those that the cheap level does not tell apart speak neither for it nor against it, so
 * that tau of a constant is 0. Where they do not agree the initial sample is finished and nothing is screened any more.
 *
 * Sources  Kennedy and O'Hagan, Biometrika 87 (2000) 1-13 (autoregression between levels)
 * Threads  one */
#ifndef IMTET_MOGA_SCREENING_H
#define IMTET_MOGA_SCREENING_H

#include "evaluate/problem.h"
#include "evaluate/queue.h"

typedef struct Search Search;

/* A design of which the cheap level was evaluated first. */
typedef struct {
    size_t row, finished; /* of the archive; of its evaluation in full, SIZE_MAX: there is none */
    void *parts;          /* (n_cheap) of part_size, parts of the whole; NULL: not kept */
} Screened;

typedef struct {
    LevelCosts cost; /* whole 1: nothing is screened in this search */
    size_t is_on;    /* 0: the levels do not agree, or nothing is screened */
    size_t n, n_max, n_finished;
    size_t n_open;                     /* on that front, not finished */
    Screened *design;                  /* (n) by row */
    double *y;                         /* (n, n_obj + n_con) objectives and constraints of the cheap level */
    double agreement;                  /* Kendall's tau of the two levels; NAN: not known yet */
    size_t n_front, front_max, *front; /* rows of the front of results and predictions */
    unsigned char *is_chosen;          /* (front_max) rows that are finished in this generation */
    size_t *rows, n_rows;              /* (n_max) designs that have both levels */
} Screening;

void screening_begin(Search *s);
void screening_free(Search *s);
size_t search_evaluations(const Search *s); /* of max_evals; what a screened design costs is a part of one */
int search_is_spent(const Search *s);

/* Room for a batch of n new designs, beside what the screened ones are finished with. */
int screening_has_room(const Search *s, size_t n);
Status screening_take(Search *s, const Finished *done, Err *err); /* before it enters the archive */
Status screening_update(Search *s, Err *err);                     /* after results: predictions, agreement, front */
void screening_exchange(Search *s); /* predictions in the archive for what was evaluated, and back */
const void *screening_parts(const Search *s, const double x[]); /* of the cheap level of x; NULL: not kept */

/* Screened designs to be finished, after n designs of a batch; when the rest is kept for them, a batch of them. */
Status screening_finish(Search *s, size_t *n, Err *err);
Status screening_last(Search *s, size_t *n, Err *err);
int screening_is_due(const Search *s); /* designs are to be finished, and there is room */

#endif
