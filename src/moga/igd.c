#include "moga/igd.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

struct Igd {
    size_t n_obj, n;
    double *width, *reference, *square; /* (n_obj) (n, n_obj) (n) smallest squared distance so far */
    double store[];
};

static void measure_widths(Igd *q)
{
    for (size_t k = 0; k < q->n_obj; k++) {
        double min = INFINITY, max = -INFINITY;
        for (size_t i = 0; i < q->n; i++) {
            min = fmin(min, q->reference[i * q->n_obj + k]);
            max = fmax(max, q->reference[i * q->n_obj + k]);
        }
        q->width[k] = max > min ? max - min : 1.0;
    }
}

Status igd_create(Igd **out, size_t n_obj, size_t n, const size_t rows[], const double F[], Err *err)
{
    const size_t taken = n < IGD_REFERENCE_MAX ? n : IGD_REFERENCE_MAX;
    Igd *q = malloc(sizeof *q + (n_obj + taken * (n_obj + 1)) * sizeof q->store[0]);
    *out = q;
    if (!q)
        return fail(err, STATUS_NO_MEMORY, "no memory for a reference of %zu designs", taken);
    q->n_obj = n_obj;
    q->n = taken;
    q->width = q->store;
    q->reference = q->width + n_obj;
    q->square = q->reference + taken * n_obj;
    for (size_t i = 0; i < taken; i++) {
        memcpy(q->reference + i * n_obj, F + rows[i * n / taken] * n_obj, n_obj * sizeof *F);
        q->square[i] = INFINITY;
    }
    measure_widths(q);
    return STATUS_OK;
}

void igd_add(Igd *q, const double f[])
{
    for (size_t i = 0; i < q->n; i++) {
        double square = 0.0;
        for (size_t k = 0; k < q->n_obj && square < q->square[i]; k++) {
            const double worse = fmax(f[k] - q->reference[i * q->n_obj + k], 0.0) / q->width[k];
            square += worse * worse;
        }
        q->square[i] = fmin(q->square[i], square);
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
