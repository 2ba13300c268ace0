#include "moga/state.h"

#include "moga/replication.h"
#include "moga/variation.h"

/* Designs that the search was planned for: where they are screened, more than evaluations. */
static size_t planned(const Search *s)
{
    const Screening *q = &s->screening;
    const size_t evals = config_budget(s->common.config), n = SCREENED_PER_FINISHED;
    return q->cost.whole == 1 ? evals : evals * n * q->cost.whole / (n * q->cost.cheap + q->cost.rest);
}

/* Enough for a first surrogate of this many variables, and no more than half of the budget. */
static size_t initial_size(const Search *s)
{
    const size_t wanted = INITIAL_PER_VARIABLE * s->common.problem->n_var + INITIAL_OFFSET, half = (planned(s) + 1) / 2;
    if (s->common.config->initial > 0)
        return s->common.config->initial;
    return wanted < half ? wanted : half > 4 ? half : 4;
}

/* What the given designs leave of the initial sample, half of it at least. */
size_t generation_samples(const Search *s)
{
    const size_t initial = initial_size(s), given = s->common.config->n_given;
    return given < initial / 2 ? initial - given : initial - initial / 2;
}

/* -- step 5: evaluation: what is asked, and the answers, the only way into the archive ----------------------------- */

/* How many may be under way when the next group is made: one less than now at most; none of the initial sample, which
 * the first surrogate wants whole, and none where nothing is left to be asked. */
static size_t allowed_now(const Search *s)
{
    const Common *c = &s->common;
    const size_t now = c->pending.n, ahead = common_ahead(c->config, common_asked(c)), most = now > 0 ? now - 1 : 0;
    const int waits_for_all = c->generation == 0 || s->reason != STOP_NONE || screening_room(&s->screening, c, 1) == 0;
    return waits_for_all ? 0 : MIN_OF(ahead, most);
}

/* The batch is asked for. */
static Status ask(Search *s, Err *err)
{
    Common *c = &s->common;
    for (size_t i = 0; i < s->batch.n; i++) {
        Question q = s->batch.q[i];
        q.generation = c->generation;
        if (s->screening.is_on && q.kind != KIND_FINISHED) {
            q.n_parts = c->problem->n_cheap;
            q.kind = KIND_SCREENED;
        }
        TRY(pending_add(&c->pending, &q, err));
    }
    s->allowed = allowed_now(s);
    return STATUS_OK;
}

/* What a result gained, for the criterion that had picked it. */
static void credit(const Search *s, const Place *place, const double f[], CreditResults *results)
{
    const size_t n_obj = s->common.problem->n_obj, by = place->q.criterion;
    if (by == INFILL_KINDS)
        return;
    results->designs[by] += 1.0;
    for (int k = 0; k < INFILL_KINDS && place->ok && violation_of(s->common.problem->n_con, f + n_obj) == 0.0; k++)
        results->gain[k][by] += infill_gain(s->criteria.select[k], f);
}

static Status enter_first(Search *s, CreditResults *results, Err *err)
{
    Common *c = &s->common;
    const Place *place = pending_at(&c->pending, 0);
    const double *x = pending_x(&c->pending, 0), *f = pending_f(&c->pending, 0), *g = f + c->problem->n_obj;
    credit(s, place, f, results);
    TRY(screening_take(&s->screening, c, &(Answer){x, f, g, place->q.kind, place->parts}, err));
    TRY(pareto_archive_insert(&c->archive, 1, x, f, c->problem->n_con > 0 ? g : NULL, &place->ok,
                              (unsigned char)place->q.kind, place->q.generation, err));
    pending_enter(&c->pending);
    return STATUS_OK;
}

/* Evaluated designs of the rows first.. join; failed ones and further replicates do not. */
static void join(Population *p, const Archive *a, size_t first)
{
    for (size_t row = first; row < a->n; row++) {
        if (!a->usable[row])
            continue;
        const size_t i = population_add(p, a->X + row * a->n_var);
        memcpy(p->F + i * a->n_obj, a->F + row * a->n_obj, a->n_obj * sizeof *a->F);
        p->violation[i] = a->violation[row];
        p->row[i] = row;
    }
}

/* -- step 6: environmental selection ------------------------------------------------------------------------------- */

static Breeding breeding(const Search *s)
{
    const Common *c = &s->common;
    return (Breeding){c,
                      &s->population,
                      s->surrogate,
                      &s->criteria,
                      s->selection,
                      c->config->surrogate == SURROGATE_ON && surrogate_is_usable(s->surrogate),
                      c->archive.n_front > 0 || s->screening.n_front > 0};
}

/* As the archive has the member now: a replicate may have changed it, or have failed. */
static void append_evaluated(const Archive *a, Population *to, const Population *from, size_t i)
{
    const size_t row = from->row[i];
    if (!a->usable[row])
        return;
    population_append(to, from, i);
    memcpy(to->F + (to->n - 1) * a->n_obj, a->F + row * a->n_obj, a->n_obj * sizeof *a->F);
    to->violation[to->n - 1] = a->violation[row];
}

/* Next population: from the members of the present one and the results. */
static void renew_population(Search *s, size_t first_new)
{
    const Breeding w = breeding(s);
    Population *population = &s->population, *pool = &s->offspring.pool;
    pool->n = 0;
    for (size_t i = 0; i < population->n; i++)
        append_evaluated(&s->common.archive, pool, population, i);
    join(pool, &s->common.archive, first_new);
    offspring_survive(&s->offspring, &w, pool, 0);
    population_copy(population, pool);
}

