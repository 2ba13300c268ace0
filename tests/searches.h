/* tests/searches.h -- what tests of the search share: a configuration, and the states that a search went through. */
#pragma once

#include "moga/search.h"
#include "bench/textbook.h"
#include "functions.h"
#include "moga/constants.h"
#include "base/dominance.h"
#include "study/search_loop.h"

/* As the program has it, but for what every test has of its own: seed, sizes, limits. */
static inline SearchConfig search_config(uint32_t seed, size_t population, size_t surrogate_max)
{
    return (SearchConfig){.seed = seed, .population = population, .surrogate_max = surrogate_max, .ahead = -1};
}

enum { MOMENTS_MAX = 200 };

/* After every generation: rows of the archive so far, and the state from which the search can go on. */
typedef struct {
    size_t n, rows[MOMENTS_MAX], n_state[MOMENTS_MAX];
    unsigned char *state[MOMENTS_MAX];
} Moments;

static inline void moments_note(Moments *m, const SearchView *v)
{
    assert_less(m->n, MOMENTS_MAX);
    assert_non_null(v->state);
    const size_t k = m->n++;
    m->rows[k] = v->all->n;
    m->n_state[k] = v->n_state;
    m->state[k] = malloc(v->n_state);
    assert_non_null(m->state[k]);
    memcpy(m->state[k], v->state, v->n_state);
}

static inline void moments_free(Moments *m)
{
    for (size_t k = 0; k < m->n; k++)
        free(m->state[k]);
    *m = (Moments){0};
}

enum { SEEN_VAR = 22, SEEN_OBJ = 7, SEEN_ROWS = 600 };

/* The last view of a search, copied out, and what tests note beside it. */
typedef struct {
    size_t n, n_front, n_failed, n_repeats, views, stop_at_view, first_generation, last_generation;
    double X[SEEN_ROWS * SEEN_VAR], Y[SEEN_ROWS * SEEN_OBJ], F[SEEN_ROWS * SEEN_OBJ], G[SEEN_ROWS], error;
    unsigned char ok[SEEN_ROWS], on_front[SEEN_ROWS], kind[SEEN_ROWS];
    size_t generation[SEEN_ROWS], replicates[SEEN_ROWS];
    Moments moments;
    StopReason reason;
} Seen;

/* As observer of a search. */
static inline int seen_note(const SearchView *v, const SearchTime *time, void *user)
{
    const Archive *a = v->all;
    Seen *s = user;
    (void)time;
    assert_at_most(a->n, SEEN_ROWS);
    if (s->views++ == 0)
        s->first_generation = v->generation;
    s->last_generation = v->generation;
    s->n = a->n;
    s->n_front = a->n_front;
    s->n_failed = a->n_failed;
    s->n_repeats = a->n_replicates;
    s->error = v->surrogate_error;
    memcpy(s->X, a->X, a->n * a->n_var * sizeof *s->X);
    memcpy(s->Y, a->Y, a->n * a->n_obj * sizeof *s->Y);
    memcpy(s->F, a->F, a->n * a->n_obj * sizeof *s->F);
    memcpy(s->G, a->H, a->n * a->n_con * sizeof *s->G);
    memcpy(s->ok, a->ok, a->n);
    memcpy(s->kind, a->kind, a->n);
    memcpy(s->on_front, a->on_front, a->n);
    memcpy(s->generation, a->generation, a->n * sizeof *s->generation);
    memcpy(s->replicates, a->replicates, a->n * sizeof *s->replicates);
    return s->views == s->stop_at_view;
}

/* The same, and what the search can go on from. */
static inline int moment_note(const SearchView *v, const SearchTime *time, void *user)
{
    Seen *s = user;
    moments_note(&s->moments, v);
    return seen_note(v, time, user);
}

/* Runs a search whose moments are noted; what was seen before is released. */
static inline void run_noting(const Problem *p, const SearchConfig *c, const SearchStart *start, Seen *s)
{
    moments_free(&s->moments);
    memset(s, 0, sizeof *s);
    CHECK_OK(search_run(p, c, start, moment_note, s, &s->reason, &err), &err);
}
