#include "moga/directions.h"

#include "base/random.h"

/* (p + m - 1 over m - 1), but 0 for p = 0, which is no layer; SIZE_MAX where it does not fit. */
static size_t layer_count(size_t n_obj, size_t p)
{
    size_t n = p > 0;
    for (size_t k = 1; k < n_obj; k++) {
        if (n > SIZE_MAX / (p + k))
            return SIZE_MAX;
        n = n * (p + k) / k;
    }
    return n;
}

static size_t directions_count(size_t n_obj, size_t outer, size_t inner)
{
    const size_t a = layer_count(n_obj, outer), b = layer_count(n_obj, inner);
    return a > SIZE_MAX - b ? SIZE_MAX : a + b;
}

/* Below p = m every point of one layer lies on the border, so an inner layer is added as soon as it fits. */
void directions_choose(size_t n_obj, size_t population, size_t *outer, size_t *inner)
{
    *outer = 1;
    *inner = 0;
    if (n_obj < 2)
        return;
    while (directions_count(n_obj, *outer + 1, 0) <= population)
        ++*outer;
    if (*outer < n_obj)
        while (*inner < *outer && directions_count(n_obj, *outer, *inner + 1) <= population)
            ++*inner;
}

/* Next composition of p into m parts, in descending order of the first part; 0 when there is none. */
static int next_parts(size_t m, size_t parts[])
{
    size_t k = m - 1;
    while (k > 0 && parts[k - 1] == 0)
        k--;
    if (k == 0)
        return 0;
    const size_t tail = parts[m - 1];
    parts[m - 1] = 0;
    parts[k - 1]--;
    parts[k] = tail + 1;
    return 1;
}

static double *write_layer(size_t n_obj, size_t p, double shrink, size_t parts[], double *w)
{
    if (p == 0)
        return w;
    for (size_t k = 0; k < n_obj; k++)
        parts[k] = k == 0 ? p : 0;
    do {
        for (size_t k = 0; k < n_obj; k++)
            w[k] = shrink * (double)parts[k] / (double)p + (1.0 - shrink) / (double)n_obj;
        w += n_obj;
    } while (next_parts(n_obj, parts));
    return w;
}

Status directions_create(Directions *d, size_t n_obj, size_t outer, size_t inner, Err *err)
{
    const size_t n = directions_count(n_obj, outer, inner);
    *d = (Directions){.n = n, .n_obj = n_obj};
    size_t *parts = calloc(n_obj, sizeof *parts);
    d->W = n < SIZE_MAX / (n_obj * sizeof *d->W) ? calloc(n * n_obj, sizeof *d->W) : NULL;
    if (d->W && parts)
        write_layer(n_obj, inner, 0.5, parts, write_layer(n_obj, outer, 1.0, parts, d->W));
    free(parts);
    if (d->W && parts)
        return STATUS_OK;
    directions_free(d);
    return fail_memory(err, n, "reference directions");
}

/* Candidates are the axes, then points of the positive part of the sphere. Of all the one that is farthest from those
 * chosen is chosen, again and again; the axes come first. */
Status directions_spread(Directions *d, size_t n_obj, size_t n, Err *err)
{
    const size_t n_candidates = n_obj + 20 * n;
    *d = (Directions){.n = n, .n_obj = n_obj};
    d->W = calloc(n * n_obj, sizeof *d->W);
    double *C = calloc(n_candidates * (n_obj + 1), sizeof *C);
    if (!d->W || !C) {
        free(C);
        directions_free(d);
        return fail_memory(err, n, "directions");
    }
    double *nearest = C + n_candidates * n_obj;
    for (size_t j = 0; j < n_candidates; j++) {
        Random random = random_stream(0, RANDOM_DIRECTIONS, 0, (uint32_t)j);
        double *c = C + j * n_obj, square = 0.0;
        for (size_t k = 0; k < n_obj; k++) {
            c[k] = j < n_obj ? j == k : fabs(random_normal(&random));
            square += c[k] * c[k];
        }
        for (size_t k = 0; k < n_obj; k++)
            c[k] /= sqrt(square);
        nearest[j] = INFINITY;
    }
    for (size_t i = 0; i < n; i++) {
        size_t chosen = i < n_obj ? i : 0;
        double *w = d->W + i * n_obj, sum = 0.0;
        for (size_t j = 1; j < n_candidates && i >= n_obj; j++)
            chosen = nearest[j] > nearest[chosen] ? j : chosen;
        memcpy(w, C + chosen * n_obj, n_obj * sizeof *w);
        for (size_t j = 0; j < n_candidates; j++) {
            double square = 0.0;
            for (size_t k = 0; k < n_obj; k++)
                square += (C[j * n_obj + k] - w[k]) * (C[j * n_obj + k] - w[k]);
            nearest[j] = fmin(nearest[j], square);
        }
        for (size_t k = 0; k < n_obj; k++)
            sum += w[k];
        for (size_t k = 0; k < n_obj; k++)
            w[k] /= sum;
    }
    free(C);
    return STATUS_OK;
}

void directions_across(const Directions *d, double across[])
{
    for (size_t r = 0; r < d->n; r++) {
        const double *w = d->W + r * d->n_obj;
        double square = 0.0;
        for (size_t k = 0; k < d->n_obj; k++)
            square += w[k] * w[k];
        for (size_t k = 0; k < d->n_obj; k++)
            across[k * d->n + r] = w[k] / sqrt(square);
    }
}

void directions_free(Directions *d)
{
    free(d->W);
    d->W = NULL;
}
