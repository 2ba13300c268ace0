#include "moga/state.h"

#include "moga/replication.h"
#include "moga/variation.h"

/* Designs of a space that is gone through one by one where chance finds none that is new. */
static const double COUNTED_MAX = 1e6;

/* What the given designs leave of the initial sample, half of it at least. The sample is enough for a first surrogate
 * of this many variables, and no more than half of the designs that the search was planned for: where they are
 * screened, more than evaluations. */
size_t generation_samples(const Search *s)
{
    const SearchConfig *c = s->common.config;
    const LevelCosts cost = s->screening.cost;
    const size_t n = SCREENED_PER_FINISHED, evals = config_budget(c);
    const size_t planned = cost.whole == 1 ? evals : evals * n * cost.whole / (n * cost.cheap + cost.rest);
    const size_t wanted = INITIAL_PER_VARIABLE * s->common.problem->n_var + INITIAL_OFFSET,
                 half = MAX_OF((planned + 1) / 2, 4), initial = c->initial > 0 ? c->initial : MIN_OF(wanted, half);
    return initial - MIN_OF(c->n_given, initial / 2);
}

/* -- step 6: environmental selection ------------------------------------------------------------------------------- */

/* Next population: from the members of the present one, as the archive has them now (a replicate may have changed one,
 * or have failed), and the results; failed ones and further replicates do not join. */
static void renew_population(Search *s, size_t first_new)
{
    const Archive *a = &s->common.archive;
    Population *population = &s->population, *pool = &s->offspring.pool;
    const size_t n_members = population->n;
    pool->n = 0;
    for (size_t i = 0; i < n_members + a->n - first_new; i++) {
        const size_t row = i < n_members ? population->row[i] : first_new + i - n_members;
        if (!a->usable[row])
            continue;
        const size_t last = population_add(pool, a->X + row * a->n_var);
        copy_values(a->n_obj, a->F + row * a->n_obj, pool->F + last * a->n_obj);
        pool->violation[last] = a->violation[row];
        pool->row[last] = row;
    }
    offspring_survive(&s->offspring, &s->common, s->selection, pool, 0);
    population_copy(population, pool);
}

/* -- step 1: initial sample ---------------------------------------------------------------------------------------- */

static void add_sample(Search *s, double x[])
{
    problem_repair(s->common.problem, x);
    batch_add(&s->batch, &s->common, x, KIND_SAMPLED, INFILL_KINDS);
}

static void add_samples(Search *s, size_t n)
{
    const Problem *p = s->common.problem;
    double *X = s->scratch.samples;
    latin_hypercube(s->common.config->seed, (uint32_t)s->common.generation, n, p->n_var, X, s->scratch.slices);
    for (size_t i = 0; i < n; i++) {
        double *x = X + i * p->n_var;
        for (size_t d = 0; d < p->n_var; d++)
            x[d] = problem_spread(p, d, x[d]);
        add_sample(s, x);
    }
}

/* How many values a variable has; INFINITY: any number. */
static double values_of(const Problem *p, size_t d)
{
    if (problem_kind(p, d) == VARIABLE_STEPPED)
        return (double)p->steps[d].n;
    return p->upper[d] > p->lower[d] && !problem_is_discrete(p, d) ? INFINITY : p->upper[d] - p->lower[d] + 1.0;
}

/* All designs that are not known yet, where the space is so small; VAIN_MAX stands for none, unless some are added. */
static void add_rest(Search *s)
{
    const Problem *p = s->common.problem;
    double *x = s->scratch.samples, n = 1.0;
    for (size_t d = 0; d < p->n_var; d++)
        n *= values_of(p, d);
    for (size_t i = 0; n <= COUNTED_MAX && i < (size_t)n && s->batch.n < s->batch.size_max; i++) {
        for (size_t d = 0, rest = i; d < p->n_var; d++) {
            const size_t values = (size_t)values_of(p, d);
            x[d] = problem_spread(p, d, ((double)(rest % values) + 0.5) / (double)values);
            rest /= values;
        }
        add_sample(s, x);
    }
    s->n_vain = n <= COUNTED_MAX ? VAIN_MAX : s->n_vain;
}

/* No parents (every evaluation failed so far) or no new design: where nothing is under way, another Latin hypercube, or
 * what is left of the space. */
static void sample_again(Search *s)
{
    if (s->common.pending.n > 0)
        return;
    add_samples(s, s->common.config->population);
    if (s->batch.n == 0)
        add_rest(s);
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
    const size_t n_expected = s->screening.n_front;
    const size_t *rows = n_expected > 0 ? a->expected : a->n_front > 0 ? a->front : s->scratch.members;
    const size_t n = n_expected > 0 ? n_expected : a->n_front > 0 ? a->n_front : p->n;
    for (int k = 0; k < INFILL_KINDS; k++)
        infill_measure(s->criteria.select[k], n, rows, rows == s->scratch.members ? p->F : a->F);
}