/* -- step 1: initial sample ---------------------------------------------------------------------------------------- */

static void add_samples(Search *s, size_t n)
{
    const Problem *p = s->common.problem;
    double *X = s->scratch.samples;
    latin_hypercube(s->common.config->seed, (uint32_t)s->common.generation, n, p->n_var, X, s->scratch.slices);
    for (size_t i = 0; i < n; i++) {
        double *x = X + i * p->n_var;
        for (size_t d = 0; d < p->n_var; d++)
            x[d] = problem_spread(p, d, x[d]);
        problem_repair(p, x);
        batch_add(&s->batch, &s->common, x, KIND_SAMPLED, INFILL_KINDS);
    }
}

static void add_given(Search *s)
{
    const Problem *p = s->common.problem;
    double *x = s->scratch.given;
    for (size_t i = 0; i < s->common.config->n_given; i++) {
        for (size_t d = 0; d < p->n_var; d++)
            x[d] = fmin(fmax(s->common.config->given[i * p->n_var + d], p->lower[d]), p->upper[d]);
        problem_repair(p, x);
        batch_add(&s->batch, &s->common, x, KIND_SAMPLED, INFILL_KINDS);
    }
}

/* No parents (every evaluation failed so far) or no new design: where nothing is under way, another Latin hypercube. */
static void sample_again(Search *s)
{
    if (s->common.pending.n > 0)
        return;
    add_samples(s, s->common.config->population);
    s->n_vain = s->batch.n > 0 ? 0 : s->n_vain + 1;
    surrogate_drop(s->surrogate); /* a resumed search has none here either */
}

/* -- step 2: surrogate --------------------------------------------------------------------------------------------- */

/* The front to be improved; where nothing is feasible yet, the population. Plain search does not look at it, but for
 * the choice of designs to be replicated. */
static void measure_front(Search *s)
{
    if (s->common.config->surrogate == SURROGATE_OFF && !s->common.problem->is_noisy)
        return;
    Archive *a = &s->common.archive;
    const Population *p = &s->population;
    pareto_archive_list_front(a);
    for (size_t i = 0; i < p->n; i++)
        s->scratch.members[i] = i;
    for (int k = 0; k < INFILL_KINDS; k++)
        if (s->screening.n_front > 0)
            infill_measure(s->criteria.select[k], s->screening.n_front, a->expected, a->F);
        else if (a->n_front > 0)
            infill_measure(s->criteria.select[k], a->n_front, a->front, a->F);
        else
            infill_measure(s->criteria.select[k], p->n, s->scratch.members, p->F);
}

static Status fit_surrogate(Search *s, Err *err)
{
    if (s->common.config->surrogate == SURROGATE_ON)
        return surrogate_fit(s->surrogate, &s->common.archive, s->criteria.select[INFILL_PBI], err);
    surrogate_drop(s->surrogate);
    return STATUS_OK;
}

/* -- a generation: the steps of search.h --------------------------------------------------------------------------- */

/* Steps 3 and 4: a batch of offspring; where the surrogate proposes no new design, of children of variation. */
static void choose_batch(Search *s)
{
    Breeding w = breeding(s);
    do {
        offspring_make(&s->offspring, &w);
        offspring_select(&s->offspring, &w, &s->batch);
    } while (s->batch.n == 0 && w.with_surrogate--);
}

/* Where no evaluation is left, designs that were screened may still be finished. */
static Status choose(Search *s, Err *err)
{
    Common *c = &s->common;
    Batch *b = &s->batch;
    measure_front(s);
    TRY(screening_last(&s->screening, c, b, err));
    if (b->n > 0 || b->room == 0) {
        surrogate_drop(s->surrogate);
        return STATUS_OK;
    }
    TRY(fit_surrogate(s, err)); /* 2 */
    choose_batch(s);            /* 3, 4 */
    if (b->n == 0)
        sample_again(s);
    replication_add(c, &s->criteria, b);
    return screening_finish(&s->screening, c, b, err);
}

Status generation_ask(Search *s, Err *err)
{
    s->batch.n = 0;
    s->batch.room = screening_room(&s->screening, &s->common, s->batch.size_max);
    if (s->reason == STOP_NONE && s->common.generation == 0) {
        add_given(s);
        add_samples(s, generation_samples(s));
    } else if (s->reason == STOP_NONE && s->population.n < 2) {
        sample_again(s);
    } else if (s->reason == STOP_NONE) {
        TRY(choose(s, err));
    }
    return ask(s, err); /* 5 */
}

Status generation_enter(Search *s, Err *err)
{
    Common *c = &s->common;
    const size_t first = s->n_before = c->archive.n;
    CreditResults results = {0};
    if (c->config->surrogate == SURROGATE_ON && c->generation > 0 && s->population.n > 0)
        measure_front(s);
    while (c->pending.n > s->allowed)
        TRY(enter_first(s, &results, err));
    credit_learn(&s->criteria.credit, &results);
    pareto_archive_update_noise(&c->archive);
    TRY(screening_update(&s->screening, c, err));
    renew_population(s, first); /* 6 */
    return STATUS_OK;
}
