/* moga/state.h -- a search under way: what the files below share. Everybody else reads search.h.
 *
 *   search.c         limits, the loop over generations, the view of the observer
 *   state.c          memory; what outlives a generation, as bytes
 *   generation.c     one generation: the steps of the method in their order; the surrogate, timed
 *   surrogate.c      fit, prediction, descents, predicted failures
 *   offspring.c      candidates: variation, inner generations and descents on the surrogate
 *   infill_select.c  which candidates are evaluated
 *   replication.c    which noisy designs are evaluated again
 *   screening.c      which designs are evaluated by the cheap level first, which of them are finished
 *   batch.c          evaluation, the only way into the archive
 *
 * Threads  one; the simulator and predictions of the surrogate use several */
#ifndef IMTET_MOGA_STATE_H
#define IMTET_MOGA_STATE_H

#include <string.h>

#include "base/clock.h"
#include "base/pack.h"
#include "evaluate/problem.h"
#include "evaluate/queue.h"
#include "moga/archive.h"
#include "moga/constants.h"
#include "moga/config.h"
#include "moga/control.h"
#include "moga/convergence.h"
#include "moga/directions.h"
#include "moga/infill.h"
#include "moga/population.h"
#include "moga/selection.h"
#include "moga/surrogate.h"

/* Infill criteria, which share a batch evenly, measured on the same front and offered the same offspring: what is
 * picked lowers the values to beat. */
typedef struct {
    Directions vectors; /* reference vectors */
    Infill *select[INFILL_KINDS];
} Criteria;

/* Members in this order: proposed by the surrogate, probes, by variation, pending. */
typedef struct {
    Population members;
    size_t n_probes, n_variation, n_pending;
    unsigned char *allowed; /* (pool) may be picked now */
} Offspring;

/* Designs that are asked for, then, in the same arrays, the results that came. */
typedef struct {
    size_t size_max;              /* designs asked for at once */
    size_t n, n_max;              /* results of this generation, room for them */
    double *X, *F, *predicted;    /* (n_max, n_var) (n_max, n_obj) (n_max, n_obj) */
    unsigned char *ok, *kind;     /* (n_max) EvaluationKind */
    unsigned char *is_probe;      /* (n_max) */
    unsigned char *was_predicted; /* (n_max) */
    size_t *repeat;               /* (n_max) replicates that the design has already */
} Batch;

/* What a design carries through the queue: was_predicted, is_probe, its kind before it was screened, predicted
 * (n_obj). */
enum { NOTE_WAS_PREDICTED, NOTE_IS_PROBE, NOTE_KIND, NOTE_PREDICTED };

/* Grows with the archive. */
typedef struct {
    size_t n_max;
    size_t *importance;    /* (n_max) of designs, for replication */
    unsigned char *counts; /* (n_max) of designs, for convergence */
} PerRow;

/* Each array has one use. */
typedef struct {
    size_t *survivors;      /* (pool) of the environmental selection */
    size_t *members;        /* (pool) 0, 1, ... */
    double *bound;          /* (pool, n_obj) lower confidence bounds of the offspring's objectives */
    size_t *slices;         /* (batch.size_max) of the Latin hypercube */
    double *samples;        /* (batch.size_max, n_var) of it */
    double *given;          /* (n_var) */
    double *children;       /* (2, n_var) */
    size_t *descent_vector; /* (vectors) in the order of this generation */
    double *descent_X;      /* (pool, n_var) */
    double *note;           /* (NOTE_PREDICTED + n_obj) */
    double *f, *g, *x;      /* (n_obj) (n_con) (n_var) of a design restored */
    double *reference;      /* (n_obj) */
} Scratch;

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

typedef struct {
    const Problem *problem;
    const SearchConfig *config;
    Queue *queue;
    Archive archive;
    Surrogate *surrogate;
    SurrogateControl control;
    Criteria criteria;
    Directions directions; /* of the environmental selection */
    Selection *selection;
    Population population, pool;
    Offspring offspring;
    Batch batch;
    PerRow rows;
    Scratch scratch;
    Convergence convergence;
    Screening screening;
    size_t generation;
    size_t n_probed;              /* probes so far */
    size_t reserved;              /* evaluations kept for the last replicates */
    Pack state;                   /* as of the last report */
    double start;                 /* [s] of the clock */
    double waited_s, surrogate_s; /* of this session: for simulations; fits, predictions, descents */
    void *store;
} Search;

/* [s] wall time since the search began. */
static inline double search_seconds(const Search *s)
{
    return clock_seconds() - s->start;
}

/* Evaluations with which the search ends. */
static inline size_t search_evals(const Search *s)
{
    const size_t end = s->convergence.end, max = s->config->max_evals;
    return end > 0 && end < max ? end : max;
}

/* A design is known, or predicted from its cheap level, that is feasible. */
static inline int search_has_front(const Search *s)
{
    return s->archive.n_front > 0 || s->screening.n_front > 0;
}

/* state.c */
Status state_create(Search *s, Err *err); /* for its problem and config */
void state_free(Search *s);
Status state_grow_rows(Search *s, Err *err); /* after every generation */
void state_save(Search *s);
Status state_restore(Search *s, const SearchStart *start, Err *err);

/* generation.c */
size_t generation_samples(const Search *s); /* size of the initial sample without the given designs */
Status generation_first(Search *s, Err *err);
Status generation_next(Search *s, Err *err);
Status generation_last(Search *s, Err *err); /* asynchronous: what is under way when the search ends */
int search_uses_surrogate(const Search *s);  /* usable, and control agrees */
void search_predict(Search *s, Population *p, size_t first, int with_uncertainty);
void search_descend(Search *s, InfillKind kind, size_t n, const size_t vectors[], double X[]);

/* offspring.c: with the surrogate where it is in use, else as many children of variation as a batch takes; or by
 * variation alone, a whole population of children. step: of the random stream. */
void offspring_make(Search *s, int variation_alone);
void offspring_survive(Search *s, Population *p, uint32_t step);

/* infill_select.c: returns how many designs of the batch are to be evaluated. */
size_t infill_select_batch(Search *s);

/* replication.c: replicates of designs that the search builds on, after n designs of a batch; at its end, a batch of
 * designs that it reports. Both return the new n. */
size_t replication_add(Search *s, size_t n);
size_t replication_last(Search *s);
/* Replicates that the evaluations so far bring with them and that are not made yet. */
size_t replication_due(const Search *s);
int replication_noise_is_significant(const Search *s); /* estimates are to be compared instead of means */

/* screening.c */
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

/* batch.c */
size_t batch_size(const Search *s);
/* Appends x to a batch of n unless it is known, the batch is full or all evaluations are spent; returns the new n. */
size_t batch_add(Search *s, size_t n, const double x[], EvaluationKind kind);
/* Asks for n designs, those from n_new on replicates, and takes the results that come. */
Status batch_evaluate(Search *s, size_t n_new, size_t n, Err *err);
Status batch_finish(Search *s, Err *err); /* asynchronous: takes what is under way */
size_t batch_pending_max(const SearchConfig *c, size_t n_workers);
void batch_join(Search *s, Population *p, size_t first); /* evaluated designs of the rows first.. */

#endif