/* -- a generation: the steps of search.h --------------------------------------------------------------------------- */

/* Where no evaluation is left, designs that were screened may still be finished. */
static Status choose(Search *s, Err *err)
{
    Common *c = &s->common;
    Batch *b = &s->batch;
    measure_front(s);
    TRY(screening_last(&s->screening, c, b, 0, err));
    if (b->n > 0 || b->room == 0 || c->config->surrogate == SURROGATE_OFF)
        surrogate_drop(s->surrogate);
    else
        TRY(surrogate_fit(s->surrogate, &c->archive, s->criteria.select[INFILL_PBI], err)); /* 2 */
    if (b->n > 0 || b->room == 0)
        return STATUS_OK;

    /* 3, 4: a batch of offspring; where the surrogate proposes no new design, of children of variation. */
    const int is_usable = c->config->surrogate == SURROGATE_ON && surrogate_is_usable(s->surrogate),
              has_front = c->archive.n_front > 0 || s->screening.n_front > 0;
    Breeding w = {c, &s->population, s->surrogate, &s->criteria, s->selection, is_usable, has_front};
    do
        offspring_propose(&s->offspring, &w, b);
    while (b->n == 0 && w.with_surrogate--);
    if (b->n == 0)
        sample_again(s);
    if (b->n == 0 && c->pending.n == 0 && s->n_vain >= VAIN_MAX)
        return screening_last(&s->screening, c, b, 1, err);
    replication_add(c, &s->criteria, b);
    return screening_finish(&s->screening, c, b, err);
}

Status generation_ask(Search *s, Err *err)
{
    Common *c = &s->common;
    const Problem *p = c->problem;
    const int wants_more = s->reason == STOP_NONE, is_first = wants_more && c->generation == 0;
    s->batch.n = 0;
    s->batch.room = screening_room(&s->screening, c, s->batch.size_max);

    /* 1. The given designs, moved into the box, and the initial sample; later a batch. */
    for (size_t i = 0; is_first && i < c->config->n_given; i++) {
        copy_values(p->n_var, c->config->given + i * p->n_var, s->scratch.samples);
        add_sample(s, s->scratch.samples);
    }
    if (is_first)
        add_samples(s, generation_samples(s));
    else if (wants_more && s->population.n < 2)
        sample_again(s);
    else if (wants_more)
        TRY(choose(s, err));

    /* 2. They are asked for. */
    if (wants_more && c->pending.n == 0 && s->batch.room > 0)
        s->n_vain = s->batch.n > 0 ? 0 : s->n_vain + 1;
    for (size_t i = 0; i < s->batch.n; i++) {
        Question q = s->batch.q[i];
        q.generation = c->generation;
        if (s->screening.is_on && q.kind != KIND_FINISHED) {
            q.n_parts = p->n_cheap;
            q.kind = KIND_SCREENED;
        }
        TRY(pending_add(&c->pending, &q, err));
    }

    /* 3. How many may be under way when the next group is made: one less than now at most, an eighth of the initial
     * sample, but none where it is screened (its line wants both parts) or where nothing is left to be asked. */
    const int is_sample = c->generation == 0, is_last = !wants_more || screening_room(&s->screening, c, 1) == 0;
    const size_t now = c->pending.n, most = is_sample ? now / 8 : now - MIN_OF(now, 1);
    const int waits_for_all = is_last || (is_sample && s->screening.is_on);
    s->allowed = waits_for_all ? 0 : MIN_OF(common_ahead(c, common_asked(c)), most);
    return STATUS_OK;
}

/* Answers enter the archive, here alone; what one gained is credited to the criterion that had picked its design. */
Status generation_enter(Search *s, Err *err)
{
    Common *c = &s->common;
    const size_t first = s->n_before = c->archive.n, n_obj = c->problem->n_obj, n_con = c->problem->n_con;
    CreditResults results = {0};
    if (c->config->surrogate == SURROGATE_ON && c->generation > 0 && s->population.n > 0)
        measure_front(s);
    while (c->pending.n > s->allowed) {
        const Place *place = pending_at(&c->pending, 0);
        const Question *q = &place->q;
        const double *x = pending_x(&c->pending, 0), *f = x + c->problem->n_var;
        const int by = q->criterion, is_good = by < INFILL_KINDS && place->ok && violation_of(n_con, f + n_obj) == 0.0;
        if (by < INFILL_KINDS)
            results.designs[by] += 1.0;
        for (int k = 0; k < INFILL_KINDS && is_good; k++)
            results.gain[k][by] += infill_gain(s->criteria.select[k], f);
        TRY(screening_enter(&s->screening, c, &(Answer){x, f, place->ok, q->kind, q->generation, place->parts}, err));
        pending_enter(&c->pending);
    }
    credit_learn(&s->criteria.credit, &results);
    pareto_archive_update_noise(&c->archive);
    TRY(screening_update(&s->screening, c, err));
    renew_population(s, first); /* 6 */
    return STATUS_OK;
}
