/* moga/common.h -- what all parts of a search read: problem, configuration, queue and every evaluation so far.
 *
 * The loop changes it (search.c, generation.c); of the archive screening changes what is predicted in it.
 *
 * Threads  one */
#pragma once

#include "evaluate/problem.h"
#include "evaluate/queue.h"
#include "moga/archive.h"
#include "moga/config.h"
#include "moga/constants.h"
#include "moga/convergence.h"
#include "moga/infill.h"

typedef struct {
    const Problem *problem;
    const SearchConfig *config;
    Queue *queue;
    Archive archive;
    size_t generation;
    Convergence convergence;
} Common;

/* Infill criteria, which share a batch evenly, measured on the same front and offered the same offspring: what is
 * picked lowers the values to beat. */
typedef struct {
    Directions vectors; /* reference vectors */
    Infill *select[INFILL_KINDS];
} Criteria;

/* Evaluations with which the search ends. */
static inline size_t common_end(const Common *c)
{
    const size_t end = c->convergence.end, max = c->config->max_evals;
    return end > 0 && end < max ? end : max;
}

/* Evaluations that are left to be asked for. */
static inline size_t common_left(const Common *c)
{
    const size_t asked = c->archive.n + queue_pending(c->queue), end = common_end(c);
    return end > asked ? end - asked : 0;
}
