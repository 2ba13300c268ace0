#include "moga/hypervolume.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/random.h"

/* Samples lie in the order of the cells of a grid, so that a design which dominates none of a cell passes over it. */
enum { CELLS_MAX = 256, GRID_DIM_MAX = 8 };

struct Hypervolume {
    size_t n_obj, n_left, n_cells, per_axis, n_axes;
    size_t first[CELLS_MAX], n[CELLS_MAX]; /* samples of each cell that are not dominated yet */
    double *highest;                       /* (n_cells, n_obj) of its samples */
    double sample[];                       /* (HYPERVOLUME_SAMPLES, n_obj), then highest */
};

static void choose_grid(Hypervolume *h)
{
    h->n_axes = h->n_obj < GRID_DIM_MAX ? h->n_obj : GRID_DIM_MAX;
    for (h->per_axis = 1;; h->per_axis++) {
        size_t n = 1;
        for (size_t k = 0; k < h->n_axes; k++)
            n *= h->per_axis + 1;
        if (n > CELLS_MAX)
            break;
        h->n_cells = n;
    }
}

/* u (n_obj) in the unit cube. */
static size_t cell_of(const Hypervolume *h, const double u[])
{
    size_t cell = 0;
    for (size_t k = 0; k < h->n_axes; k++) {
        const size_t at = (size_t)(u[k] * (double)h->per_axis);
        cell = cell * h->per_axis + (at < h->per_axis ? at : h->per_axis - 1);
    }
    return cell;
}

static void sample_at(const Hypervolume *h, uint32_t seed, size_t i, double u[])
{
    Random r = random_stream(seed, RANDOM_HYPERVOLUME, 0, (uint32_t)i);
    for (size_t k = 0; k < h->n_obj; k++)
        u[k] = random_uniform(&r);
}

static void fill(Hypervolume *h, const double lower[], const double reference[], uint32_t seed, double u[])
{
    const size_t m = h->n_obj;
    for (size_t i = 0; i < HYPERVOLUME_SAMPLES; i++) {
        sample_at(h, seed, i, u);
        h->n[cell_of(h, u)]++;
    }
    for (size_t c = 0, first = 0; c < h->n_cells; first += h->n[c++]) {
        h->first[c] = first;
        for (size_t k = 0; k < m; k++)
            h->highest[c * m + k] = -INFINITY;
    }
    memset(h->n, 0, sizeof h->n);
    for (size_t i = 0; i < HYPERVOLUME_SAMPLES; i++) {
        sample_at(h, seed, i, u);
        const size_t c = cell_of(h, u);
        double *s = h->sample + (h->first[c] + h->n[c]++) * m;
        for (size_t k = 0; k < m; k++) {
            s[k] = lower[k] + (reference[k] - lower[k]) * u[k];
            h->highest[c * m + k] = fmax(h->highest[c * m + k], s[k]);
        }
    }
}

Status hypervolume_create(Hypervolume **out, size_t n_obj, const double lower[], const double reference[],
                          uint32_t seed, Err *err)
{
    const size_t n = (HYPERVOLUME_SAMPLES + CELLS_MAX + 1) * n_obj;
    Hypervolume *h = calloc(1, sizeof *h + n * sizeof h->sample[0]);
    *out = h;
    if (!h)
        return fail(err, STATUS_NO_MEMORY, "no memory for %d samples of %zu objectives", HYPERVOLUME_SAMPLES, n_obj);
    h->n_obj = n_obj;
    h->n_left = HYPERVOLUME_SAMPLES;
    h->highest = h->sample + HYPERVOLUME_SAMPLES * n_obj;
    choose_grid(h);
    fill(h, lower, reference, seed, h->highest + CELLS_MAX * n_obj);
    return STATUS_OK;
}

static int reaches(size_t m, const double f[], const double s[])
{
    for (size_t k = 0; k < m; k++)
        if (!(f[k] <= s[k]))
            return 0;
    return 1;
}

void hypervolume_add(Hypervolume *h, const double f[])
{
    const size_t m = h->n_obj;
    for (size_t c = 0; c < h->n_cells; c++) {
        double *samples = h->sample + h->first[c] * m;
        size_t left = 0;
        if (h->n[c] == 0 || !reaches(m, f, h->highest + c * m))
            continue;
        for (size_t i = 0; i < h->n[c]; i++) {
            if (reaches(m, f, samples + i * m))
                continue;
            if (left < i)
                memcpy(samples + left * m, samples + i * m, m * sizeof *samples);
            left++;
        }
        h->n_left -= h->n[c] - left;
        h->n[c] = left;
    }
}

double hypervolume_share(const Hypervolume *h)
{
    return 1.0 - (double)h->n_left / HYPERVOLUME_SAMPLES;
}

double hypervolume_error(double share)
{
    return sqrt(share * (1.0 - share) / HYPERVOLUME_SAMPLES);
}

void hypervolume_free(Hypervolume *h)
{
    free(h);
}
