#include "sim/floor_record.h"

#include "base/carve.h"
#include "scene/building.h"

struct FloorRecord {
    size_t width, rows, room; /* floors padded, and one; samples so far, room for them */
    double h;
    double *u; /* (room, width) [m], then accelerations [m/s2]; the last of a row: of the ground */
    int out_of_memory;
};

Status floor_record_create(FloorRecord **out, int n_floors, Err *err)
{
    TRY_ROOM(*out, 1, "the accelerations of the floors", err);
    (*out)->width = (((size_t)n_floors + 7) & ~(size_t)7) + 1;
    return STATUS_OK;
}

void floor_record_free(FloorRecord *f)
{
    if (f)
        free(f->u);
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

double *floor_record_add(FloorRecord *f, double ground)
{
    if (f->rows == f->room) {
        const size_t room = f->room > 0 ? 2 * f->room : 1;
        f->u = widened(f->u, room * f->width, sizeof *f->u, &f->out_of_memory);
        if (f->out_of_memory)
            return NULL;
        f->room = room;
    }
    double *row = f->u + f->rows++ * f->width;
    row[f->width - 1] = ground;
    return row;
}

Status floor_record_accelerations(FloorRecord *f, const double **rows, size_t *n, size_t *width, Err *err)
{
    const double per_h2 = 1 / (f->h * f->h);
    double before[FLOORS_MAX];
    if (f->out_of_memory)
        return fail_memory(err, f->rows, "samples");
    *rows = f->u;
    *n = f->rows;
    *width = f->width;
    for (size_t i = 0; i < f->rows; i++)
        for (size_t j = 0; j + 1 < f->width; j++) {
            double *u = f->u + i * f->width + j;
            const double now = *u, ground = f->u[(i + 1) * f->width - 1];
            *u = i > 0 && i + 1 < f->rows ? per_h2 * (before[j] - 2 * now + u[f->width]) + ground : ground;
            before[j] = now;
        }
    return STATUS_OK;
}
