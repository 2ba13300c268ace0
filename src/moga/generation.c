#include "moga/state.h"

#include <math.h>

#include "moga/variation.h"

/* -- step 1: initial sample ---------------------------------------------------------------------------------------- */

/* Designs that the search was planned for: where they are screened, more than evaluations. */
static size_t planned(const Search *s)
{
    const SearchConfig *c = s->config;
    const Screening *q = &s->screening;
    const size_t evals = c->planned_evals > 0 ? c->planned_evals : c->max_evals, n = SCREENED_PER_FINISHED;
    return q->cost.whole == 1 ? evals : evals * n * q->cost.whole / (n * q->cost.cheap + q->cost.rest);
}

/* Enough for a first surrogate of this many variables, and no more than half of the budget. */
static size_t initial_size(const Search *s)
{
    const size_t wanted = INITIAL_PER_VARIABLE * s->problem->n_var + INITIAL_OFFSET, half = (planned(s) + 1) / 2;
    if (s->config->initial > 0)
        return s->config->initial;
    return wanted < half ? wanted : half > 4 ? half : 4;
}

/* What the given designs leave of the initial sample, half of it at least. */
size_t generation_samples(const Search *s)
{
    const size_t initial = initial_size(s), given = s->config->n_given;
    return given < initial / 2 ? initial - given : initial - initial / 2;
}

static size_t add_samples(Search *s, size_t n, size_t n_samples)
{
    const Problem *p = s->problem;
    double *X = s->scratch.samples;
    latin_hypercube(s->config->seed, (uint32_t)s->generation, n_samples, p->n_var, p->lower, p->upper, X,
                    s->scratch.slices);
    for (size_t i = 0; i < n_samples; i++) {
        problem_repair(p, X + i * p->n_var);
        n = batch_add(s, n, X + i * p->n_var, KIND_SAMPLED);
    }
    return n;
}

static size_t add_given(Search *s)
{
    const Problem *p = s->problem;
    double *x = s->scratch.given;
    size_t n = 0;
    for (size_t i = 0; i < s->config->n_given; i++) {
        for (size_t d = 0; d < p->n_var; d++)
            x[d] = fmin(fmax(s->config->given[i * p->n_var + d], p->lower[d]), p->upper[d]);
        problem_repair(p, x);
        n = batch_add(s, n, x, KIND_SAMPLED);
    }
    return n;
}

Status generation_first(Search *s, Err *err)
{
    const size_t n = add_samples(s, add_given(s), generation_samples(s));
    TRY(batch_evaluate(s, n, n, err));
    batch_join(s, &s->pool, 0);
    offspring_survive(s, &s->pool, 0);
    population_copy(&s->population, &s->pool);
    return STATUS_OK;
}

/* No parents (every evaluation failed so far) or no new design: another Latin hypercube. */
static Status sample_again(Search *s, Err *err)
{
    const size_t first = s->archive.n, n = add_samples(s, 0, s->config->population);
    surrogate_drop(s->surrogate); /* a resumed search has none here either */
    TRY(batch_evaluate(s, n, n, err));
    batch_join(s, &s->population, first);
    return STATUS_OK;
}

/* -- step 2: surrogate --------------------------------------------------------------------------------------------- */

/* The front to be improved; where nothing is feasible yet, the population. Plain search does not look at it, but for
 * the choice of designs to be replicated. */
static void measure_front(Search *s)
{
    if (s->config->surrogate == SURROGATE_OFF && !s->problem->is_noisy)
        return;
    Archive *a = &s->archive;
    const Population *p = &s->population;
    pareto_archive_list_front(a);
    for (size_t i = 0; i < p->n; i++)
        s->scratch.members[i] = i;
    for (int k = 0; k < INFILL_KINDS; k++)
        if (s->screening.n_front > 0)
            infill_measure(s->criteria.select[k], s->screening.n_front, s->screening.front, a->estimate);
        else if (a->n_front > 0)
            infill_measure(s->criteria.select[k], a->n_front, a->front, a->estimate);
        else
            infill_measure(s->criteria.select[k], p->n, s->scratch.members, p->F);
}

int search_uses_surrogate(const Search *s)
{
    return s->config->surrogate == SURROGATE_ON && surrogate_is_usable(s->surrogate) && control_agrees(&s->control);
}

void search_predict(Search *s, Population *p, size_t first, int with_uncertainty)
{
    const double before = search_seconds(s);
    surrogate_predict(s->surrogate, p, first, with_uncertainty);
    s->surrogate_s += search_seconds(s) - before;
}

