#include "moga/offspring.h"

#include "base/dominance.h"
#include "moga/variation.h"

/* Distribution indices: Deb and Jain 2014. */
static const double SBX_ETA = 20.0, MUTATION_ETA = 20.0;

static Random stream(const Common *c, RandomPurpose purpose, uint32_t name)
{
    return random_stream(c->config->seed, purpose, (uint32_t)c->generation, name);
}

void offspring_survive(Offspring *o, const Breeding *w, Population *p, uint32_t step)
{
    Random random = stream(w->common, RANDOM_NICHING, step);
    const size_t n =
        selection_select(w->selection, p->n, p->F, p->violation, w->common->config->population, &random, o->survivors);
    population_keep(p, n, o->survivors);
}

/* -- variation ----------------------------------------------------------------------------------------------------- */

static const double *tournament(const Population *p, Random *random)
{
    const size_t a = random_below(random, p->n), b = random_below(random, p->n), m = p->n_obj;
    const int b_wins = dominates_constrained(m, p->F + b * m, p->violation[b], p->F + a * m, p->violation[a]);
    return p->X + (b_wins ? b : a) * p->n_var;
}

/* To the scale on which variables are varied, and back. */
static void to_scale(const Problem *p, const double x[], double y[])
{
    for (size_t d = 0; d < p->n_var; d++)
        y[d] = problem_kind(p, d) == VARIABLE_LOG ? log(x[d]) : x[d];
}

static void from_scale(const Problem *p, double x[])
{
    for (size_t d = 0; d < p->n_var; d++)
        if (problem_kind(p, d) == VARIABLE_LOG)
            x[d] = fmin(fmax(exp(x[d]), p->lower[d]), p->upper[d]);
}

/* Two children of mother and father, pair j. */
static void breed_pair(const Offspring *o, const Problem *p, size_t j, Random *r, const double mother[],
                       const double father[])
{
    const size_t n = p->n_var;
    const double *lower = o->scaled, *upper = lower + n;
    double *child = o->children + 2 * j * n, *parent = o->scaled + (2 + 3 * j) * n, *before = parent + 2 * n;
    to_scale(p, mother, parent);
    to_scale(p, father, parent + n);
    crossover_sbx(r, n, lower, upper, SBX_ETA, parent, parent + n, child, child + n);
    cross_choices(r, p, mother, father, child, child + n);
    for (int i = 0; i < 2; i++, child += n) {
        memcpy(before, child, n * sizeof *child);
        mutate_polynomial(r, n, lower, upper, 1.0 / (double)n, MUTATION_ETA, child);
        mutate_discrete(r, p, before, child);
        from_scale(p, child);
    }
}

/* Appends a population of children of the present members. Pair j of step has its own streams. */
static void breed(Offspring *o, const Common *c, Population *population, uint32_t step)
{
    const Problem *p = c->problem;
    const Population parents = *population;
    const size_t n = c->config->population;
    to_scale(p, p->lower, o->scaled);
    to_scale(p, p->upper, o->scaled + p->n_var);
#pragma omp parallel for schedule(static)
    for (size_t j = 0; j < (n + 1) / 2; j++) {
        const uint32_t name = step * (uint32_t)n + (uint32_t)j;
        Random choice = stream(c, RANDOM_PARENTS, name), change = stream(c, RANDOM_VARIATION, name);
        const double *mother = tournament(&parents, &choice), *father = tournament(&parents, &choice);
        breed_pair(o, p, j, &change, mother, father);
    }
    for (size_t i = 0; i < n; i++) {
        double *x = o->children + i * p->n_var;
        problem_repair(p, x);
        population_add(population, x);
    }
}

static void append_predicted(Offspring *o)
{
    for (size_t i = 0; i < o->pool.n; i++)
        if (o->pool.row[i] == PREDICTED)
            population_append(&o->members, &o->pool, i);
}

