#include "scene/design.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

void design_variable_name(int n_floors, int j, char name[TABLE_NAME_MAX])
{
    if (j < n_floors)
        snprintf(name, TABLE_NAME_MAX, "gap_%02d_m", j + 1);
    else
        snprintf(name, TABLE_NAME_MAX, "%s", j == n_floors ? "t_base_m" : "t_top_m");
}

static Status check_names(const Table *t, const char *path, int n_floors, Err *err)
{
    char name[TABLE_NAME_MAX];
    const size_t n_var = (size_t)n_floors + 2;
    for (size_t j = 0; j < n_var && j < t->n_cols; j++) {
        design_variable_name(n_floors, (int)j, name);
        if (strcmp(t->names[j], name) != 0)
            return fail(err, STATUS_BAD_DATA,
                        "%s: column %zu of the header is '%s'; a design of %d floors has %s there", path, j + 1,
                        t->names[j], n_floors, name);
    }
    if (t->n_cols != n_var)
        return fail(
            err, STATUS_BAD_DATA,
            "%s: the header has %zu columns; a design of %d floors has %zu: gap_01_m..gap_%02d_m,t_base_m,t_top_m",
            path, t->n_cols, n_floors, n_var, n_floors);
    return STATUS_OK;
}

static Status check_values(const Designs *d, const char *path, Err *err)
{
    char name[TABLE_NAME_MAX];
    const int n_var = d->n_floors + 2;
    for (size_t i = 0; i < d->n; i++)
        for (int j = 0; j < n_var; j++) {
            const double value = d->x[i * (size_t)n_var + (size_t)j];
            design_variable_name(d->n_floors, j, name);
            if (j < d->n_floors && value < 0)
                return fail(err, STATUS_BAD_DATA, "%s:%d: %s is %g; a gap is not negative", path, d->line[i], name,
                            value);
            if (j >= d->n_floors && value <= 0)
                return fail(err, STATUS_BAD_DATA, "%s:%d: %s is %g; a thickness must be above 0", path, d->line[i],
                            name, value);
        }
    return STATUS_OK;
}

Status design_of_table(Designs *d, Table *t, const char *path, int n_floors, Err *err)
{
    memset(d, 0, sizeof *d);
    TRY(check_names(t, path, n_floors, err));
    if (t->n_rows == 0)
        return fail(err, STATUS_BAD_DATA, "%s: holds no designs", path);
    *d = (Designs){.n = t->n_rows, .n_floors = n_floors, .x = t->values, .line = t->line};
    t->values = NULL;
    t->line = NULL;
    const Status status = check_values(d, path, err);
    if (status != STATUS_OK)
        design_free(d);
    return status;
}

Status design_read(Designs *d, const char *path, int n_floors, Err *err)
{
    Table t;
    memset(d, 0, sizeof *d);
    TRY(table_read(&t, path, 1, err));
    const Status status = design_of_table(d, &t, path, n_floors, err);
    table_free(&t);
    return status;
}

void design_free(Designs *d)
{
    free(d->x);
    free(d->line);
    free(d->id);
    memset(d, 0, sizeof *d);
}
