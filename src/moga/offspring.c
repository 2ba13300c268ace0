#include "moga/offspring.h"

#include "base/dominance.h"
#include "moga/variation.h"

/* Distribution indices: Deb and Jain 2014. */
static const double SBX_ETA = 20.0, MUTATION_ETA = 20.0;

static Random stream(const Common *c, RandomPurpose purpose, uint32_t name)
{
    return random_stream(c->config->seed, purpose, (uint32_t)c->generation, name);
}

void offspring_survive(Offspring *o, const Common *c, Selection *selection, Population *p, uint32_t step)
{
    Random random = stream(c, RANDOM_NICHING, step);
    const size_t n =
        selection_select(selection, p->n, p->F, p->violation, c->config->population, &random, o->survivors);
    population_keep(p, n, o->survivors);
}

/* -- variation ----------------------------------------------------------------------------------------------------- */

static const double *tournament(const Population *p, Random *random)
{
    const size_t a = random_below(random, p->n), b = random_below(random, p->n), m = p->n_obj;
    const int b_wins = dominates_constrained(m, p->F + b * m, p->violation[b], p->F + a * m, p->violation[a]);
    return p->X + (b_wins ? b : a) * p->n_var;
}

/* To the scale on which variables are varied. */
static void to_scale(const Problem *p, const double x[], double y[])
{
    for (size_t d = 0; d < p->n_var; d++)
        y[d] = problem_kind(p, d) == VARIABLE_LOG ? log(x[d]) : x[d];
}

/* Appends a population of children of the present members. Pair j of step has its own streams; what is varied on the
 * scale of its logarithm is between its bounds again afterwards. */
