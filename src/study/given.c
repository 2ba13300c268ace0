#include "study/given.h"

#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

#include "store/front.h"

static Status copy_columns(const Table *t, const char *path, const Schema *schema, double *X, Err *err)
{
    for (size_t j = 0; j < schema->n_var; j++) {
        const int column = table_column(t, schema_variable(schema, j)->name);
        if (column < 0)
            return fail(err, STATUS_BAD_DATA, "search.start: %s: has no column %s", path,
                        schema_variable(schema, j)->name);
        for (size_t i = 0; i < t->n_rows; i++)
            X[i * schema->n_var + j] = t->values[i * t->n_cols + (size_t)column];
    }
    return STATUS_OK;
}

static Status read_table(const char *path, const Schema *schema, double **X, size_t *n, Err *err)
{
    Table t = {0};
    TRY(table_read(&t, path, 1, err));
    *X = calloc(t.n_rows * schema->n_var + 1, sizeof **X);
    *n = t.n_rows;
    const Status status = *X ? copy_columns(&t, path, schema, *X, err)
                             : fail(err, STATUS_NO_MEMORY, "no memory for %zu designs", t.n_rows);
    table_free(&t);
    return status;
}

static Status read_run(const char *folder, const Schema *schema, double **X, size_t *n, Err *err)
{
    Front front;
    TRY(front_read(&front, folder, err));
    Status status = STATUS_OK;
    if (front.schema.n_var != schema->n_var)
        status = fail(err, STATUS_BAD_DATA, "search.start: %s: its designs have %zu variables, this search has %zu",
                      folder, front.schema.n_var, schema->n_var);
    else if (!(*X = calloc(front.n * schema->n_var + 1, sizeof **X)))
        status = fail(err, STATUS_NO_MEMORY, "no memory for %zu designs", front.n);
    for (size_t i = 0; status == STATUS_OK && i < front.n; i++)
        memcpy(*X + i * schema->n_var, front_x(&front, i), schema->n_var * sizeof **X);
    *n = front.n;
    front_free(&front);
    return status;
}

Status given_read(const char *start, const Schema *schema, double **X, size_t *n, Err *err)
{
    struct stat there;
    *X = NULL;
    *n = 0;
    if (strcmp(start, "none") == 0)
        return STATUS_OK;
    if (stat(start, &there) != 0)
        return fail(err, STATUS_MISSING, "search.start: %s: is not there", start);
    const Status status =
        S_ISDIR(there.st_mode) ? read_run(start, schema, X, n, err) : read_table(start, schema, X, n, err);
    if (status != STATUS_OK) {
        free(*X);
        *X = NULL;
    }
    return status;
}
