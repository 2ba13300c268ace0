#include "report/thin.h"

#include <stdint.h>
#include <string.h>

static const size_t NOT_TAKEN = SIZE_MAX;

static double value_of(const Run *run, size_t row, size_t column)
{
    const size_t n_obj = run->schema.n_obj;
    return column < n_obj ? run_f(run, row)[column] : run_x(run, row)[column - n_obj];
}

/* Into rows (n_front), which hold NOT_TAKEN for the other designs of the front. */
static void take_extremes(const Run *run, size_t column, size_t rows[])
{
    size_t low = 0, high = 0;
    for (size_t i = 1; i < run->n_front; i++) {
        const double v = value_of(run, run->front[i], column);
        low = v < value_of(run, run->front[low], column) ? i : low;
        high = v > value_of(run, run->front[high], column) ? i : high;
    }
    rows[low] = run->front[low];
    rows[high] = run->front[high];
}

static void take_wanted(const Run *run, size_t n_kept, const size_t kept[], size_t rows[])
{
    for (size_t i = 0; i < run->n_front; i++) {
        int wanted = run->table.row[run->front[i]].kind == KIND_POLISHED;
        for (size_t k = 0; k < n_kept; k++)
            wanted = wanted || kept[k] == run->front[i];
        rows[i] = wanted ? run->front[i] : rows[i];
    }
}

/* Those that are taken move to the beginning; returns how many. */
static size_t gather(size_t n, size_t rows[])
{
    size_t taken = 0;
    for (size_t i = 0; i < n; i++)
        if (rows[i] != NOT_TAKEN)
            rows[taken++] = rows[i];
    return taken;
}

size_t thin_front(const Run *run, size_t most, size_t n_kept, const size_t kept[], size_t rows[])
{
    const size_t n = run->n_front;
    size_t taken = 0;
    if (n <= most) {
        memcpy(rows, run->front, n * sizeof *rows);
        return n;
    }
    for (size_t i = 0; i < n; i++)
        rows[i] = NOT_TAKEN;
    for (size_t column = 0; column < run->schema.n_obj + run->schema.n_var; column++)
        take_extremes(run, column, rows);
    take_wanted(run, n_kept, kept, rows);
    for (size_t i = 0; i < n; i++)
        taken += rows[i] != NOT_TAKEN;
    for (size_t k = taken; k < most; k++) {
        const size_t i = (k - taken) * n / (most - taken);
        rows[i] = run->front[i];
    }
    return gather(n, rows);
}