static void breed(Offspring *o, const Common *c, Population *population, uint32_t step)
{
    const Problem *p = c->problem;
    const Population parents = *population;
    const size_t n_var = p->n_var, n = c->config->population;
    const double *lower = o->scaled, *upper = lower + n_var;
    to_scale(p, p->lower, o->scaled);
    to_scale(p, p->upper, o->scaled + n_var);
#pragma omp parallel for schedule(static)
    for (size_t j = 0; j < (n + 1) / 2; j++) {
        const uint32_t name = step * (uint32_t)n + (uint32_t)j;
        Random choice = stream(c, RANDOM_PARENTS, name), change = stream(c, RANDOM_VARIATION, name);
        const double *mother = tournament(&parents, &choice), *father = tournament(&parents, &choice);
        double *child = o->children + 2 * j * n_var, *parent = o->scaled + (2 + 3 * j) * n_var;
        double *before = parent + 2 * n_var;
        to_scale(p, mother, parent);
        to_scale(p, father, parent + n_var);
        crossover_sbx(&change, n_var, lower, upper, SBX_ETA, parent, parent + n_var, child, child + n_var);
        cross_choices(&change, p, mother, father, child, child + n_var);
        for (int i = 0; i < 2; i++, child += n_var) {
            copy_values(n_var, child, before);
            mutate_polynomial(&change, n_var, lower, upper, 1.0 / (double)n_var, MUTATION_ETA, child);
            mutate_discrete(&change, p, before, child);
            for (size_t d = 0; d < n_var; d++)
                if (problem_kind(p, d) == VARIABLE_LOG)
                    child[d] = exp(child[d]);
        }
    }
    for (size_t i = 0; i < n; i++) {
        double *x = o->children + i * n_var;
        problem_repair(p, x);
        population_add(population, x);
    }
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

/* Of a group, all but one design or that one; half of it where luck would be taken for gain. */
static double part_of_hypervolume(const Breeding *w)
{
    const size_t size = batch_size(w->common);
    const double one = w->common->problem->is_noisy ? 0.5 : 1.0 / (double)MAX_OF(size, 2);
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
    size_t *vector = o->descent_vector, *deck = vector + n_vectors;
    double *X = o->descent_X;
    Random random = stream(c, RANDOM_DESCENT, 0);

    /* 1. The next vectors: all of them in turn, each time in another order, so that those of designs under way are not
     * dealt once more. */
    for (size_t i = 0; i < n && n_vectors > 0; i++, o->n_dealt++) {
        const size_t at = o->n_dealt % n_vectors;
        if (i == 0 || at == 0) {
            Random order = random_stream(c->config->seed, RANDOM_DESCENT, (uint32_t)(o->n_dealt / n_vectors), 1);
            for (size_t r = 0; r < n_vectors; r++)
                deck[r] = r;
            random_shuffle(&order, n_vectors, deck);
        }
        vector[i] = deck[at];
    }

    /* 2. The ends of the descents. */
    surrogate_descend(w->surrogate, &c->archive, w->criteria->select, first, n, vector, X);
    for (size_t i = 0; i < n; i++) {
        double *x = X + i * p->n_var;
        problem_repair(p, x);
        population_add(&o->members, x);
        if (p->kind)
            add_swaps(o, p, &random, x);
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
        copy_values(p->n_var, c->archive.X + infill_best(w->criteria->select[i % INFILL_KINDS], vector) * p->n_var, x);
        x[d] = problem_spread(p, d, random_uniform(&random));
        problem_repair(p, x);
        population_add(&o->members, x);
    }
}

/* Candidates: children of variation, or what the surrogate proposes. */
static void make(Offspring *o, const Breeding *w)
{
    const Common *c = w->common;
    o->members.n = o->n_unpicked = o->n_pending = 0;

    /* 1. Children of the population; on the surrogate what survives some generations of variation and selection. */
    population_copy(&o->pool, w->population);
    for (uint32_t step = 0; step < INNER_GENERATIONS; step++) {
        const size_t n_parents = o->pool.n;
        breed(o, c, &o->pool, step);
        if (!w->with_surrogate)
            break;
        surrogate_predict(w->surrogate, &o->pool, n_parents, 0);
        offspring_survive(o, c, w->selection, &o->pool, 1 + step);
    }
    for (size_t i = 0; i < o->pool.n; i++)
        if (o->pool.row[i] == PREDICTED)
            population_append(&o->members, &o->pool, i);
    if (!w->with_surrogate) {
        o->n_unpicked = o->members.n;
        return;
    }

    /* 2. Descents, probes, and designs that are asked for already, predicted. */
    if (w->has_front)
        add_descended(o, w);
    add_probes(o, w);
    o->n_pending = MIN_OF(c->pending.n, o->pending_max);
    for (size_t i = 0; i < o->n_pending; i++)
        population_add(&o->members, pending_x(&c->pending, i));
    surrogate_predict(w->surrogate, &o->members, 0, 1);
}

/* -- which of them are evaluated ----------------------------------------------------------------------------------- */

/* Candidates are offered to both criteria with lower confidence bounds of their objectives, by which pending designs
 * lower the values to beat: by their mean their neighbours would still gain an error. Of the others but probes those
 * with the greatest gain beside what is picked already are taken, by both criteria as they share the group; then
 * probes. */
void offspring_propose(Offspring *o, const Breeding *w, Batch *b)
{
    make(o, w);
    const Population *p = &o->members;
    Infill *const *select = w->criteria->select;
    const size_t size = batch_size(w->common), end = p->n - o->n_pending, first = end - o->n_unpicked;
    const double part = part_of_hypervolume(w), turn = (double)common_asked(w->common) + 0.5;
    for (size_t k = 0; k < p->n * p->n_obj; k++)
        o->bound[k] = p->F[k] - OPTIMISM * p->error[k];
    for (int kind = 0; kind < INFILL_KINDS && w->with_surrogate; kind++) {
        infill_offer(select[kind], p->n, o->bound, p->violation, p->uncertainty, w->has_front ? p->chance : NULL);
        for (size_t k = end; k < p->n; k++)
            infill_take(select[kind], k);
    }
    memset(o->allowed, 0, p->n);
    memset(o->allowed, 1, first);
    while (w->with_surrogate && b->n + o->n_unpicked < size) {
        const double at = turn + (double)b->n;
        const InfillKind criterion = floor(part * (at + 1.0)) > floor(part * at) ? INFILL_HYPERVOLUME : INFILL_PBI;
        const size_t i = infill_pick(select[criterion], o->allowed);
        if (i == SIZE_MAX)
            break;
        infill_take(select[criterion == INFILL_PBI ? INFILL_HYPERVOLUME : INFILL_PBI], i);
        batch_add(b, w->common, p->X + i * p->n_var, KIND_INFILL, criterion);
    }
    for (size_t i = first; i < end && b->n < size; i++)
        batch_add(b, w->common, p->X + i * p->n_var, KIND_OFFSPRING, INFILL_KINDS);
}