static void add_variation(Offspring *o, const Breeding *w)
{
    population_copy(&o->pool, w->population);
    breed(o, w->common, &o->pool, 0);
    append_predicted(o);
    o->n_unpicked = o->members.n;
}

/* -- on the surrogate ---------------------------------------------------------------------------------------------- */

/* What survives some generations of variation and selection on the surrogate and is not evaluated. */
static void add_evolved(Offspring *o, const Breeding *w)
{
    population_copy(&o->pool, w->population);
    for (uint32_t step = 0; step < INNER_GENERATIONS; step++) {
        const size_t n_parents = o->pool.n;
        breed(o, w->common, &o->pool, step);
        surrogate_predict(w->surrogate, &o->pool, n_parents, 0);
        offspring_survive(o, w, &o->pool, 1 + step);
    }
    append_predicted(o);
}

/* Beside the end of a descent, which moves no choice and whole numbers as if they were real: designs with one of those
 * elsewhere, a whole number one more or less. SWAPS variables, from any one on. */
static void add_swaps(Offspring *o, const Problem *p, Random *r, const double x[])
{
    double *y = o->children;
    const size_t first = random_below(r, p->n_var);
    int n = 0;
    for (size_t i = 0; i < p->n_var && n < SWAPS; i++) {
        const size_t d = (first + i) % p->n_var;
        if (!problem_is_discrete(p, d) || !(p->upper[d] > p->lower[d]))
            continue;
        step_discrete(r, p, d, x, y);
        population_add(&o->members, y);
        n++;
    }
}

/* The next n reference vectors: all of them in turn, each time in another order, so that those of designs under way
 * are not dealt once more. */
static void deal_vectors(Offspring *o, const Common *c, size_t n_vectors, size_t n)
{
    size_t *deck = o->descent_vector + n_vectors;
    for (size_t i = 0; n_vectors > 0 && i < n; i++, o->n_dealt++) {
        const size_t at = o->n_dealt % n_vectors;
        if (i == 0 || at == 0) {
            Random random = random_stream(c->config->seed, RANDOM_DESCENT, (uint32_t)(o->n_dealt / n_vectors), 1);
            for (size_t r = 0; r < n_vectors; r++)
                deck[r] = r;
            random_shuffle(&random, n_vectors, deck);
        }
        o->descent_vector[i] = deck[at];
    }
}

/* Of a group, all but one design or that one. */
static double part_of_hypervolume(const Breeding *w)
{
    const size_t size = batch_size(w->common);
    const double one = 1.0 / (double)MAX_OF(size, 2);
    return credit_prefers_first(&w->criteria->credit) ? one : 1.0 - one;
}

/* Descents along reference vectors, as many as the population at most; the criteria share them. */
static void add_descended(Offspring *o, const Breeding *w)
{
    const Common *c = w->common;
    const Problem *p = c->problem;
    const size_t n_vectors = w->criteria->vectors.n, two_each = DESCENTS_PER_DESIGN * batch_size(c),
                 wanted = MIN_OF(two_each, c->config->population), n = MIN_OF(wanted, n_vectors),
                 first = (size_t)(part_of_hypervolume(w) * (double)n);
    size_t *vector = o->descent_vector;
    double *X = o->descent_X;
    Random random = stream(c, RANDOM_DESCENT, 0);
    deal_vectors(o, c, n_vectors, n);
    surrogate_descend(w->surrogate, &c->archive, w->criteria->select, first, n, vector, X);
    for (size_t i = 0; i < n; i++) {
        problem_repair(p, X + i * p->n_var);
        population_add(&o->members, X + i * p->n_var);
        if (p->kind)
            add_swaps(o, p, &random, X + i * p->n_var);
    }
}

/* Designs of the front with one variable anywhere else, as far as objectives have waves. Their number is rounded at
 * random, or a small share would never come to a whole one. */
