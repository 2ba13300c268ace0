/* MOEA/D with Tchebycheff values, of differential distances: Zhang and Li, IEEE Trans. Evol. Comput. 11 (2007) 712-731;
 * children replace two neighbours at most: Li and Zhang, IEEE Trans. Evol. Comput. 13 (2009) 284-302. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "bench/search/families.h"
#include "bench/search/methods.h"
#include "moga/directions.h"
#include "moga/variation.h"

enum { NEIGHBOURS = 20, REPLACED_MAX = 2 };

typedef struct {
    const Problem *p;
    const Settings *s;
    Course *c;
    Directions w;
    double *X, *F, *violation; /* (n, n_var) (n, n_obj) (n) */
    size_t *near;              /* (n, NEIGHBOURS) */
    double ideal[FAMILY_OBJ_MAX], nadir[FAMILY_OBJ_MAX];
} Moead;

static void measure_ranges(Moead *q)
{
    const size_t m = q->p->n_obj;
    for (size_t k = 0; k < m; k++) {
        q->nadir[k] = -INFINITY;
        for (size_t i = 0; i < q->w.n; i++)
            if (isfinite(q->violation[i])) {
                q->ideal[k] = fmin(q->ideal[k], q->F[i * m + k]);
                q->nadir[k] = fmax(q->nadir[k], q->F[i * m + k]);
            }
    }
}

static double value_of(const Moead *q, size_t i, const double f[])
{
    double worst = -INFINITY;
    for (size_t k = 0; k < q->p->n_obj; k++)
        worst = fmax(worst, fmax(q->w.W[i * q->p->n_obj + k], 1e-3) * (f[k] - q->ideal[k]) /
                                fmax(q->nadir[k] - q->ideal[k], 1e-12));
    return worst;
}

static int by_distance(const void *a, const void *b, void *distance)
{
    const double *d = distance, x = d[*(const size_t *)a], y = d[*(const size_t *)b];
    return (x > y) - (x < y);
}

static void find_neighbours(Moead *q, size_t order[], double distance[])
{
    const size_t n = q->w.n, m = q->p->n_obj;
    for (size_t i = 0; i < n; i++) {
        for (size_t j = 0; j < n; j++) {
            order[j] = j;
            distance[j] = 0.0;
            for (size_t k = 0; k < m; k++)
                distance[j] += pow(q->w.W[i * m + k] - q->w.W[j * m + k], 2.0);
        }
        qsort_r(order, n, sizeof *order, by_distance, distance);
        memcpy(q->near + i * NEIGHBOURS, order, NEIGHBOURS * sizeof *order);
    }
}

static void replace(Moead *q, size_t i, const double x[], const double f[], double violation)
{
    size_t replaced = 0;
    for (size_t j = 0; j < NEIGHBOURS && replaced < REPLACED_MAX; j++) {
        const size_t at = q->near[i * NEIGHBOURS + j], m = q->p->n_obj;
        const double now = q->violation[at];
        if (violation > now || (violation == now && !(value_of(q, at, f) < value_of(q, at, q->F + at * m))))
            continue;
        memcpy(q->X + at * q->p->n_var, x, q->p->n_var * sizeof *x);
        memcpy(q->F + at * m, f, m * sizeof *f);
        q->violation[at] = violation;
        replaced++;
    }
}

static void breed(Moead *q, size_t i, Random *r)
{
    const Problem *p = q->p;
    double x[2][FAMILY_VAR_MAX], f[FAMILY_OBJ_MAX], violation;
    const size_t a = q->near[i * NEIGHBOURS + random_below(r, NEIGHBOURS)],
                 b = q->near[i * NEIGHBOURS + random_below(r, NEIGHBOURS)];
    crossover_sbx(r, p->n_var, p->lower, p->upper, q->s->search.crossover_probability, q->s->search.crossover_eta,
                  q->X + a * p->n_var, q->X + b * p->n_var, x[0], x[1]);
    mutate_polynomial(r, p->n_var, p->lower, p->upper, q->s->search.mutation_rate / (double)p->n_var,
                      q->s->search.mutation_eta, x[0]);
    if (course_evaluate(q->c, p, x[0], f, &violation)) {
        for (size_t k = 0; k < p->n_obj && isfinite(violation); k++)
            q->ideal[k] = fmin(q->ideal[k], f[k]);
        replace(q, i, x[0], f, violation);
    }
}

static void run(Moead *q, size_t slices[])
{
    const Problem *p = q->p;
    const uint32_t seed = (uint32_t)q->s->search.seed;
    latin_hypercube(seed, 0, q->w.n, p->n_var, p->lower, p->upper, q->X, slices);
    for (size_t k = 0; k < p->n_obj; k++)
        q->ideal[k] = INFINITY;
    for (size_t i = 0; i < q->w.n; i++)
        course_evaluate(q->c, p, q->X + i * p->n_var, q->F + i * p->n_obj, &q->violation[i]);
    for (uint32_t generation = 1; q->c->n < q->c->n_max; generation++) {
        measure_ranges(q);
        for (size_t i = 0; i < q->w.n; i++) {
            Random r = random_stream(seed, RANDOM_VARIATION, generation, (uint32_t)i);
            breed(q, i, &r);
        }
    }
}

Status run_moead(const Settings *s, const Problem *p, Course *c, Err *err)
{
    Moead q = {.p = p, .s = s, .c = c};
    TRY(directions_spread(&q.w, p->n_obj, (size_t)s->search.population, err));
    const size_t n = q.w.n;
    q.X = calloc(n * (p->n_var + p->n_obj + 2), sizeof *q.X);
    q.near = calloc(n * (NEIGHBOURS + 1), sizeof *q.near);
    Status status =
        q.X && q.near && n >= NEIGHBOURS ? STATUS_OK : fail(err, STATUS_NO_MEMORY, "MOEA/D: %zu designs", n);
    if (status == STATUS_OK) {
        q.F = q.X + n * p->n_var;
        q.violation = q.F + n * p->n_obj;
        find_neighbours(&q, q.near + n * NEIGHBOURS, q.violation + n);
        run(&q, q.near + n * NEIGHBOURS);
    }
    directions_free(&q.w);
    free(q.X);
    free(q.near);
    return status;
}
