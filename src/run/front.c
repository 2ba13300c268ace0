#include "run/front.h"

#include <limits.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/design.h"

static Status check_columns(const Front *front, const char *path, Err *err)
{
    char want[TABLE_NAME_MAX];
    const Table *t = &front->table;
    for (size_t j = 0; front->n_var >= 3 && j < t->n_cols; j++) {
        const int k = (int)j - 1 - front->n_var;
        if (j == 0)
            snprintf(want, sizeof want, "id");
        else if (k < 0)
            design_variable_name(front->n_var - 2, (int)j - 1, want);
        else
            snprintf(want, sizeof want, "%s", measure(k)->name);
        if (strcmp(t->names[j], want) != 0)
            return fail(err, STATUS_BAD_DATA, "%s: column %zu is '%s', expected %s", path, j + 1, t->names[j], want);
    }
    if (front->n_var < 3)
        return fail(err, STATUS_BAD_DATA, "%s: %zu columns are not a front", path, t->n_cols);
    return STATUS_OK;
}

Status front_read(Front *front, const char *folder, Err *err)
{
    char path[PATH_MAX];
    memset(front, 0, sizeof *front);
    if (snprintf(path, sizeof path, "%s/front.csv", folder) >= (int)sizeof path)
        return fail(err, STATUS_MISSING, "%.200s...: the path is too long", folder);
    TRY(table_read(&front->table, path, 1, err));
    front->n = front->table.n_rows;
    front->n_var = (int)front->table.n_cols - 1 - N_OBJECTIVES;
    const Status status = check_columns(front, path, err);
    if (status != STATUS_OK)
        front_free(front);
    return status;
}

static const double *row(const Front *front, size_t i)
{
    return front->table.values + i * front->table.n_cols;
}

long front_id(const Front *front, size_t i)
{
    return (long)row(front, i)[0];
}

const double *front_x(const Front *front, size_t i)
{
    return row(front, i) + 1;
}

const double *front_f(const Front *front, size_t i)
{
    return row(front, i) + 1 + front->n_var;
}

size_t front_best(const Front *front, int objective)
{
    const double sense = measure(objective)->sense;
    size_t best = 0;
    for (size_t i = 1; i < front->n; i++)
        if (sense * front_f(front, i)[objective] < sense * front_f(front, best)[objective])
            best = i;
    return best;
}

size_t front_knee(const Front *front)
{
    double ideal[N_OBJECTIVES], span[N_OBJECTIVES];
    for (int k = 0; k < N_OBJECTIVES; k++) {
        const double sense = measure(k)->sense;
        double worst = -INFINITY;
        ideal[k] = sense * front_f(front, front_best(front, k))[k];
        for (size_t i = 0; i < front->n; i++)
            worst = fmax(worst, sense * front_f(front, i)[k]);
        span[k] = worst - ideal[k];
    }
    size_t knee = 0;
    double least = INFINITY;
    for (size_t i = 0; i < front->n; i++) {
        double d2 = 0;
        for (int k = 0; k < N_OBJECTIVES; k++) {
            const double d = measure(k)->sense * front_f(front, i)[k] - ideal[k];
            d2 += span[k] > 0 ? d * d / (span[k] * span[k]) : 0;
        }
        if (d2 < least) {
            least = d2;
            knee = i;
        }
    }
    return knee;
}

size_t front_find(const Front *front, long id)
{
    size_t i = 0;
    while (i < front->n && front_id(front, i) != id)
        i++;
    return i;
}

void front_free(Front *front)
{
    table_free(&front->table);
    memset(front, 0, sizeof *front);
}
