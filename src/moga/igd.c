#include "moga/igd.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

struct Igd {
    size_t n_obj, n, n_apart;  /* references; of them those that nothing reaches yet come first */
    double *width, *reference; /* (n_obj) (n_obj, n) in widths */
    double *square, *sum;      /* (n) smallest squared distance so far; (n) of the design that is added */
    double store[];
};

static void measure_widths(Igd *q)
{
    for (size_t k = 0; k < q->n_obj; k++) {
        double min = INFINITY, max = -INFINITY;
        for (size_t i = 0; i < q->n; i++) {
            min = fmin(min, q->reference[k * q->n + i]);
            max = fmax(max, q->reference[k * q->n + i]);
        }
        q->width[k] = max > min ? max - min : 1.0;
        for (size_t i = 0; i < q->n; i++)
            q->reference[k * q->n + i] /= q->width[k];
    }
}

Status igd_create(Igd **out, size_t n_obj, size_t n, const size_t rows[], const double F[], Err *err)
{
    const size_t taken = n < IGD_REFERENCE_MAX ? n : IGD_REFERENCE_MAX;
    Igd *q = malloc(sizeof *q + (n_obj + taken * (n_obj + 2)) * sizeof q->store[0]);
    *out = q;
    if (!q)
        return fail(err, STATUS_NO_MEMORY, "no memory for a reference of %zu designs", taken);
    q->n_obj = n_obj;
    q->n = q->n_apart = taken;
    q->width = q->store;
    q->reference = q->width + n_obj;
    q->square = q->reference + taken * n_obj;
    q->sum = q->square + taken;
    for (size_t i = 0; i < taken; i++) {
        for (size_t k = 0; k < n_obj; k++)
            q->reference[k * taken + i] = F[rows[i * n / taken] * n_obj + k];
        q->square[i] = INFINITY;
    }
    measure_widths(q);
    return STATUS_OK;
}

/* A reference that is reached stays so: it changes places with the last of the others. */
static void set_aside(Igd *q, size_t i)
{
    const size_t last = --q->n_apart;
    for (size_t k = 0; k < q->n_obj; k++) {
        double *reference = q->reference + k * q->n;
        const double kept = reference[i];
        reference[i] = reference[last];
        reference[last] = kept;
    }
    q->square[i] = q->square[last];
    q->square[last] = 0.0;
}

void igd_add(Igd *q, const double f[])
{
    double *sum = q->sum, *square = q->square;
    const size_t n = q->n_apart;
    for (size_t i = 0; i < n; i++)
        sum[i] = 0.0;
    for (size_t k = 0; k < q->n_obj; k++) {
        const double value = f[k] / q->width[k], *reference = q->reference + k * q->n;
#pragma omp simd
        for (size_t i = 0; i < n; i++) {
            const double off = value - reference[i], worse = off > 0.0 ? off : 0.0;
            sum[i] += worse * worse;
        }
    }
    for (size_t i = n; i-- > 0;) {
        if (sum[i] < square[i])
            square[i] = sum[i];
        if (square[i] == 0.0)
            set_aside(q, i);
    }
}

double igd_value(const Igd *q)
{
    double sum = 0.0;
    for (size_t i = 0; i < q->n; i++)
        sum += sqrt(q->square[i]);
    return sum / (double)q->n;
}

void igd_free(Igd *q)
{
    free(q);
}
