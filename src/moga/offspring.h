/* moga/offspring.h -- the candidates of a batch: what the surrogate proposes, or children of variation.
 *
 * Memory   all of it in state_create
 * Threads  one; predictions and descents use several */
#pragma once

#include "moga/batch.h"
#include "moga/selection.h"
#include "moga/surrogate.h"

/* Members in this order: proposed by the surrogate; probes, or those by variation; pending. */
typedef struct {
    Population members;
    Population pool;   /* of a generation on the surrogate */
    size_t n_unpicked; /* probes, or by variation: as many as fit into the batch are evaluated */
    size_t n_pending;
    size_t n_dealt;         /* reference vectors of descents so far */
    unsigned char *allowed; /* (pool) may be picked now */
    double *bound;          /* (pool, n_obj) lower confidence bounds of the objectives */
    size_t *survivors;      /* (pool) of the environmental selection */
    double *children;       /* (population + 1, n_var) */
    double *scaled; /* (2 + 3 (population + 1) / 2, n_var) bounds; parents and a child of each pair: on the scale of
                       variation */
    size_t *descent_vector; /* (2, vectors) those of this group; all in the order in which they are dealt */
    double *descent_X;      /* (pool, n_var) */
    size_t pending_max;     /* designs that may be pending */
} Offspring;

/* Who takes part in making them. */
typedef struct {
    const Common *common;
    const Population *population;
    Surrogate *surrogate;
    const Criteria *criteria;
    Selection *selection;
    int with_surrogate, has_front; /* a design is known, or predicted from its cheap level, that is feasible */
} Breeding;

/* Those that are to be evaluated go to the batch. */
void offspring_propose(Offspring *o, const Breeding *w, Batch *b);

/* Environmental selection; step: of the random stream. */
void offspring_survive(Offspring *o, const Common *c, Selection *selection, Population *p, uint32_t step);
