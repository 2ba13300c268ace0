#include "moga/searching.h"

#include <math.h>

#include "moga/variation.h"

/* Where there is nobody to breed from (every simulation failed so far), another Latin hypercube. */
static Status sample_again(Search *s, Err *err)
{
    const Problem *p = s->problem;
    const size_t first = s->archive.n;
    size_t n = 0;
    latin_hypercube(s->config->seed, (uint32_t)s->generation, s->config->population, p->n_var, p->lower, p->upper,
                    s->pool.X, s->chosen);
    for (size_t i = 0; i < s->config->population; i++) {
        problem_repair(p, s->pool.X + i * p->n_var);
        n = batch_add(s, n, s->pool.X + i * p->n_var, KIND_SAMPLED);
    }
    TRY(batch_simulate(s, n, n, err));
    batch_join(s, &s->population, first);
    return STATUS_OK;
}

/* As the archive knows the member now: a repeat may have changed it, or have failed. */
static void copy_simulated(const Search *s, Population *to, const Population *from, size_t i)
{
    const Archive *a = &s->archive;
    const size_t row = from->row[i];
    if (!a->usable[row])
        return;
    population_append(to, from, i);
    memcpy(to->F + (to->n - 1) * a->n_obj, a->estimate + row * a->n_obj, a->n_obj * sizeof *a->estimate);
    to->violation[to->n - 1] = a->violation[row];
}

/* Next population: from the simulated members of the present one, the batch, and the predictions that stand. */
static void renew_population(Search *s, size_t first_new)
{
    Population *population = &s->population, *pool = &s->pool, *offspring = &s->offspring;
    pool->n = 0;
    for (size_t i = 0; i < population->n; i++)
        if (population->row[i] != PREDICTED)
            copy_simulated(s, pool, population, i);
    for (size_t i = 0; i < offspring->n; i++)
        if (!s->picked[i] && guide_trusts(s, offspring, i)) {
            s->n_predicted += offspring->age[i]++ == 0;
            population_append(pool, offspring, i);
        }
    batch_join(s, pool, first_new);
    offspring_survive(s, pool, 0);
    population_copy(population, pool);
}

/* Nothing but repeats. No surface is fitted, and none of an earlier generation is told of. */
static Status repeat_generation(Search *s, size_t n, Err *err)
{
    const size_t first_new = s->archive.n;
    surrogate_drop(s->surrogate);
    s->offspring.n = 0;
    TRY(batch_simulate(s, 0, n, err));
    renew_population(s, first_new);
    return STATUS_OK;
}

/* What the surface makes of answers that scatter: of the front to be improved and of those that breed. */
static void take_estimates(Search *s)
{
    Archive *a = &s->archive;
    Population *g = &s->population;
    if (!repeat_tells_of_luck(s))
        return;
    surrogate_estimate(s->surrogate, a);
    guide_measure_front(s);
    for (size_t i = 0; i < g->n; i++)
        if (g->row[i] != PREDICTED)
            memcpy(g->F + i * g->n_obj, a->estimate + g->row[i] * a->n_obj, a->n_obj * sizeof *a->estimate);
}

Status generation_next(Search *s, Err *err)
{
    const size_t first_new = s->archive.n;
    const double start = search_seconds(s), waited = s->waited_s;
    s->n_predicted = 0;
    if (s->population.n < 2)
        return sample_again(s, err);
    archive_reset_estimates(&s->archive);
    guide_weigh_costs(s);
    guide_measure_front(s);
    const size_t n_last = repeat_last(s);
    if (n_last > 0)
        return repeat_generation(s, n_last, err);
    if (guide_may_lead(s))
        TRY(guide_fit(s, err));
    else
        surrogate_drop(s->surrogate);
    take_estimates(s);
    guide_predict(s, &s->population, 0, 0);
    offspring_make(s, 0);
    const size_t n = choice_make(s);
    if (n == 0 && queue_pending(s->queue) == 0)
        return sample_again(s, err);
    TRY(batch_simulate(s, n, repeat_some(s, n), err));
    guide_judge(s);
    renew_population(s, first_new);
    if (guide_may_lead(s)) {
        s->guided_s += search_seconds(s) - start - (s->waited_s - waited);
        s->n_guided += s->n_came;
    }
    return STATUS_OK;
}

Status generation_last(Search *s, Err *err)
{
    const size_t first_new = s->archive.n;
    s->n_predicted = s->offspring.n = 0;
    archive_reset_estimates(&s->archive);
    TRY(batch_finish(s, err));
    renew_population(s, first_new);
    return STATUS_OK;
}

/* Enough for a first surface of this many variables, and no more than half of the budget. */
static size_t initial_size(const Search *s)
{
    const size_t wanted = INITIAL_PER_VARIABLE * s->problem->n_var + INITIAL_OFFSET,
                 half = (search_planned(s->config) + 1) / 2;
    if (s->config->initial > 0)
        return s->config->initial;
    return wanted < half ? wanted : half > 4 ? half : 4;
}

/* Samples beside n_given designs that are given: what is left of the first sample, but at least a half of it. */
size_t generation_samples(const Search *s)
{
    const size_t initial = initial_size(s), given = s->config->n_given;
    return given < initial / 2 ? initial - given : initial - initial / 2;
}

/* Into the box, then into what can be built. */
static void make_allowed(const Problem *p, double x[])
{
    for (size_t d = 0; d < p->n_var; d++)
        x[d] = fmin(fmax(x[d], p->lower[d]), p->upper[d]);
    problem_repair(p, x);
}

Status generation_first(Search *s, Err *err)
{
    const Problem *p = s->problem;
    size_t n = 0;
    for (size_t i = 0; i < s->config->n_given; i++) {
        memcpy(s->child, s->config->given + i * p->n_var, p->n_var * sizeof *s->child);
        make_allowed(p, s->child);
        n = batch_add(s, n, s->child, KIND_SAMPLED);
    }
    latin_hypercube(s->config->seed, 0, generation_samples(s), p->n_var, p->lower, p->upper, s->pool.X, s->chosen);
    for (size_t i = 0; i < generation_samples(s); i++) {
        make_allowed(p, s->pool.X + i * p->n_var);
        n = batch_add(s, n, s->pool.X + i * p->n_var, KIND_SAMPLED);
    }
    TRY(batch_simulate(s, n, n, err));
    batch_join(s, &s->pool, 0);
    offspring_survive(s, &s->pool, 0);
    population_copy(&s->population, &s->pool);
    return STATUS_OK;
}
