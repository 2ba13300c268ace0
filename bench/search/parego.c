/* ParEGO: Knowles, IEEE Trans. Evol. Comput. 10 (2006) 50-66. An augmented Tchebycheff value with a weight drawn for
 * each evaluation is modelled by the program's interpolant (rbf/rbf.h) of at most CENTRES_MAX designs, the best half of
 * them by that value; the design with the greatest expected improvement is next. Standard deviation: the interpolant's
 * local leave-one-out error. Failed and infeasible designs have the worst value. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "bench/search/families.h"
#include "bench/search/methods.h"
#include "moga/directions.h"
#include "moga/variation.h"
#include "rbf/rbf.h"

enum { CENTRES_MAX = 200, TUNE_EVERY = 10, CANDIDATES = 1000, PARENTS = 10, CLIMB = 200 };

typedef struct {
    const Problem *p;
    const Settings *s;
    Course *c;
    Rbf *rbf;
    double *X, *value; /* (n_max, n_var) (n_max) */
    double *U, *F;     /* (CENTRES_MAX, n_var) (CENTRES_MAX) */
    size_t *order;     /* (n_max) by value */
} Parego;

static void scalarise(Parego *q, const double w[])
{
    const Course *c = q->c;
    double worst = 0.0;
    for (size_t i = 0; i < c->n; i++)
        q->value[i] = -1.0;
    for (size_t k = 0; k < c->n_obj; k++) {
        double low = INFINITY, high = -INFINITY;
        for (size_t i = 0; i < c->n; i++)
            if (c->counts[i]) {
                low = fmin(low, c->F[i * c->n_obj + k]);
                high = fmax(high, c->F[i * c->n_obj + k]);
            }
        for (size_t i = 0; i < c->n; i++) {
            const double z = w[k] * (c->F[i * c->n_obj + k] - low) / fmax(high - low, 1e-12);
            q->value[i] = fmax(q->value[i], z) + (k + 1 == c->n_obj ? 0.05 * z : 0.0);
        }
    }
    for (size_t i = 0; i < c->n; i++)
        worst = c->counts[i] ? fmax(worst, q->value[i]) : worst;
    for (size_t i = 0; i < c->n; i++)
        q->value[i] = c->counts[i] ? q->value[i] : worst;
}

static int by_value(const void *a, const void *b, void *value)
{
    const double *v = value, x = v[*(const size_t *)a], y = v[*(const size_t *)b];
    return (x > y) - (x < y);
}

static Status fit(Parego *q, Random *r, Err *err)
{
    const size_t n_var = q->p->n_var, n = q->c->n < CENTRES_MAX ? q->c->n : CENTRES_MAX;
    for (size_t i = 0; i < q->c->n; i++)
        q->order[i] = i;
    qsort_r(q->order, q->c->n, sizeof *q->order, by_value, q->value);
    if (n < q->c->n)
        random_shuffle(r, q->c->n - n / 2, q->order + n / 2);
    for (size_t i = 0; i < n; i++) {
        problem_to_cube(q->p, q->X + q->order[i] * n_var, q->U + i * n_var);
        q->F[i] = q->value[q->order[i]];
    }
    return (q->c->n % TUNE_EVERY == 0 ? rbf_tune : rbf_fit)(q->rbf, n, q->U, q->F, NULL, err);
}

static double improvement(const Parego *q, const double u[])
{
    double f, e;
    rbf_eval(q->rbf, 1, u, &f, &e);
    const double better = q->F[0] - f, z = better / fmax(e, 1e-12);
    return better * 0.5 * erfc(-z / M_SQRT2) + e * exp(-0.5 * z * z) / sqrt(2.0 * M_PI);
}

/* Candidates: uniform ones, and the best designs with some variables moved; then a climb from the best of them. */
static void propose(Parego *q, Random *r, double best[])
{
    const size_t n = q->p->n_var, parents = q->c->n < PARENTS ? q->c->n : PARENTS;
    double u[FAMILY_VAR_MAX], most = -INFINITY;
    for (size_t i = 0; i < CANDIDATES + CLIMB; i++) {
        const double *from = i < CANDIDATES ? q->U + random_below(r, parents) * n : best;
        const double step = i < CANDIDATES ? 0.1 : 0.02;
        for (size_t d = 0; d < n; d++) {
            u[d] = from[d] + (random_uniform(r) < 3.0 / (double)n ? step * random_normal(r) : 0.0);
            u[d] = i % 2 == 0 && i < CANDIDATES ? random_uniform(r) : fmin(fmax(u[d], 0.0), 1.0);
        }
        const double gain = improvement(q, u);
        if (gain > most) {
            most = gain;
            memcpy(best, u, n * sizeof *u);
        }
    }
}

static Status run(Parego *q, size_t slices[], Err *err)
{
    const Problem *p = q->p;
    const uint32_t seed = (uint32_t)q->s->search.seed;
    const size_t first = 4 * p->n_var + 12;
    double f[FAMILY_OBJ_MAX], u[FAMILY_VAR_MAX], w[FAMILY_OBJ_MAX];
    latin_hypercube(seed, 0, first, p->n_var, p->lower, p->upper, q->X, slices);
    for (size_t i = 0; i < first; i++)
        course_evaluate(q->c, p, q->X + i * p->n_var, f, NULL);
    while (q->c->n < q->c->n_max) {
        Random r = random_stream(seed, RANDOM_VARIATION, 1, (uint32_t)q->c->n);
        double sum = 0.0;
        for (size_t k = 0; k < p->n_obj; k++)
            sum += w[k] = -log(1.0 - random_uniform(&r)); /* uniform on the simplex */
        for (size_t k = 0; k < p->n_obj; k++)
            w[k] /= sum;
        scalarise(q, w);
        TRY(fit(q, &r, err));
        propose(q, &r, u);
        problem_from_cube(p, u, q->X + q->c->n * p->n_var);
        course_evaluate(q->c, p, q->X + q->c->n * p->n_var, f, NULL);
    }
    return STATUS_OK;
}

Status run_parego(const Settings *s, const Problem *p, Course *c, Err *err)
{
    Parego q = {.p = p, .s = s, .c = c};
    const size_t n = c->n_max;
    TRY(rbf_create(&q.rbf, CENTRES_MAX, p->n_var, 1, err));
    q.X = calloc((n + CENTRES_MAX) * (p->n_var + 1), sizeof *q.X);
    q.order = calloc(2 * n, sizeof *q.order);
    Status status = q.X && q.order ? STATUS_OK : fail(err, STATUS_NO_MEMORY, "ParEGO: no memory for %zu designs", n);
    if (status == STATUS_OK) {
        q.value = q.X + n * p->n_var;
        q.U = q.value + n;
        q.F = q.U + CENTRES_MAX * p->n_var;
        status = run(&q, q.order + n, err);
    }
    rbf_free(q.rbf);
    free(q.X);
    free(q.order);
    return status;
}
