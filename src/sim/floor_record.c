#include "sim/floor_record.h"

#include "scene/building.h"

struct FloorRecord {
    size_t width, rows, room; /* floors padded; samples so far, room for them */
    double h;
    double *u;      /* (room, width) [m], then accelerations [m/s2] */
    double *ground; /* (room) [m/s2] */
    int out_of_memory;
};

Status floor_record_create(FloorRecord **out, int n_floors, Err *err)
{
    *out = calloc(1, sizeof **out);
    if (!*out)
        return fail(err, STATUS_NO_MEMORY, "floors: out of memory");
    (*out)->width = ((size_t)n_floors + 7) & ~(size_t)7;
    return STATUS_OK;
}

void floor_record_free(FloorRecord *f)
{
    if (f) {
        free(f->u);
        free(f->ground);
    }
    free(f);
}

void floor_record_start(FloorRecord *f, double h)
{
    f->h = h;
    f->rows = 0;
    f->out_of_memory = 0;
}

double floor_record_step(const FloorRecord *f)
{
    return f->h;
}

static int make_room(FloorRecord *f, size_t rows)
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

double *floor_record_add(FloorRecord *f, double ground)
{
    if (!make_room(f, f->rows + 1))
        return NULL;
    f->ground[f->rows] = ground;
    return f->u + f->rows++ * f->width;
}

static void differentiate(FloorRecord *f)
{
    const size_t width = f->width, last = f->rows - 1;
    const double per_h2 = 1 / (f->h * f->h);
    double before[FLOORS_MAX];
    memcpy(before, f->u, width * sizeof *f->u);
    for (size_t i = 1; i < last; i++) {
        double *row = f->u + i * width;
        for (size_t j = 0; j < width; j++) {
            const double now = row[j];
            row[j] = per_h2 * (before[j] - 2 * now + row[width + j]) + f->ground[i];
            before[j] = now;
        }
    }
    for (size_t j = 0; j < width; j++) {
        f->u[last * width + j] = f->ground[last];
        f->u[j] = f->ground[0];
    }
}

Status floor_record_accelerations(FloorRecord *f, const double **rows, size_t *n, size_t *width, Err *err)
{
    if (f->out_of_memory)
        return fail_memory(err, f->rows, "samples");
    if (f->rows > 0)
        differentiate(f);
    *rows = f->u;
    *n = f->rows;
    *width = f->width;
    return STATUS_OK;
}
