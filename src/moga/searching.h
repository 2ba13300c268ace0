/* moga/searching.h -- a search under way: what its parts share. For the files named here alone; outsiders read
 * search.h.
 *
 *   search.c      memory, limits, the loop over generations, what the observer is told
 *   generation.c  one generation from the last one: the steps of the method in their order
 *   guide.c       whether the surface leads: what it explains, what it foretold, what it costs
 *   offspring.c   candidates: variation, inner generations and descents on the surface
 *   choice.c      which candidates are simulated
 *   repeat.c      which designs are simulated again, where answers are noisy
 *   batch.c       simulation, the only way into the archive
 *   state.c       what outlives a generation, as bytes
 *
 * Threads  one; only evaluate of the problem and predictions of the surface use several. */
#ifndef IMTET_MOGA_SEARCHING_H
#define IMTET_MOGA_SEARCHING_H

#include <string.h>

#include "base/clock.h"
#include "base/pack.h"
#include "moga/archive.h"
#include "moga/constants.h"
#include "moga/directions.h"
#include "evaluate/queue.h"
#include "moga/population.h"
#include "moga/infill.h"
#include "moga/search.h"
#include "moga/selection.h"
#include "moga/surrogate.h"

/* What proposes a design. */
typedef enum { SOURCE_SURFACE, SOURCE_PLAIN, SOURCES } Source;

/* Two that share batches: running means of each one's share of what the batches gained, and of their designs. */
typedef struct {
    double credit[2], chance[2];
} Rivals;

/* What a design carries through the queue: whether its objectives were predicted when it was asked for, the InfillKind
 * that chose it, then the prediction (n_obj). */
enum { NOTE_FORETOLD, NOTE_WAY, NOTE_FORESEEN };

typedef enum { ASIDE_OPEN, ASIDE_NO, ASIDE_YES } Aside;

typedef struct {
    const Problem *problem;
    const SearchConfig *config;
    Archive archive;
    Directions directions, wishes; /* of survival, of the choice of simulations */
    Selection *selection;
    Infill *infill[INFILL_KINDS], *gained[INFILL_KINDS]; /* by both ways: of choosing, of measuring what is gained */
    Surrogate *surrogate;
    Population population, pool, offspring;
    size_t generation, n_predicted, batch_max;
    size_t n_came, came_max; /* results that this generation took in, first in X, F, ok; most of them */
    size_t n_pending;        /* the last of the offspring: asked for already */
    Queue *queue;
    double simulating_s, guided_s; /* wall time of this session: in the simulator, of our own while guided */
    size_t n_timed, n_guided;      /* simulations in these times */
    double waited_s, surrogate_s;  /* wall time of this session: for simulations, at the surface */
    size_t aside;                  /* Aside */
    double agreement;              /* running mean of Kendall's tau between predicted and simulated batches */
    double lost;                   /* running mean of the share of what the surface chose that failed */
    Rivals sources, ways;          /* surface and plain children; the two ways by which the surface chooses */
    size_t n_plain;                /* the last of the offspring but those pending: no surface has chosen them */
    double *foreseen;              /* (batch, n_obj) what was predicted of the batch under way */
    size_t *chosen;                /* (pool) */
    size_t *followed;              /* (wishes) in the order of this generation */
    double *descended;             /* (pool, n_var) */
    double *child;                 /* (2, n_var) */
    double *note;                  /* (NOTE_FORESEEN + n_obj), n_con more for scratch */
    double *X, *F;                 /* (came) of one batch, as it comes back */
    unsigned char *ok, *foretold, *kind, *way; /* (batch) way: InfillKind of what the surface chose */
    size_t *draws;                             /* (batch) answers that there are already: 0 of new designs */
    unsigned char *allowed,
        *picked;             /* (pool) offspring that may still be, that are not to be sent to simulation any more */
    size_t reserved;         /* simulations that are kept for the last repeats */
    size_t n_rows;           /* of the archive, that there is room for in the next two */
    size_t *wins;            /* (rows) how much is built on a design */
    unsigned char *reported; /* (rows) on the front, with answers enough */
    Pack state;              /* as of the last report */
    void *store;
    double start; /* [s] of the clock */
} Search;
/* Wall time since the search began. */
static inline double search_seconds(const Search *s)
{
    return clock_seconds() - s->start;
}

/* Simulations that it was planned for. */
static inline size_t search_planned(const SearchConfig *c)
{
    return c->planned_evals > 0 ? c->planned_evals : c->max_evals;
}

/* batch.c: x is appended to a batch of n unless it is known, the batch is full or the simulations are spent; returns
 * the new n. */
size_t batch_add(Search *s, size_t n, const double x[], EvaluationKind kind);
size_t batch_size(const Search *s);
/* n designs, of which those from n_new on are repeats, are asked for; n_came results have come. */
Status batch_simulate(Search *s, size_t n_new, size_t n, Err *err);
Status batch_finish(Search *s, Err *err); /* asynchronous: only what is under way */
size_t batch_lead_max(const SearchConfig *c, size_t n_workers);
void batch_join(Search *s, Population *group, size_t first); /* simulated designs of the rows first.. join the group */

/* guide.c */
void guide_weigh_costs(Search *s);
int guide_may_lead(const Search *s);                              /* the surface is wanted and worth its time */
int guide_leads(const Search *s);                                 /* ... and can be relied on */
int guide_trusts(const Search *s, const Population *g, size_t i); /* the prediction of this member stands */
void guide_begin(Search *s);                                      /* before the first batch */
double guide_rays(const Search *s);  /* share of a batch that is chosen by rays, the rest by PBI */
size_t guide_plain(const Search *s); /* plain children in a batch that the surface leads */
int guide_expects_failure(const Search *s, const double x[]); /* one of the simulated designs nearest to x did */
void guide_judge(Search *s);                                  /* by the results that came */
void guide_measure_front(Search *s);
Status guide_fit(Search *s, Err *err);
void guide_predict(Search *s, Population *group, size_t first, int with_uncertainty);
void guide_descend(Search *s, InfillKind kind, size_t n, const size_t directions[], double X[]);

/* repeat.c: after the n designs of a batch some that the search builds on; at the end, a batch of those that it
 * reports. Both return the new n, which is the old one where nothing is to be repeated. */
size_t repeat_some(Search *s, size_t n);
size_t repeat_last(Search *s);
int repeat_tells_of_luck(const Search *s); /* answers scatter so much that means are not to be relied on */

/* offspring.c: plainly: without the surface. step names the random stream. */
void offspring_make(Search *s, int plainly);
void offspring_survive(Search *s, Population *group, uint32_t step);

/* choice.c: how many designs of the batch wait for simulation, and what they are. */
size_t choice_make(Search *s);

/* generation.c */
Status generation_first(Search *s, Err *err);
Status generation_next(Search *s, Err *err);
Status generation_last(Search *s, Err *err); /* asynchronous: takes in what is under way when the search ends */
size_t generation_samples(const Search *s);  /* of the first one, beside the given designs */

/* state.c */
void state_save(Search *s);
Status state_restore(Search *s, const SearchStart *start, Err *err);

#endif