static void add_probes(Offspring *o, const Breeding *w)
{
    const Common *c = w->common;
    const Problem *p = c->problem;
    const double share = c->archive.n_front == 0 ? 0.0 : PROBE_SHARE * surrogate_waves(w->surrogate);
    Random random = stream(c, RANDOM_PROBES, 0);
    o->n_unpicked = (size_t)(share * (double)batch_size(c) + random_uniform(&random));
    for (size_t i = 0; i < o->n_unpicked; i++) {
        const size_t d = random_below(&random, p->n_var), vector = random_below(&random, w->criteria->vectors.n);
        double *x = o->children;
        memcpy(x, c->archive.X + infill_best(w->criteria->select[i % INFILL_KINDS], vector) * p->n_var,
               p->n_var * sizeof *x);
        x[d] = problem_spread(p, d, random_uniform(&random));
        problem_repair(p, x);
        population_add(&o->members, x);
    }
}

/* Designs that are asked for already, predicted. */
static void add_pending(Offspring *o, const Common *c)
{
    o->n_pending = MIN_OF(c->pending.n, o->pending_max);
    for (size_t i = 0; i < o->n_pending; i++)
        population_add(&o->members, pending_x(&c->pending, i));
}

void offspring_make(Offspring *o, const Breeding *w)
{
    o->members.n = o->n_unpicked = o->n_pending = 0;
    if (!w->with_surrogate) {
        add_variation(o, w);
        return;
    }
    add_evolved(o, w);
    if (w->has_front)
        add_descended(o, w);
    add_probes(o, w);
    add_pending(o, w->common);
    surrogate_predict(w->surrogate, &o->members, 0, 1);
}

/* -- which of them are evaluated ----------------------------------------------------------------------------------- */

/* Candidates are offered to both criteria with lower confidence bounds of their objectives, by which pending designs
 * lower the values to beat: by their mean their neighbours would still gain an error. */
static void offer(Offspring *o, const Breeding *w)
{
    const Population *p = &o->members;
    const size_t first_pending = p->n - o->n_pending;
    for (size_t i = 0; i < p->n * p->n_obj; i++)
        o->bound[i] = p->F[i] - OPTIMISM * p->error[i];
    for (int kind = 0; kind < INFILL_KINDS; kind++) {
        Infill *q = w->criteria->select[kind];
        infill_offer(q, p->n, o->bound, p->violation, p->uncertainty, w->has_front ? p->chance : NULL);
        for (size_t i = first_pending; i < p->n; i++)
            infill_take(q, i);
    }
}

/* Of the first `count` members those with the greatest gain beside what is picked already, by both criteria as they
 * share the group, up to `limit` in it. */
static void pick(Offspring *o, const Breeding *w, Batch *b, size_t limit, size_t count)
{
    const double part = part_of_hypervolume(w), turn = (double)common_asked(w->common) + 0.5;
    memset(o->allowed, 0, o->members.n);
    memset(o->allowed, 1, count);
    while (b->n < limit) {
        const double at = turn + (double)b->n;
        const InfillKind criterion = floor(part * (at + 1.0)) > floor(part * at) ? INFILL_HYPERVOLUME : INFILL_PBI;
        const size_t i = infill_pick(w->criteria->select[criterion], o->allowed);
        if (i == SIZE_MAX)
            break;
        infill_take(w->criteria->select[criterion == INFILL_PBI ? INFILL_HYPERVOLUME : INFILL_PBI], i);
        batch_add(b, w->common, o->members.X + i * o->members.n_var, KIND_INFILL, criterion);
    }
}

void offspring_select(Offspring *o, const Breeding *w, Batch *b)
{
    const size_t size = batch_size(w->common), end = o->members.n - o->n_pending, first = end - o->n_unpicked;
    if (w->with_surrogate) {
        offer(o, w);
        pick(o, w, b, size > o->n_unpicked ? size - o->n_unpicked : 0, first);
    }
    for (size_t i = first; i < end && b->n < size; i++)
        batch_add(b, w->common, o->members.X + i * o->members.n_var, KIND_OFFSPRING, INFILL_KINDS);
}
