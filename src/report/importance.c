#include "report/importance.h"

#include "base/carve.h"
#include "base/random.h"
#include "rbf/rbf.h"

/* PREDICTIONS: of all samples together; they take about a second for 20 floors and seven objectives. */
enum { CENTRES = 300, PREDICTIONS = 12000, SAMPLES_MIN = 32, SAMPLES_MAX = 512 };

typedef struct {
    const Run *run;
    size_t n, n_var, n_obj, n_samples;
    size_t *row;        /* (n) */
    double *low, *span; /* (n_var) */
    double *U, *F;      /* (n, n_var) on the unit cube, (n, n_obj) */
    double *A, *B, *X;  /* (n_samples, n_var) */
    double *fa, *fx;    /* (n_samples, n_obj) */
    void *store;
} Sobol;

static void layout(void *sobol, Carve *c)
{
    Sobol *s = sobol;
    CARVE(c, s->row, s->n);
    CARVE(c, s->low, s->n_var);
    CARVE(c, s->span, s->n_var);
    CARVE(c, s->U, s->n * s->n_var);
    CARVE(c, s->F, s->n * s->n_obj);
    CARVE(c, s->A, s->n_samples * s->n_var);
    CARVE(c, s->B, s->n_samples * s->n_var);
    CARVE(c, s->X, s->n_samples * s->n_var);
    CARVE(c, s->fa, s->n_samples * s->n_obj);
    CARVE(c, s->fx, s->n_samples * s->n_obj);
}

/* A design that the interpolant can learn from; repeats of one have the same x. */
static int is_known(const Run *run, size_t row)
{
    const Evaluation *e = &run->table.row[row];
    int known =
        e->outcome == OUTCOME_OK && e->kind != KIND_UNFINISHED && e->kind != KIND_REPEAT && e->kind != KIND_SCREENED;
    for (size_t k = 0; k < run->schema.n_obj; k++)
        known = known && isfinite(run_f(run, row)[k]);
    return known;
}

/* s->n of `known` designs, evenly spread, in the box of all of them. */
static void take_designs(Sobol *s, size_t known)
{
    const Run *run = s->run;
    for (size_t j = 0; j < s->n_var; j++) {
        s->low[j] = INFINITY;
        s->span[j] = -INFINITY;
    }
    for (size_t i = 0, seen = 0, taken = 0; i < run->table.n; i++) {
        if (!is_known(run, i))
            continue;
        for (size_t j = 0; j < s->n_var; j++) {
            s->low[j] = fmin(s->low[j], run_x(run, i)[j]);
            s->span[j] = fmax(s->span[j], run_x(run, i)[j]);
        }
        if (taken < s->n && seen++ * s->n / known >= taken)
            s->row[taken++] = i;
    }
    for (size_t j = 0; j < s->n_var; j++)
        s->span[j] = s->span[j] > s->low[j] ? s->span[j] - s->low[j] : 1;
    for (size_t i = 0; i < s->n; i++) {
        for (size_t j = 0; j < s->n_var; j++)
            s->U[i * s->n_var + j] = (run_x(run, s->row[i])[j] - s->low[j]) / s->span[j];
        memcpy(s->F + i * s->n_obj, run_f(run, s->row[i]), s->n_obj * sizeof(double));
    }
}

static double variance(const Sobol *s, size_t k)
{
    const double n = (double)s->n_samples;
    double mean = 0, square = 0;
    for (size_t i = k; i < s->n_samples * s->n_obj; i += s->n_obj)
        mean += s->fa[i] / n;
    for (size_t i = k; i < s->n_samples * s->n_obj; i += s->n_obj)
        square += pow(s->fa[i] - mean, 2) / n;
    return square;
}

static Status find(Sobol *s, size_t known, Importance *out, Err *err)
{
    const size_t n = s->n_samples;
    Rbf *m;
    TRY(rbf_create(&m, s->n, s->n_var, s->n_obj, err));
    take_designs(s, known);
    const Status status = rbf_tune(m, s->n, s->U, s->F, NULL, err);
    if (status != STATUS_OK) {
        free(m);
        return status;
    }
    out->n_centres = s->n;
    for (size_t k = 0; k < s->n_obj; k++)
        out->explained[k] = rbf_explained(m, k);

    /* The indices, by samples of the interpolant. */
    Random r = random_stream(1, RANDOM_IMPORTANCE, 0, 0);
    for (size_t i = 0; i < n * s->n_var; i++) {
        s->A[i] = random_uniform(&r);
        s->B[i] = random_uniform(&r);
    }
    rbf_eval(m, n, s->A, s->fa, NULL);
    for (size_t j = 0; j < s->n_var; j++) {
        memcpy(s->X, s->A, n * s->n_var * sizeof(double));
        for (size_t i = 0; i < n; i++)
            s->X[i * s->n_var + j] = s->B[i * s->n_var + j];
        rbf_eval(m, n, s->X, s->fx, NULL);
        for (size_t k = 0; k < s->n_obj; k++) {
            double sum = 0;
            for (size_t i = k; i < n * s->n_obj; i += s->n_obj)
                sum += pow(s->fa[i] - s->fx[i], 2);
            out->total[k * s->n_var + j] = sum / (2 * (double)n * variance(s, k));
        }
    }
    free(m);
    return STATUS_OK;
}

Status importance_of(const Run *run, Importance *out, Err *err)
{
    const size_t n_var = run->schema.n_var, n_obj = run->schema.n_obj;
    size_t known = 0;
    for (size_t i = 0; i < run->table.n; i++)
        known += is_known(run, i);
    const size_t samples = PREDICTIONS / (n_var + 1);
    Sobol s = {.run = run,
               .n = MIN_OF(known, CENTRES),
               .n_var = n_var,
               .n_obj = n_obj,
               .n_samples = MIN_OF(MAX_OF(samples, SAMPLES_MIN), SAMPLES_MAX)};
    *out = (Importance){0};
    if (known < n_var + 2 || n_var > RBF_DIM_MAX)
        return STATUS_OK;
    s.store = carve_all(layout, &s);
    out->explained = calloc(n_obj, sizeof(double));
    out->total = calloc(n_obj * n_var, sizeof(double));
    Status status = s.store && out->explained && out->total
                        ? find(&s, known, out, err)
                        : fail(err, STATUS_NO_MEMORY, "no memory for the importance of %zu variables", n_var);
    free(s.store);
    if (status != STATUS_OK)
        importance_free(out);
    return status;
}

void importance_free(Importance *m)
{
    free(m->explained);
    free(m->total);
    *m = (Importance){0};
}
