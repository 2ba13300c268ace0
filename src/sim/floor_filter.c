#include "sim/floor_filter.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/clones.h"
#include "base/filter.h"
#include "scene/building.h"

struct FloorFilter {
    int n;
    size_t width, rows, room; /* floors padded; samples so far, room for them */
    double cutoff_hz, h;
    double *u;      /* (room, width) [m], then accelerations [m/s2] */
    double *ground; /* (room) [m/s2] */
    int out_of_memory;
};

static const double SAMPLES_PER_PERIOD = 10; /* of the cutoff frequency */

double floor_filter_spacing(double cutoff_hz)
{
    return 1 / (SAMPLES_PER_PERIOD * cutoff_hz);
}

Status floor_filter_create(FloorFilter **out, int n_floors, double cutoff_hz, Err *err)
{
    *out = calloc(1, sizeof **out);
    if (!*out)
        return fail(err, STATUS_NO_MEMORY, "filter: out of memory");
    (*out)->n = n_floors;
    (*out)->width = ((size_t)n_floors + 7) & ~(size_t)7;
    (*out)->cutoff_hz = cutoff_hz;
    return STATUS_OK;
}

void floor_filter_free(FloorFilter *f)
{
    if (f) {
        free(f->u);
        free(f->ground);
    }
    free(f);
}

void floor_filter_start(FloorFilter *f, double h)
{
    f->h = h;
    f->rows = 0;
    f->out_of_memory = 0;
}

double floor_filter_step(const FloorFilter *f)
{
    return f->h;
}

static int make_room(FloorFilter *f, size_t rows)
{
    if (rows <= f->room)
        return 1;
    const size_t room = rows > 2 * f->room ? rows : 2 * f->room;
    double *u = realloc(f->u, room * f->width * sizeof *u);
    f->u = u ? u : f->u;
    double *ground = u ? realloc(f->ground, room * sizeof *ground) : NULL;
    f->ground = ground ? ground : f->ground;
    f->room = ground ? room : f->room;
    f->out_of_memory |= !ground;
    return ground != NULL;
}

double *floor_filter_add(FloorFilter *f, double ground)
{
    if (!make_room(f, f->rows + 1))
        return NULL;
    f->ground[f->rows] = ground;
    return f->u + f->rows++ * f->width;
}

/* Rows 1 .. rows-2 become own a_i + bend (a_i-1 - 2 a_i + a_i+1), in place. */
CLONED static void second_differences(size_t rows, size_t width, double own, double bend, double a[])
{
    double before[FLOORS_MAX];
    memcpy(before, a, width * sizeof *a);
    for (size_t i = 1; i + 1 < rows; i++) {
        double *row = a + i * width;
        for (size_t j = 0; j < width; j++) {
            const double now = row[j];
            row[j] = own * now + bend * (before[j] - 2 * now + row[width + j]);
            before[j] = now;
        }
    }
}

/* Displacements become accelerations; at the ends that of the ground. */
static void differentiate(FloorFilter *f)
{
    const size_t last = f->rows - 1;
    second_differences(f->rows, f->width, 0, 1 / (f->h * f->h), f->u);
    memset(f->u, 0, f->width * sizeof *f->u);
    memset(f->u + last * f->width, 0, f->width * sizeof *f->u);
    for (size_t i = 0; i < f->rows; i++)
        for (size_t j = 0; j < f->width; j++)
            f->u[i * f->width + j] += f->ground[i];
}

/* Block of BLOCK rows with the largest magnitude of every column. */
enum { BLOCK = 64 };

CLONED static void find_blocks(size_t rows, size_t width, const double a[], double most[], size_t block[])
{
    for (size_t j = 0; j < width; j++)
        most[j] = 0, block[j] = 0;
    for (size_t first = 0; first < rows; first += BLOCK) {
        double top[FLOORS_MAX] = {0};
        const size_t end = first + BLOCK < rows ? first + BLOCK : rows;
        for (size_t i = first; i < end; i++)
            for (size_t j = 0; j < width; j++) {
                const double y = fabs(a[i * width + j]);
                top[j] = y > top[j] ? y : top[j];
            }
        for (size_t j = 0; j < width; j++)
            if (top[j] > most[j]) {
                most[j] = top[j];
                block[j] = first;
            }
    }
}

/* Largest magnitude of the parabola through row `top` of a column and its neighbours. */
static double parabola_top(const double a[], size_t top, size_t rows, size_t stride)
{
    const double y = a[top * stride];
    if (top == 0 || top + 1 >= rows)
        return fabs(y);
    const double left = a[(top - 1) * stride], right = a[(top + 1) * stride];
    const double bend = left - 2 * y + right, slope = 0.5 * (right - left);
    return bend != 0 ? fabs(y - 0.5 * slope * slope / bend) : fabs(y);
}

Status floor_filter_accelerations(FloorFilter *f, const double **rows, size_t *n, size_t *width, Err *err)
{
    if (f->out_of_memory)
        return fail(err, STATUS_NO_MEMORY, "filter: no memory for %zu samples", f->rows);
    if (f->rows > 0)
        differentiate(f);
    *rows = f->u;
    *n = f->rows;
    *width = f->width;
    return STATUS_OK;
}

Status floor_filter_peaks(FloorFilter *f, double peaks[], Err *err)
{
    Filter filter;
    const double *rows;
    double most[FLOORS_MAX];
    size_t n, width, at[FLOORS_MAX];
    TRY(filter_butterworth(&filter, FILTER_LOW_PASS, f->cutoff_hz, f->h, err));
    const size_t samples = f->rows, padding = filter_padding(&filter);
    for (size_t i = 0; i < padding; i++)
        floor_filter_add(f, 0);
    f->rows = samples;
    TRY(floor_filter_accelerations(f, &rows, &n, &width, err));
    if (samples == 0) {
        memset(peaks, 0, (size_t)f->n * sizeof *peaks);
        return STATUS_OK;
    }
    second_differences(samples, width, 1, -1.0 / 12, f->u);
    memset(f->u + samples * width, 0, padding * width * sizeof *f->u);
    filter_zero_phase(&filter, samples + padding, width, f->u);
    find_blocks(samples, width, f->u, most, at);
    for (int j = 0; j < f->n; j++) {
        while (at[j] + 1 < samples && fabs(f->u[at[j] * width + (size_t)j]) < most[j])
            at[j]++;
        peaks[j] = parabola_top(f->u + j, at[j], samples, width);
    }
    return STATUS_OK;
}
