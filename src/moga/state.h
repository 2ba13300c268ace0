/* moga/state.h -- a search under way, for its steps alone: search.c (what is asked and told, limits), generation.c (one
 * group of questions and the step that follows) and state.c (memory; what outlives a step, as bytes). Every other file
 * gets the part that it changes and moga/common.h; everybody else reads search.h.
 *
 * Threads  one; predictions of the surrogate use several */
#pragma once

#include "moga/offspring.h"
#include "moga/screening.h"

/* Each array has one use. */
typedef struct {
    size_t *members; /* (pool) 0, 1, ... */
    size_t *slices;  /* (batch.size_max) of the Latin hypercube */
    double *samples; /* (batch.size_max, n_var) of it */
    double *f;       /* (n_obj + n_con) f, then g of a design restored */
} Scratch;

typedef struct Search Search; /* moga/search.h */

enum { VAIN_MAX = 100 };

struct Search {
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
    size_t n_before;    /* rows before the last step */
    size_t n_vain;      /* groups one after the other in which every design was known; VAIN_MAX: so is the space */
    size_t allowed;     /* questions that may be under way when the next answers enter */
    StopReason reason;  /* STOP_NONE: it goes on; else what is under way enters, and it is over */
    int is_behind_step; /* a group is to be made, where the search is not over; until then the archive has the results
                           of what is screened */
    Pack state;
    void *store;
};

/* state.c */
Status state_create(Search *s, Err *err); /* for its problem and config */
void state_free(Search *s);
void state_pack(Search *s, Pack *p);
Status state_restore(Search *s, const SearchStart *start, Err *err);

/* generation.c */
size_t generation_samples(const Search *s);   /* size of the initial sample without the given designs */
Status generation_ask(Search *s, Err *err);   /* makes the questions of this generation */
Status generation_enter(Search *s, Err *err); /* all but the last `allowed` answers enter the archive */
