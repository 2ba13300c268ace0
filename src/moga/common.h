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

/* Designs that may be under way when the next group is made: an eighth of a small budget, and 240 at most, each of
 * which is predicted for every group. */
static inline size_t common_ahead(const SearchConfig *c, size_t asked)
{
    const size_t least = MIN_OF(config_budget(c) / 8, AHEAD), share = 2 * asked / AHEAD, most = MIN_OF(share, 240);
    return c->ahead >= 0 ? (size_t)c->ahead : MAX_OF(most, least);
}
