#include "moga/state.h"

#include <math.h>

#include "moga/dominance.h"
#include "moga/variation.h"

/* Distribution indices: Deb and Jain 2014. */
static const double SBX_ETA = 20.0, MUTATION_ETA = 20.0;

void offspring_survive(Search *s, Population *p, uint32_t step)
{
    Random random = random_stream(s->config->seed, RANDOM_NICHING, (uint32_t)s->generation, step);
    size_t *survivors = s->scratch.survivors;
    const size_t n =
        selection_select(s->selection, p->n, p->F, p->violation, s->config->population, &random, survivors);
    population_keep(p, n, survivors);
}

/* -- variation ----------------------------------------------------------------------------------------------------- */

static const double *tournament(const Population *p, Random *random)
{
    const size_t a = random_below(random, p->n), b = random_below(random, p->n), m = p->n_obj;
    const int b_wins = dominates_constrained(m, p->F + b * m, p->violation[b], p->F + a * m, p->violation[a]);
    return p->X + (b_wins ? b : a) * p->n_var;
}

/* Appends n children of the present members; a share of the pairs is mutated over the whole box. Pair j of step has
 * its own streams. */
static void breed(Search *s, Population *population, size_t n, uint32_t step, double far)
{
    const Problem *p = s->problem;
    const SearchConfig *c = s->config;
    const Population parents = *population;
    double *children = s->scratch.children;
    for (size_t j = 0; 2 * j < n; j++) {
        const uint32_t name = step * (uint32_t)c->population + (uint32_t)j;
        Random choice = random_stream(c->seed, RANDOM_PARENTS, (uint32_t)s->generation, name);
        Random change = random_stream(c->seed, RANDOM_VARIATION, (uint32_t)s->generation, name);
        const double *mother = tournament(&parents, &choice), *father = tournament(&parents, &choice);
        const double eta = (double)j + 0.5 < far * (double)n / 2.0 ? 0.0 : MUTATION_ETA;
        crossover_sbx(&change, p->n_var, p->lower, p->upper, SBX_ETA, mother, father, children, children + p->n_var);
        for (size_t i = 0; i < 2 && 2 * j + i < n; i++) {
            double *x = children + i * p->n_var;
            mutate_polynomial(&change, p->n_var, p->lower, p->upper, 1.0 / (double)p->n_var, eta, x);
            problem_repair(p, x);
            population_add(population, x);
        }
    }
}

/* Of n children of the population. */
static void add_variation(Search *s, size_t n)
{
    Population *offspring = &s->offspring.members;
    const size_t n_parents = s->population.n, first = offspring->n;
    population_copy(&s->pool, &s->population);
    breed(s, &s->pool, n, 0, 0.0);
    for (size_t i = n_parents; i < s->pool.n; i++)
        population_append(offspring, &s->pool, i);
    s->offspring.n_variation = n;
    search_predict(s, offspring, first, 1);
}

/* -- on the surrogate ---------------------------------------------------------------------------------------------- */

/* What survives some generations of variation and selection on the surrogate and is not evaluated. */
static void add_evolved(Search *s)
{
    population_copy(&s->pool, &s->population);
    for (uint32_t step = 0; step < INNER_GENERATIONS; step++) {
        const size_t n_parents = s->pool.n;
        breed(s, &s->pool, s->config->population, step, surrogate_waves(s->surrogate));
        search_predict(s, &s->pool, n_parents, 0);
        offspring_survive(s, &s->pool, 1 + step);
    }
    for (size_t i = 0; i < s->pool.n; i++)
        if (s->pool.row[i] == PREDICTED)
            population_append(&s->offspring.members, &s->pool, i);
}

/* Descents along reference vectors that are drawn anew in each generation, as many as the population at most; the
 * criteria share them. */
static void add_descended(Search *s)
{
    const Problem *p = s->problem;
    const size_t n_vectors = s->criteria.vectors.n, two_each = DESCENTS_PER_DESIGN * batch_size(s),
                 wanted = two_each < s->config->population ? two_each : s->config->population,
                 n = wanted < n_vectors ? wanted : n_vectors, first = n / 2;
    size_t *vector = s->scratch.descent_vector;
    double *X = s->scratch.descent_X;
    Random random = random_stream(s->config->seed, RANDOM_DESCENT, (uint32_t)s->generation, 0);
    for (size_t r = 0; r < n_vectors; r++)
        vector[r] = r;
    random_shuffle(&random, n_vectors, vector);
    search_descend(s, INFILL_HYPERVOLUME, first, vector, X);
    search_descend(s, INFILL_PBI, n - first, vector + first, X + first * p->n_var);
    for (size_t i = 0; i < n; i++) {
        problem_repair(p, X + i * p->n_var);
        population_add(&s->offspring.members, X + i * p->n_var);
    }
}

/* Designs of the front with one variable elsewhere. Variable by variable the values are spread over the box by the
 * golden section: n of them leave no gap longer than 2.2 / n, wherever the search has gathered. As far as objectives
 * have waves. Their number is rounded at random, or a small share would never come to a whole one. */
static void add_probes(Search *s)
{
    const Problem *p = s->problem;
    Offspring *o = &s->offspring;
    static const double GOLDEN = 0.61803398874989485;
    const double wanted = s->archive.n_front == 0 ? 0.0 : surrogate_waves(s->surrogate);
    Random random = random_stream(s->config->seed, RANDOM_PROBES, (uint32_t)s->generation, 0);
    const double share = wanted * control_probe_share(&s->control);
    const size_t first = o->members.n, n = (size_t)(share * (double)batch_size(s) + random_uniform(&random));
    for (size_t i = 0; i < n; i++, s->n_probed++) {
        const size_t d = s->n_probed % p->n_var, vector = random_below(&random, s->criteria.vectors.n);
        const Infill *near = s->criteria.select[i % INFILL_KINDS];
        const double place = GOLDEN * (double)(s->n_probed / p->n_var) + M_SQRT2 * (double)d;
        double *x = s->scratch.children;
        memcpy(x, s->archive.X + infill_best(near, vector) * p->n_var, p->n_var * sizeof *x);
        x[d] = p->lower[d] + (place - floor(place)) * (p->upper[d] - p->lower[d]);
        problem_repair(p, x);
        population_add(&o->members, x);
    }
    o->n_probes = n;
    search_predict(s, &o->members, first, 1);
}

/* Designs that are asked for already, predicted. */
static void add_pending(Search *s)
{
    Offspring *o = &s->offspring;
    const size_t first = o->members.n, max = s->batch.n_max, n = queue_pending(s->queue);
    o->n_pending = n < max ? n : max;
    for (size_t i = 0; i < o->n_pending; i++)
        population_add(&o->members, queue_design(s->queue, i).x);
    search_predict(s, &o->members, first, 1);
}

void offspring_make(Search *s, int variation_alone)
{
    Offspring *o = &s->offspring;
    const int with_surrogate = search_uses_surrogate(s) && !variation_alone;
    const size_t all = s->config->population, few = batch_size(s);
    o->members.n = o->n_probes = 0;
    if (with_surrogate) {
        add_evolved(s);
        if (search_has_front(s))
            add_descended(s);
        search_predict(s, &o->members, 0, 1);
        add_probes(s);
    }
    add_variation(s, variation_alone ? all : !with_surrogate ? few : control_variation(&s->control, few) > 0 ? all : 0);
    add_pending(s);
}
