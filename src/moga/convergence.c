#include "moga/convergence.h"

#include "base/hypervolume.h"

/* Least width of the box in an objective, as a share of its range over all designs. */
static const double WIDTH_MIN = 0.01;
static const double REFERENCE = 1.1; /* of the box, in widths of the front from its ideal */

static double value(const GrowingFront *d, size_t i, size_t k)
{
    const double f = d->F[i * d->n_obj + k];
    return (d->sense ? d->sense[k] * f : f) + (d->error ? d->error[i * d->n_obj + k] : 0.0);
}

Status convergence_shares(const GrowingFront *d, size_t n_cuts, const size_t cut[], double h[], Err *err)
{
    const size_t m = d->n_obj;
    double *lower = calloc(3 * m, sizeof *lower);
    if (!lower)
        return fail(err, STATUS_NO_MEMORY, "no memory for a box of %zu objectives", m);
    double *reference = lower + m, *f = reference + m;
    Hypervolume *v = NULL;
    Status status = STATUS_OK;
    int has_front = 1;

    /* 1. The box, of the ranges of the front and of all designs. */
    for (size_t k = 0; k < m; k++) {
        double min = INFINITY, max = -INFINITY, least = INFINITY, most = -INFINITY;
        for (size_t i = 0; i < d->n; i++) {
            const double y = value(d, i, k);
            if (d->on_front[i]) {
                min = fmin(min, y);
                max = fmax(max, y);
            }
            if (d->counts[i]) {
                least = fmin(least, y);
                most = fmax(most, y);
            }
        }
        const double width = fmax(max - min, WIDTH_MIN * (most - least));
        has_front = has_front && min <= max;
        lower[k] = min;
        reference[k] = min + REFERENCE * (width > 0.0 ? width : 1.0);
    }

    /* 2. The designs, one after the other. */
    if (has_front)
        status = hypervolume_create(&v, m, lower, reference, 1, err);
    for (size_t c = 0, i = 0; c < n_cuts; h[c++] = v ? hypervolume_share(v) : NAN)
        for (; v && i < cut[c]; i++) {
            for (size_t k = 0; k < m; k++)
                f[k] = value(d, i, k);
            if (d->counts[i])
                hypervolume_add(v, f);
        }
    hypervolume_free(v);
    free(lower);
    return status;
}

double convergence_expected(const double h[3])
{
    const double last = h[2] - h[1], before = h[1] - h[0];
    return last > 0.0 ? fmin(last * fmin(last / before, 1.0), 1.0 - h[2]) : last;
}
