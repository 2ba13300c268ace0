#include "sim/floor_filter.h"

#include "base/carve.h"
#include "base/clones.h"
#include "base/filter.h"
#include "scene/building.h"
#include "sim/lanes.h"

enum { VECTORS = 3 /* together: each waits for its own last row */, ENTERED = 32 /* rows at once */ };

/* Of a column between two rows: u and a of the last two, then the filter's states. */
enum { LAST_U, BEFORE_U, LAST_A, BEFORE_A, SECTIONS, STATES = SECTIONS + 2 * FILTER_SECTIONS };

struct FloorFilter {
    int n, out_of_memory, resumes; /* resumes: the next row does not begin at rest */
    size_t width;                  /* floors padded */
    double cutoff_hz, h;
    Filter filter;
    double norm;    /* sum |g| */
    double below;   /* so much of max|z| can be missed */
    size_t padding; /* rows behind a block */
    size_t block;   /* rows whose peaks are found at once */
    size_t entered; /* rows of u that wait */
    size_t filled;  /* rows of y */
    double *u;      /* (ENTERED, width) [m] */
    double *ground; /* (1 + ENTERED) [m/s2], of the row before them first */
    double *state;  /* (STATES, width) */
    double *y;      /* (1 + block + padding, width) forward pass; the row before the block first */
    double *z;      /* (1 + block + padding, width) both passes */
    double *most;   /* (width) [m/s2] largest magnitude of z so far; infinite behind the last floor */
    double *peak;   /* (width) [m/s2] of the parabola there */
    void *store;
};

static const double SAMPLES_PER_PERIOD = 10; /* of the cutoff frequency */

double floor_filter_memory(double cutoff_hz)
{
    return 3 / cutoff_hz;
}

double floor_filter_spacing(double cutoff_hz)
{
    return 1 / (SAMPLES_PER_PERIOD * cutoff_hz);
}

Status floor_filter_create(FloorFilter **out, int n_floors, double cutoff_hz, Err *err)
{
    FloorFilter *f = *out = NULL;
    TRY_ROOM(f, 1, "a filter of floors", err);
    f->n = n_floors;
    f->width = ((size_t)n_floors + LANES8 - 1) & ~(size_t)(LANES8 - 1);
    f->cutoff_hz = cutoff_hz;
    *out = f;
    return STATUS_OK;
}

void floor_filter_free(FloorFilter *f)
{
    if (f)
        free(f->store);
    free(f);
}

/* Arrays of a block of rows and what follows it. */
static void layout(void *object, Carve *c)
{
    FloorFilter *f = object;
    CARVE(c, f->u, ENTERED * f->width);
    CARVE(c, f->ground, 1 + ENTERED);
    CARVE(c, f->state, STATES * f->width);
    CARVE(c, f->y, (1 + f->block + f->padding) * f->width);
    CARVE(c, f->z, (1 + f->block + f->padding) * f->width);
    CARVE(c, f->most, f->width);
    CARVE(c, f->peak, f->width);
}

/* The floors are at rest. */
static void begin(FloorFilter *f)
{
    f->entered = 0;
    f->filled = 1;
    f->ground[0] = 0;
    memset(f->state, 0, STATES * f->width * sizeof *f->state);
    memset(f->y, 0, f->width * sizeof *f->y);
}

void floor_filter_start(FloorFilter *f, double h)
{
    /* 1. Another step of the samples: the filter for it, the lengths that follow from it, and memory for these. */
    if (!f->store || h != f->h) {
        Err err = {0};
        double s[FILTER_SECTIONS][2] = {{0}};
        free(f->store);
        f->store = NULL;
        f->h = h;
        f->out_of_memory = 0;
        if (filter_butterworth(&f->filter, FILTER_LOW_PASS, f->cutoff_hz, h, &err) != STATUS_OK)
            return;
        f->padding = filter_padding(&f->filter);
        f->block = 2 * f->padding;
        f->norm = 0;
        for (size_t i = 0; i < f->padding; i++) {
            double x = i == 0;
            FILTER_STEP(&f->filter, x, s);
            f->norm += fabs(x);
        }
        f->below = 3 / (4 * f->norm * f->norm);
        f->store = carve_all(layout, f);
        f->out_of_memory = !f->store;
    }
    if (!f->store)
        return;

    /* 2. Everything is at rest. */
    begin(f);
    f->resumes = 0;
    for (size_t j = 0; j < f->width; j++) {
        f->most[j] = j < (size_t)f->n ? 0 : HUGE_VAL;
        f->peak[j] = 0;
    }
}

/* -- forward ---------------------------------------------------------------------------------------------------- */

