#include "report/thin.h"

#include <stdint.h>
#include <string.h>

static const size_t NOT_TAKEN = SIZE_MAX;

static double value_of(const Run *run, size_t row, size_t column)
{
    const size_t n_obj = run->schema.n_obj;
    return column < n_obj ? run_f(run, row)[column] : run_x(run, row)[column - n_obj];
}

/* Into rows (n_front), which hold NOT_TAKEN for the other designs of the front: the lowest and the highest value of
 * every column, polished designs, and those that are to be kept. */
static void take_wanted(const Run *run, size_t n_kept, const size_t kept[], size_t rows[])
{
    const size_t n = run->n_front, *front = run->front;
    for (size_t i = 0; i < n; i++) {
        int wanted = run->table.row[front[i]].kind == KIND_POLISHED;
        for (size_t k = 0; k < n_kept; k++)
            wanted = wanted || kept[k] == front[i];
        rows[i] = wanted ? front[i] : NOT_TAKEN;
    }
    for (size_t column = 0; column < run->schema.n_obj + run->schema.n_var; column++) {
        size_t low = 0, high = 0;
        for (size_t i = 1; i < n; i++) {
            const double v = value_of(run, front[i], column);
            low = v < value_of(run, front[low], column) ? i : low;
            high = v > value_of(run, front[high], column) ? i : high;
        }
        rows[low] = front[low];
        rows[high] = front[high];
    }
}

size_t thin_front(const Run *run, size_t most, size_t n_kept, const size_t kept[], size_t rows[])
{
    const size_t n = run->n_front;
    size_t wanted = 0, taken = 0;
    if (n <= most) {
        memcpy(rows, run->front, n * sizeof *rows);
        return n;
    }
    take_wanted(run, n_kept, kept, rows);
    for (size_t i = 0; i < n; i++)
        wanted += rows[i] != NOT_TAKEN;
    for (size_t k = wanted; k < most; k++) {
        const size_t i = (k - wanted) * n / (most - wanted);
        rows[i] = run->front[i];
    }
    for (size_t i = 0; i < n; i++)
        if (rows[i] != NOT_TAKEN)
            rows[taken++] = rows[i];
    return taken;
}