void search_descend(Search *s, InfillKind kind, size_t n, const size_t vectors[], double X[])
{
    const double before = search_seconds(s);
    surrogate_descend(s->surrogate, &s->archive, s->criteria.select[kind], n, vectors, X);
    s->surrogate_s += search_seconds(s) - before;
}

/* Where the noise is significant: the front to be improved and the parents, as the surrogate corrects them. */
static void take_estimates(Search *s)
{
    Archive *a = &s->archive;
    Population *p = &s->population;
    if (!replication_noise_is_significant(s))
        return;
    surrogate_estimate(s->surrogate, a);
    measure_front(s);
    for (size_t i = 0; i < p->n; i++)
        memcpy(p->F + i * p->n_obj, a->estimate + p->row[i] * a->n_obj, a->n_obj * sizeof *a->estimate);
}

static Status fit_surrogate(Search *s, Err *err)
{
    const double before = search_seconds(s);
    if (s->config->surrogate == SURROGATE_ON)
        TRY(surrogate_fit(s->surrogate, &s->archive, s->criteria.select[INFILL_PBI], err));
    else
        surrogate_drop(s->surrogate);
    s->surrogate_s += search_seconds(s) - before;
    take_estimates(s);
    return STATUS_OK;
}

/* -- step 6: control ----------------------------------------------------------------------------------------------- */

static void judge_batch(Search *s)
{
    if (s->config->surrogate == SURROGATE_OFF)
        return;
    const Batch *b = &s->batch;
    const BatchResults results = {.n = b->n,
                                  .n_obj = s->problem->n_obj,
                                  .F = b->F,
                                  .predicted = b->predicted,
                                  .range = surrogate_ranges(s->surrogate),
                                  .ok = b->ok,
                                  .kind = b->kind,
                                  .is_probe = b->is_probe,
                                  .was_predicted = b->was_predicted};
    control_judge(&s->control, &results);
}

/* -- step 7: environmental selection ------------------------------------------------------------------------------- */

/* As the archive has the member now: a replicate may have changed it, or have failed. */
static void append_evaluated(const Search *s, Population *to, const Population *from, size_t i)
{
    const Archive *a = &s->archive;
    const size_t row = from->row[i];
    if (!a->usable[row])
        return;
    population_append(to, from, i);
    memcpy(to->F + (to->n - 1) * a->n_obj, a->estimate + row * a->n_obj, a->n_obj * sizeof *a->estimate);
    to->violation[to->n - 1] = a->violation[row];
}

/* Next population: from the members of the present one and the results. */
static void renew_population(Search *s, size_t first_new)
{
    Population *population = &s->population, *pool = &s->pool;
    pool->n = 0;
    for (size_t i = 0; i < population->n; i++)
        append_evaluated(s, pool, population, i);
    batch_join(s, pool, first_new);
    offspring_survive(s, pool, 0);
    population_copy(population, pool);
}

/* -- a generation: the steps of search.h --------------------------------------------------------------------------- */

/* Replicates alone, at the end of a search whose evaluations are noisy. */
static Status replicate_generation(Search *s, size_t n, Err *err)
{
    const size_t first_new = s->archive.n;
    surrogate_drop(s->surrogate);
    TRY(batch_evaluate(s, 0, n, err));
    renew_population(s, first_new);
    return STATUS_OK;
}

Status generation_next(Search *s, Err *err)
{
    const size_t first_new = s->archive.n;
    if (s->population.n < 2)
        return sample_again(s, err);
    pareto_archive_reset_estimates(&s->archive);
    measure_front(s);
    size_t n_last = replication_last(s);
    TRY(screening_last(s, &n_last, err));
    if (n_last > 0)
        return replicate_generation(s, n_last, err);
    TRY(fit_surrogate(s, err));              /* 2 */
    offspring_make(s, 0);                    /* 3 */
    const size_t n = infill_select_batch(s); /* 4 */
    if (n == 0 && queue_pending(s->queue) == 0)
        return sample_again(s, err);
    size_t n_all = replication_add(s, n);
    TRY(screening_finish(s, &n_all, err));
    TRY(batch_evaluate(s, n, n_all, err)); /* 5 */
    judge_batch(s);                        /* 6 */
    renew_population(s, first_new);        /* 7 */
    return STATUS_OK;
}

Status generation_last(Search *s, Err *err)
{
    const size_t first_new = s->archive.n;
    pareto_archive_reset_estimates(&s->archive);
    TRY(batch_finish(s, err));
    renew_population(s, first_new);
    return STATUS_OK;
}