/* Rows of displacements u that enter, ground acceleration of the row before each. */
typedef struct {
    size_t n, width;
    double per_h2; /* [1/s2] */
    const double *u, *ground;
} Entry;

/* With each row of displacements the acceleration of the row before is known, and the filter's input two rows
 * before. */
static inline __attribute__((always_inline)) void forward_vectors(const int vectors, const Filter *filter,
                                                                  const Entry *e, size_t at, double state[], double y[])
{
    v8 last[VECTORS][SECTIONS], s[VECTORS][FILTER_SECTIONS][2];
    const size_t width = e->width / LANES8;
    const v8 *u = (const v8 *)(e->u + at);
    v8 *own = (v8 *)(state + at), *out = (v8 *)(y + at);
    for (int j = 0; j < vectors; j++)
        for (size_t k = 0; k < STATES; k++)
            *(k < SECTIONS ? &last[j][k] : &s[j][(k - SECTIONS) / 2][k % 2]) = own[k * width + (size_t)j];
    for (size_t i = 0; i < e->n; i++, u += width, out += width)
#pragma GCC unroll 3
        for (int j = 0; j < vectors; j++) {
            const v8 now = u[j];
            const v8 a = (last[j][BEFORE_U] - 2 * last[j][LAST_U] + now) * e->per_h2 + e->ground[i];
            v8 x = last[j][LAST_A] - (last[j][BEFORE_A] - 2 * last[j][LAST_A] + a) * (1.0 / 12);
            FILTER_STEP(filter, x, s[j]);
            out[j] = x;
            last[j][BEFORE_U] = last[j][LAST_U];
            last[j][LAST_U] = now;
            last[j][BEFORE_A] = last[j][LAST_A];
            last[j][LAST_A] = a;
        }
    for (int j = 0; j < vectors; j++)
        for (size_t k = 0; k < STATES; k++)
            own[k * width + (size_t)j] = k < SECTIONS ? last[j][k] : s[j][(k - SECTIONS) / 2][k % 2];
}

CLONED static void forward(const Filter *filter, const Entry *e, double state[], double y[])
{
    size_t at = 0;
    for (; at + VECTORS * LANES8 <= e->width; at += VECTORS * LANES8)
        forward_vectors(VECTORS, filter, e, at, state, y);
    for (; at < e->width; at += LANES8)
        forward_vectors(1, filter, e, at, state, y);
}

/* -- backward --------------------------------------------------------------------------------------------------- */

/* Can these rows of y raise the largest magnitude of z? */
CLONED static int may_rise(size_t rows, size_t width, const double y[], double norm, const double most_z[])
{
    m8 over = {0};
    for (size_t at = 0; at < width; at += LANES8) {
        v8 most = {0};
        for (size_t i = 0; i < rows; i++) {
            const v8 now = V8_ABS(*(const v8 *)(y + i * width + at));
            most = V8_WHERE(now > most, now, most);
        }
        over |= most * norm > *(const v8 *)(most_z + at);
    }
    return m8_any(&over);
}

/* Both passes of rows 0..block + 1 of some columns from all rows of y; the largest magnitude among 1..block of every
 * column, and its row. */
static inline __attribute__((always_inline)) void
backward_vectors(const int vectors, const FloorFilter *f, size_t block, size_t column, double top[], double top_row[])
{
    const Filter *filter = &f->filter;
    const size_t width = f->width;
    const double *y = f->y + column;
    double *z = f->z + column;
    v8 s[VECTORS][FILTER_SECTIONS][2] = {{{{0}}}}, most[VECTORS] = {{0}}, at[VECTORS] = {{0}};
    for (size_t i = f->filled; i-- > 0;)
#pragma GCC unroll 3
        for (int j = 0; j < vectors; j++) {
            v8 x = ((const v8 *)(y + i * width))[j];
            FILTER_STEP(filter, x, s[j]);
            if (i > block + 1)
                continue;
            ((v8 *)(z + i * width))[j] = x;
            if (i == 0 || i > block)
                continue;
            const v8 now = V8_ABS(x);
            const m8 more = now > most[j];
            most[j] = V8_WHERE(more, now, most[j]);
            at[j] = V8_WHERE(more, (v8){0} + (double)i, at[j]);
        }
    for (int j = 0; j < vectors; j++) {
        ((v8 *)(top + column))[j] = most[j];
        ((v8 *)(top_row + column))[j] = at[j];
    }
}

CLONED static void backward(const FloorFilter *f, size_t block, double top[], double top_row[])
{
    size_t at = 0;
    for (; at + VECTORS * LANES8 <= f->width; at += VECTORS * LANES8)
        backward_vectors(VECTORS, f, block, at, top, top_row);
    for (; at < f->width; at += LANES8)
        backward_vectors(1, f, block, at, top, top_row);
}

