/* tests/searches.h -- what tests of the search share: a configuration, and the states that a search went through. */
#ifndef IMTET_TESTS_SEARCHES_H
#define IMTET_TESTS_SEARCHES_H

#include "check.h"

#include <stdlib.h>
#include <string.h>

#include "moga/search.h"

/* As the program has it, but for what every test has of its own: seed, sizes, limits. */
static inline SearchConfig search_config(uint32_t seed, size_t population, size_t surrogate_max)
{
    return (SearchConfig){
        .seed = seed, .population = population, .surrogate_max = surrogate_max, .nondominated_share = 1, .ahead = -1};
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
