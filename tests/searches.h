/* tests/searches.h -- what tests of the search share: a configuration, and the states that a search went through. */
#ifndef IMTET_TESTS_SEARCHES_H
#define IMTET_TESTS_SEARCHES_H

#include "check.h"

#include "moga/search.h"

/* As the program has it, but for what every test has of its own: seed, sizes, limits. */
static inline SearchConfig search_config(uint32_t seed, size_t population, size_t surrogate_max)
{
    return (SearchConfig){.seed = seed, .population = population, .surrogate_max = surrogate_max, .ahead = -1};
}

/* Every row of the archive, copied out. */
static inline void rows_note(const Archive *a, double X[], double F[], double G[], unsigned char ok[],
                             unsigned char kind[], unsigned char on_front[], size_t generation[])
{
    memcpy(X, a->X, a->n * a->n_var * sizeof *X);
    memcpy(F, a->Y, a->n * a->n_obj * sizeof *F);
    memcpy(G, a->H, a->n * a->n_con * sizeof *G);
    memcpy(ok, a->ok, a->n);
    memcpy(kind, a->kind, a->n);
    memcpy(on_front, a->on_front, a->n);
    memcpy(generation, a->generation, a->n * sizeof *generation);
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

#endif
