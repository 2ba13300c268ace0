/* moga/common.h -- what all parts of a search read: problem, configuration, what is under way, every evaluation so far.
 *
 * The steps change it (search.c, generation.c); of the archive screening changes what is predicted in it.
 *
 * Threads  one */
#pragma once

#include "moga/archive.h"
#include "moga/config.h"
#include "moga/constants.h"
#include "moga/convergence.h"
#include "moga/credit.h"
#include "moga/pending.h"

typedef struct {
    const Problem *problem;
    const SearchConfig *config;
    Pending pending;
    Archive archive;
    size_t generation;
    Convergence convergence;
} Common;

/* Infill criteria, measured on one front and offered the same designs: what is picked lowers the values to beat. */
typedef struct {
    Directions vectors; /* reference vectors */
    Infill *select[INFILL_KINDS];
    Credit credit;
} Criteria;

/* Evaluations with which the search ends. */
static inline size_t common_end(const Common *c)
{
    const size_t end = c->convergence.end, max = c->config->max_evals;
    return end > 0 && end < max ? end : max;
}

/* Questions so far. */
static inline size_t common_asked(const Common *c)
{
    return c->archive.n + c->pending.n;
}

/* Designs that may be under way when the next group is made, twice a group: an eighth of a small budget,
 * and 240 at most, each of which is predicted for every group. */
static inline size_t common_ahead(const Common *c, size_t asked)
{
    const Problem *p = c->problem;
    size_t least = (p->n_parts > 1 || p->is_noisy ? AHEAD_FEW : AHEAD) * p->n_obj;
    for (size_t d = 0; d < p->n_var; d++)
        if (p->upper[d] > p->lower[d] &&
            (problem_kind(p, d) == VARIABLE_WHOLE || problem_kind(p, d) == VARIABLE_CHOICE))
            least = AHEAD_FEW;
    least = MIN_OF(config_budget(c->config) / 8, least);
    return c->config->ahead >= 0 ? (size_t)c->config->ahead : MAX_OF(MIN_OF(asked / AHEAD_SHARE, 240), least);
}
