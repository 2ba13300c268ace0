#include "moga/levels.h"

#include "base/carve.h"
#include "moga/surrogate.h"

typedef struct {
    double from, to, slope; /* means, slope between them */
} Line;

struct Levels {
    const Problem *problem;
    size_t n, n_out, n_dim;
    Line *line;    /* (n_out) */
    Rbf *rest;     /* d; NULL: 0 */
    double *U, *D; /* (n, n_dim) (n, n_out) coordinates, what the lines leave */
    double *u, *d; /* (n_dim) (n_out) of a design */
};

static void layout(void *levels, Carve *c)
{
    Levels *q = levels;
    CARVE(c, q->line, q->n_out);
    CARVE(c, q->U, q->n * q->n_dim);
    CARVE(c, q->D, q->n * q->n_out);
    CARVE(c, q->u, q->n_dim);
    CARVE(c, q->d, q->n_out);
}

static double on_line(const Line *line, double cheap)
{
    return line->to + line->slope * (cheap - line->from);
}

Status levels_fit(Levels **out, const Problem *p, int is_biased, size_t n, size_t n_out, const double *const x[],
                  const double cheap[], const double whole[], Err *err)
{
    Levels plain = {.problem = p, .n = n, .n_out = n_out, .n_dim = surrogate_dimension(p)};
    Levels *q = *out = carve_object(layout, &plain, sizeof plain);
    if (!q)
        return fail_memory(err, n, "pairs of levels");
    Status status = STATUS_OK;
    int has_rest = is_biased && q->n_dim <= RBF_DIM_MAX;

    /* 1. The lines. Where squares overflow, or the cheap level is constant beside the whole evaluation: the mean. */
    for (size_t k = 0; k < n_out; k++) {
        Line *line = &q->line[k];
        double xx = 0.0, xy = 0.0;
        for (size_t i = k; i < n * n_out; i += n_out) {
            line->from += cheap[i] / (double)n;
            line->to += whole[i] / (double)n;
        }
        for (size_t i = k; i < n * n_out; i += n_out) {
            const double off = cheap[i] - line->from;
            xx += off * off;
            xy += off * (whole[i] - line->to);
        }
        line->slope = xx > 0.0 ? xy / xx : 1.0;
        if (!isfinite(line->slope))
            line->slope = 0.0;
    }

    /* 2. What they leave. */
    for (size_t i = 0; has_rest && i < n * n_out; i++) {
        q->D[i] = whole[i] - on_line(&q->line[i % n_out], cheap[i]);
        has_rest = isfinite(q->D[i]);
    }
    for (size_t i = 0; has_rest && i < n; i++)
        surrogate_coordinates(p, x[i], q->U + i * q->n_dim);
    if (has_rest) {
        status = rbf_create(&q->rest, n, q->n_dim, n_out, err);
        THEN(status, rbf_tune(q->rest, n, q->U, q->D, NULL, err));
    }
    return status;
}

void levels_free(Levels *q)
{
    if (q)
        free(q->rest);
    free(q);
}

void levels_predict(Levels *q, const double x[], const double cheap[], double y[])
{
    if (q->rest) {
        surrogate_coordinates(q->problem, x, q->u);
        rbf_eval(q->rest, 1, q->u, q->d, NULL);
    }
    for (size_t k = 0; k < q->n_out; k++)
        y[k] = on_line(&q->line[k], cheap[k]) + (q->rest && rbf_explained(q->rest, k) > 0.0 ? q->d[k] : 0.0);
}
