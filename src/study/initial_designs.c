#include "study/initial_designs.h"

#include <sys/stat.h>

#include "base/csv.h"
#include "store/run_read.h"

static Status copy_columns(const Table *t, const char *path, const Schema *schema, double *X, Err *err)
{
    for (size_t j = 0; j < schema->n_var; j++) {
        const char *name = schema_variable(schema, j)->name;
        if (table_column(t, name) < 0)
            return bad_data(err, "search.start: %s: has no column %s", path, name);
        for (size_t i = 0; i < t->n_rows; i++) {
            double *x = &X[i * schema->n_var + j];
            if (!schema->kinds[0] || !kinds_number(schema->kinds, j, sheet_text(t, i, name), x))
                TRY(sheet_number(t, i, name, NAN, x, err));
        }
    }
    return STATUS_OK;
}

/* Columns beside the variables may hold anything, as of exported evaluations. */
static Status read_table(const char *path, const Schema *schema, double **X, size_t *n, Err *err)
{
    Table t = {0};
    TRY(table_read(&t, path, TABLE_WORDS, err));
    *X = calloc(t.n_rows * schema->n_var + 1, sizeof **X);
    *n = t.n_rows;
    const Status status = *X ? copy_columns(&t, path, schema, *X, err) : fail_memory(err, t.n_rows, "designs");
    table_free(&t);
    return status;
}

static Status copy_front(const Run *run, const Schema *schema, double **X, size_t *n, Err *err)
{
    const size_t n_var = run->schema.n_var;
    if (n_var != schema->n_var)
        return bad_data(err, "search.start: %s: its designs have %zu variables, this search has %zu", run->folder,
                        n_var, schema->n_var);
    TRY_ROOM(*X, run->n_front * n_var + 1, "designs", err);
    for (size_t i = 0; i < run->n_front; i++)
        memcpy(*X + i * n_var, run_x(run, run->front[i]), n_var * sizeof **X);
    *n = run->n_front;
    return STATUS_OK;
}

static Status read_front(const char *folder, const Schema *schema, double **X, size_t *n, Err *err)
{
    Run run;
    TRY(run_read(&run, folder, err));
    const Status status = copy_front(&run, schema, X, n, err);
    run_free(&run);
    return status;
}

Status initial_designs_read(const char *start, const Schema *schema, double **X, size_t *n, Err *err)
{
    struct stat there;
    *X = NULL;
    *n = 0;
    if (strcmp(start, "none") == 0)
        return STATUS_OK;
    if (stat(start, &there) != 0)
        return fail(err, STATUS_MISSING, "search.start: %s: is not there", start);
    const Status status =
        S_ISDIR(there.st_mode) ? read_front(start, schema, X, n, err) : read_table(start, schema, X, n, err);
    if (status != STATUS_OK) {
        free(*X);
        *X = NULL;
    }
    return status;
}