/* Peaks of rows 1..block of y, the last of which has a neighbour: of the parabola through the row of the largest
 * magnitude and its neighbours, where it is the largest of them; else of the row. */
static void take_block(FloorFilter *f, size_t block)
{
    _Alignas(64) double top[FLOORS_MAX], row[FLOORS_MAX];
    if (!may_rise(f->filled - 1, f->width, f->y + f->width, f->norm, f->most))
        return;
    backward(f, block, top, row);
    for (size_t j = 0; j < (size_t)f->n; j++) {
        if (!(top[j] > f->most[j]))
            continue;
        const double *z = f->z + (size_t)row[j] * f->width + j, left = *(z - f->width), y = *z, right = z[f->width];
        const double bend = left - 2 * y + right, slope = 0.5 * (right - left);
        const int is_top = fabs(left) <= fabs(y) && fabs(right) <= fabs(y) && bend != 0;
        f->most[j] = top[j];
        f->peak[j] = is_top ? fabs(y - 0.5 * slope * slope / bend) : fabs(y);
    }
}

/* -- a run ------------------------------------------------------------------------------------------------------ */

/* The rows that wait go through the forward pass, and every block that is complete through the backward one. */
static void enter(FloorFilter *f)
{
    const size_t width = f->width, full = 1 + f->block + f->padding;
    if (f->resumes && f->entered > 0) {
        /* Before the first of these rows the floors went as they go from it to the second. */
        const double *first = f->u, *second = f->entered > 1 ? f->u + width : f->u;
        for (size_t j = 0; j < width; j++) {
            f->state[LAST_U * width + j] = 2 * first[j] - second[j];
            f->state[BEFORE_U * width + j] = 3 * first[j] - 2 * second[j];
        }
        f->resumes = 0;
    }
    for (size_t first = 0; first < f->entered;) {
        const size_t left = f->entered - first, room = full - f->filled, n = left < room ? left : room;
        forward(&f->filter,
                &(Entry){.n = n,
                         .width = width,
                         .per_h2 = 1 / (f->h * f->h),
                         .u = f->u + first * width,
                         .ground = f->ground + first},
                f->state, f->y + f->filled * width);
        f->filled += n;
        first += n;
        if (f->filled < full)
            continue;
        take_block(f, f->block);
        f->filled -= f->block;
        memmove(f->y, f->y + f->block * width, f->filled * width * sizeof *f->y);
    }
    f->ground[0] = f->ground[f->entered];
    f->entered = 0;
}

double *floor_filter_add(FloorFilter *f, double ground)
{
    if (!f->store)
        return NULL;
    if (f->entered == ENTERED)
        enter(f);
    f->ground[1 + f->entered] = ground;
    return f->u + f->entered++ * f->width;
}

void floor_filter_interrupt(FloorFilter *f)
{
    if (!f->store)
        return;
    enter(f);
    if (f->filled > 2) /* the last row has no neighbour, and lies where no peak can be */
        take_block(f, f->filled - 2);
    begin(f);
    f->resumes = 1;
}

int floor_filter_is_below(const FloorFilter *f, const double acceleration[])
{
    int64_t above = 0;
    if (!f->store)
        return 0;
    for (int j = 0; j < f->n; j++)
        above |= !(acceleration[j] < f->below * f->most[j]);
    return !above;
}

Status floor_filter_peaks(FloorFilter *f, double peaks[], Err *err)
{
    const size_t width = f->width;
    const double *last = f->state + LAST_U * width, *before = f->state + BEFORE_U * width;
    if (f->out_of_memory)
        return fail_memory(err, f->n, "floors");
    if (!f->store)
        return filter_butterworth(&f->filter, FILTER_LOW_PASS, f->cutoff_hz, f->h, err);

    /* After the last row the floors go on as they went, as long as the filter lags behind. */
    enter(f);
    for (int i = 1; i <= 2; i++) {
        double *u = floor_filter_add(f, f->ground[0]);
        for (size_t j = 0; j < width; j++)
            u[j] = last[j] + i * (last[j] - before[j]);
    }
    enter(f);

    /* Then the ground stands still. */
    memset(f->state, 0, SECTIONS * width * sizeof *f->state);
    f->ground[0] = 0;
    for (size_t i = 0; i < f->padding; i++)
        memset(floor_filter_add(f, 0), 0, width * sizeof *f->u);
    enter(f);
    if (f->filled > 1 + f->padding)
        take_block(f, f->filled - 1 - f->padding);
    memcpy(peaks, f->peak, (size_t)f->n * sizeof *peaks);
    return STATUS_OK;
}
