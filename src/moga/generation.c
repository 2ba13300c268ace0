#include "moga/state.h"

#include "moga/replication.h"
#include "moga/variation.h"

/* Designs that the search was planned for: where they are screened, more than evaluations. */
static size_t planned(const Search *s)
{
    const SearchConfig *c = s->common.config;
    const Screening *q = &s->screening;
    const size_t evals = c->planned_evals > 0 ? c->planned_evals : c->max_evals, n = SCREENED_PER_FINISHED;
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

/* -- step 5: evaluation, the only way into the archive ------------------------------------------------------------- */

/* Designs from n_new on are in the archive already. */
static Status ask(Search *s, size_t n_new, size_t n, Err *err)
{
    const Problem *p = s->common.problem;
    const Batch *b = &s->batch;
    const EvaluationKind again = s->screening.cost.whole > 1 ? KIND_FINISHED : KIND_REPEAT;
    for (size_t i = 0; i < n; i++) {
        Asked asked = {
            .x = b->X + i * p->n_var, .repeat = b->repeat[i], .kind = i < n_new ? (EvaluationKind)b->kind[i] : again};
        if (asked.kind == KIND_FINISHED)
            asked.cheap_parts = screening_parts(&s->screening, &s->common, asked.x);
        else if (s->screening.is_on) {
            asked.n_parts = p->n_cheap;
            asked.kind = KIND_SCREENED;
        }
        TRY(queue_ask(s->common.queue, &asked, err));
    }
    return STATUS_OK;
}

/* All but the last `pending` of what is asked for. */
static Status take_results(Search *s, size_t pending, Err *err)
{
    Common *c = &s->common;
    Finished done;
    for (size_t n = s->batch.size_max + s->offspring.pending_max; queue_pending(c->queue) > pending && n > 0; n--) {
        TRY(queue_next(c->queue, &done, err));
        TRY(screening_take(&s->screening, c, &done, err));
        const Evaluation *e = done.evaluation;
        const unsigned char ok = e->outcome == OUTCOME_OK;
        TRY(pareto_archive_insert(&c->archive, 1, e->x, done.f, c->problem->n_con > 0 ? done.g : NULL, &ok, e->kind,
                                  c->generation, err));
    }
    pareto_archive_update_noise(&c->archive);
    return screening_update(&s->screening, &c->archive, err);
}

/* Designs that may be pending when the next batch is selected: none in batches; asynchronous, so many that no worker
 * waits meanwhile, but at least one result is taken where no design is new (n = 0). */
static size_t pending_wanted(const Common *c, size_t n)
{
    const size_t workers = c->problem->n_workers, pending = queue_pending(c->queue);
    const int is_last = c->archive.n + pending >= common_end(c) || c->generation >= c->config->generations;
    const size_t max = n == 0 && pending > 0 ? pending - 1 : pending;
    const size_t wanted = workers < 2 || is_last ? 0 : workers + batch_size(c) / LOOK_AHEAD_SHARE;
    return !c->config->asynchronous ? 0 : wanted < max ? wanted : max;
}

/* Asks for n designs and takes the results that come. */
static Status evaluate(Search *s, size_t n_new, size_t n, Err *err)
{
    const double before = search_seconds(s);
    TRY(ask(s, n_new, n, err));
    const Status status = take_results(s, pending_wanted(&s->common, n), err);
    s->waited_s += search_seconds(s) - before;
    return status;
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

static size_t add_samples(Search *s, size_t n, size_t n_samples)
{
    const Problem *p = s->common.problem;
    double *X = s->scratch.samples;
    latin_hypercube(s->common.config->seed, (uint32_t)s->common.generation, n_samples, p->n_var, X, s->scratch.slices);
    for (size_t i = 0; i < n_samples; i++) {
        double *x = X + i * p->n_var;
        for (size_t d = 0; d < p->n_var; d++)
            x[d] = problem_spread(p, d, x[d]);
        problem_repair(p, x);
        n = batch_add(&s->batch, &s->common, n, x, KIND_SAMPLED);
    }
    return n;
}

static size_t add_given(Search *s)
{
    const Problem *p = s->common.problem;
    double *x = s->scratch.given;
    size_t n = 0;
    for (size_t i = 0; i < s->common.config->n_given; i++) {
        for (size_t d = 0; d < p->n_var; d++)
            x[d] = fmin(fmax(s->common.config->given[i * p->n_var + d], p->lower[d]), p->upper[d]);
        problem_repair(p, x);
        n = batch_add(&s->batch, &s->common, n, x, KIND_SAMPLED);
    }
    return n;
}

Status generation_first(Search *s, Err *err)
{
    s->batch.room = screening_room(&s->screening, &s->common, s->batch.size_max);
    const size_t n = add_samples(s, add_given(s), generation_samples(s));
    TRY(evaluate(s, n, n, err));
    renew_population(s, 0);
    return STATUS_OK;
}

/* No parents (every evaluation failed so far) or no new design: another Latin hypercube. */
static Status sample_again(Search *s, Err *err)
{
    s->batch.room = screening_room(&s->screening, &s->common, s->batch.size_max);
    const size_t first = s->common.archive.n, n = add_samples(s, 0, s->common.config->population);
    surrogate_drop(s->surrogate); /* a resumed search has none here either */
    TRY(evaluate(s, n, n, err));
    if (s->population.n < 2)
        join(&s->population, &s->common.archive, first);
    else
        renew_population(s, first);
    return STATUS_OK;
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
    const double before = search_seconds(s);
    if (s->common.config->surrogate == SURROGATE_ON)
        TRY(surrogate_fit(s->surrogate, &s->common.archive, s->criteria.select[INFILL_PBI], err));
    else
        surrogate_drop(s->surrogate);
    s->surrogate_s += search_seconds(s) - before;
    return STATUS_OK;
}

/* -- a generation: the steps of search.h --------------------------------------------------------------------------- */

/* Steps 3 and 4: a batch of offspring; where the surrogate proposes no new design, of children of variation. */
static size_t choose_batch(Search *s)
{
    Breeding w = breeding(s);
    const double before = search_seconds(s);
    offspring_make(&s->offspring, &w);
    s->surrogate_s += w.with_surrogate ? search_seconds(s) - before : 0.0;
    const size_t n = offspring_select(&s->offspring, &w, &s->batch);
    if (n > 0 || !w.with_surrogate)
        return n;
    w.with_surrogate = 0;
    offspring_make(&s->offspring, &w);
    return offspring_select(&s->offspring, &w, &s->batch);
}

Status generation_next(Search *s, Err *err)
{
    Common *c = &s->common;
    const size_t first_new = c->archive.n;
    size_t n_new = 0, n = 0;
    if (s->population.n < 2)
        return sample_again(s, err);
    measure_front(s);
    TRY(screening_last(&s->screening, c, &s->batch, &n, err));
    if (n > 0) {
        surrogate_drop(s->surrogate);
    } else {
        TRY(fit_surrogate(s, err)); /* 2 */
        s->batch.room = screening_room(&s->screening, c, s->batch.size_max);
        n = n_new = choose_batch(s); /* 3, 4 */
        if (n == 0 && queue_pending(c->queue) == 0)
            return sample_again(s, err);
        n = replication_add(c, &s->criteria, &s->batch, n);
        TRY(screening_finish(&s->screening, c, &s->batch, &n, err));
    }
    TRY(evaluate(s, n_new, n, err)); /* 5 */
    renew_population(s, first_new);  /* 6 */
    return STATUS_OK;
}

Status generation_last(Search *s, Err *err)
{
    const size_t first_new = s->common.archive.n;
    queue_withdraw(s->common.queue);
    TRY(take_results(s, 0, err));
    renew_population(s, first_new);
    return STATUS_OK;
}
