/* moga/state.h -- a search under way, for its loop alone: search.c (limits, the observer's view), generation.c (the
 * steps of one generation) and state.c (memory; what outlives a generation, as bytes). Every other file gets the part
 * that it changes and moga/common.h; everybody else reads search.h.
 *
 * Threads  one; the simulator and predictions of the surrogate use several */
#pragma once

#include "base/clock.h"
#include "base/pack.h"
#include "moga/offspring.h"
#include "moga/screening.h"

/* Each array has one use. */
typedef struct {
    size_t *members; /* (pool) 0, 1, ... */
    size_t *slices;  /* (batch.size_max) of the Latin hypercube */
    double *samples; /* (batch.size_max, n_var) of it */
    double *given;   /* (n_var) */
    double *f, *g;   /* (n_obj) (n_con) of a design restored */
    double *x;       /* (n_var) of a pending one */
} Scratch;

typedef struct {
    Common common;
    Surrogate *surrogate;
    Criteria criteria;
    Directions directions; /* of the environmental selection */
    Selection *selection;
    Population population;
    Offspring offspring;
    Batch batch;
    Screening screening;
    Scratch scratch;
    Pack state;                   /* as of the last report */
    double start;                 /* [s] of the clock */
    double waited_s, surrogate_s; /* of this session: for simulations; fits, candidates on the surrogate */
    void *store;
} Search;

/* [s] wall time since the search began. */
static inline double search_seconds(const Search *s)
{
    return clock_seconds() - s->start;
}

/* state.c */
Status state_create(Search *s, Err *err); /* for its problem and config */
void state_free(Search *s);
void state_save(Search *s);
Status state_restore(Search *s, const SearchStart *start, Err *err);

/* generation.c */
size_t generation_samples(const Search *s); /* size of the initial sample without the given designs */
Status generation_first(Search *s, Err *err);
Status generation_next(Search *s, Err *err);
Status generation_last(Search *s, Err *err); /* asynchronous: what is under way when the search ends */
