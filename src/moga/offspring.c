#include "moga/searching.h"

#include <math.h>

#include "moga/dominance.h"
#include "moga/variation.h"

void offspring_survive(Search *s, Population *group, uint32_t step)
{
    Random random = random_stream(s->config->seed, RANDOM_NICHING, (uint32_t)s->generation, step);
    const double progress = fmin((double)s->archive.n / (double)search_planned(s->config), 1.0);
    const size_t n = selection_select(s->selection, group->n, group->F, group->violation, s->config->population,
                                      progress, &random, s->chosen);
    population_keep(group, n, s->chosen);
}

static const double *tournament(const Population *g, Random *random)
{
    const size_t a = random_below(random, g->n), b = random_below(random, g->n), m = g->n_obj;
    const int b_wins = dominates_constrained(m, g->F + b * m, g->violation[b], g->F + a * m, g->violation[a]);
    return g->X + (b_wins ? b : a) * g->n_var;
}

/* Appends n children of the group's first n_parents members to it. Child pair j of step has its own streams. */
static void breed(Search *s, Population *group, size_t n, uint32_t step)
{
    const Problem *p = s->problem;
    const SearchConfig *c = s->config;
    Population parents = *group;
    for (size_t j = 0; 2 * j < n; j++) {
        const uint32_t name = step * (uint32_t)c->population + (uint32_t)j;
        Random choice = random_stream(c->seed, RANDOM_PARENTS, (uint32_t)s->generation, name);
        Random change = random_stream(c->seed, RANDOM_VARIATION, (uint32_t)s->generation, name);
        const double *mother = tournament(&parents, &choice), *father = tournament(&parents, &choice);
        crossover_sbx(&change, p->n_var, p->lower, p->upper, c->crossover_probability, c->crossover_eta, mother, father,
                      s->child, s->child + p->n_var);
        for (size_t i = 0; i < 2 && 2 * j + i < n; i++) {
            double *x = s->child + i * p->n_var;
            mutate_polynomial(&change, p->n_var, p->lower, p->upper, c->mutation_rate / (double)p->n_var,
                              c->mutation_eta, x);
            problem_repair(p, x);
            population_add(group, x);
        }
    }
}

/* Some directions, drawn anew each time, are followed down the surface. */
static void add_descended(Search *s)
{
    const Problem *p = s->problem;
    size_t n = DESCENTS_PER_DESIGN * batch_size(s);
    Random random = random_stream(s->config->seed, RANDOM_DESCENT, (uint32_t)s->generation, 0);
    n = n < s->wishes.n ? n : s->wishes.n;
    for (size_t r = 0; r < s->wishes.n; r++)
        s->followed[r] = r;
    random_shuffle(&random, s->wishes.n, s->followed);
    const size_t rays = (size_t)(guide_rays(s) * (double)n);
    guide_descend(s, INFILL_HYPERVOLUME, rays, s->followed, s->descended);
    guide_descend(s, INFILL_PBI, n - rays, s->followed + rays, s->descended + rays * p->n_var);
    for (size_t i = 0; i < n; i++) {
        problem_repair(p, s->descended + i * p->n_var);
        population_add(&s->offspring, s->descended + i * p->n_var);
    }
}

/* What is asked for already stands behind the offspring, as the surface sees it now. */
static void add_pending(Search *s)
{
    const size_t first = s->offspring.n, most = s->came_max, n = queue_pending(s->queue);
    s->n_pending = n < most ? n : most;
    for (size_t i = 0; i < s->n_pending; i++)
        population_add(&s->offspring, queue_design(s->queue, i).x);
    guide_predict(s, &s->offspring, first, 1);
}

/* What survives some generations of variation and selection on the surface and has not been simulated. */
static void add_evolved(Search *s)
{
    population_copy(&s->pool, &s->population);
    for (uint32_t step = 0; step < INNER_GENERATIONS; step++) {
        const size_t n_parents = s->pool.n;
        breed(s, &s->pool, s->config->population, step);
        guide_predict(s, &s->pool, n_parents, 0);
        offspring_survive(s, &s->pool, 1 + step);
    }
    for (size_t i = 0; i < s->pool.n; i++)
        if (s->pool.row[i] == PREDICTED)
            population_append(&s->offspring, &s->pool, i);
}

static void add_plain(Search *s, size_t n)
{
    const size_t n_parents = s->population.n, first = s->offspring.n;
    population_copy(&s->pool, &s->population);
    breed(s, &s->pool, n, 0);
    for (size_t i = n_parents; i < s->pool.n; i++)
        population_append(&s->offspring, &s->pool, i);
    s->n_plain = n;
    guide_predict(s, &s->offspring, first, 1);
}

/* Where a surface can be relied on, what it proposes, and plain children if a batch has room for some; else those
 * alone.
 */
void offspring_make(Search *s, int plainly)
{
    const int guided = guide_leads(s) && !plainly;
    s->offspring.n = s->n_pending = 0;
    if (guided) {
        add_evolved(s);
        if (s->archive.n_front > 0)
            add_descended(s);
        guide_predict(s, &s->offspring, 0, 1);
    }
    add_plain(s, guided && guide_plain(s) == 0 ? 0 : s->config->population);
    add_pending(s);
}
