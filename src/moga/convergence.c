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

static void range_of(const GrowingFront *d, const unsigned char chosen[], size_t k, double *min, double *max)
{
    *min = INFINITY;
    *max = -INFINITY;
    for (size_t i = 0; i < d->n; i++)
        if (chosen[i]) {
            *min = fmin(*min, value(d, i, k));
            *max = fmax(*max, value(d, i, k));
        }
}

/* 0: nothing is on the front. */
static int find_box(const GrowingFront *d, double lower[], double reference[])
{
    double min, max, least, most;
    for (size_t k = 0; k < d->n_obj; k++) {
        range_of(d, d->on_front, k, &min, &max);
        range_of(d, d->counts, k, &least, &most);
        if (!(min <= max))
            return 0;
        const double width = fmax(max - min, WIDTH_MIN * (most - least));
        lower[k] = min;
        reference[k] = min + REFERENCE * (width > 0.0 ? width : 1.0);
    }
    return 1;
}

static void follow(const GrowingFront *d, Hypervolume *v, double f[], size_t n_cuts, const size_t cut[], double h[])
{
    for (size_t c = 0, i = 0; c < n_cuts; h[c++] = hypervolume_share(v))
        for (; i < cut[c]; i++) {
            for (size_t k = 0; k < d->n_obj; k++)
                f[k] = value(d, i, k);
            if (d->counts[i])
                hypervolume_add(v, f);
        }
}

Status convergence_shares(const GrowingFront *d, size_t n_cuts, const size_t cut[], double h[], Err *err)
{
    Hypervolume *v = NULL;
    Status status = STATUS_OK;
    double *box = calloc(3 * d->n_obj, sizeof *box);
    for (size_t c = 0; c < n_cuts; c++)
        h[c] = NAN;
    if (!box)
        return fail(err, STATUS_NO_MEMORY, "no memory for a box of %zu objectives", d->n_obj);
    if (find_box(d, box, box + d->n_obj))
        status = hypervolume_create(&v, d->n_obj, box, box + d->n_obj, 1, err);
    if (v)
        follow(d, v, box + 2 * d->n_obj, n_cuts, cut, h);
    hypervolume_free(v);
    free(box);
    return status;
}

double convergence_expected(const double h[3])
{
    const double last = h[2] - h[1], before = h[1] - h[0];
    return last > 0.0 ? fmin(last * fmin(last / before, 1.0), 1.0 - h[2]) : last;
}

void convergence_pack(Convergence *c, Pack *p)
{
    pack_size(p, &c->after, UINT32_MAX);
    pack_size(p, &c->end, UINT32_MAX);
}
