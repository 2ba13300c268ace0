#include "study/initial_designs.h"

#include <sys/stat.h>

#include "base/csv.h"
#include "store/run_read.h"

static Status copy_columns(const Table *t, const char *where, const Schema *schema, double *X, Err *err)
{
    for (size_t j = 0; j < schema->n_var; j++) {
        const char *name = schema_variable(schema, j)->name;
        if (table_column(t, name) < 0)
            return bad_data(err, "%s: %s: has no column %s", where, t->path, name);
        for (size_t i = 0; i < t->n_rows; i++) {
            double *x = &X[i * schema->n_var + j];
            if (!schema->kinds[0] || !kinds_number(schema->kinds, j, sheet_text(t, i, name), x))
                TRY(sheet_number(t, i, name, NAN, x, err));
        }
    }
    return STATUS_OK;
}

/* Columns beside the variables may hold anything, as of exported evaluations. */
static Status read_table(const char *where, const char *path, const Schema *schema, double **X, size_t *n, Err *err)
{
    Table t = {0};
    TRY(table_read(&t, path, TABLE_WORDS, err));
    *X = calloc(t.n_rows * schema->n_var + 1, sizeof **X);
    *n = t.n_rows;
    const Status status = *X ? copy_columns(&t, where, schema, *X, err) : fail_memory(err, t.n_rows, "designs");
    table_free(&t);
    return status;
}

Status initial_designs_fit(const Run *run, const char *where, const Schema *schema, Err *err)
{
    const Schema *there = &run->schema;
    if (there->n_var != schema->n_var)
        return bad_data(err, "%s: %s: its designs have %zu variables, here they have %zu", where, run->folder,
                        there->n_var, schema->n_var);
    for (size_t j = 0; j < schema->n_var; j++)
        if (strcmp(schema_variable(there, j)->name, schema_variable(schema, j)->name) != 0)
            return bad_data(err, "%s: %s: variable %zu of its designs is %s, here it is %s", where, run->folder, j + 1,
                            schema_variable(there, j)->name, schema_variable(schema, j)->name);
    return strcmp(there->kinds, schema->kinds) == 0
               ? STATUS_OK
               : bad_data(err, "%s: %s: its problem.kinds are '%s', here they are '%s'", where, run->folder,
                          there->kinds, schema->kinds);
}

static Status copy_front(const char *where, const Run *run, const Schema *schema, double **X, size_t *n, Err *err)
{
    const size_t n_var = schema->n_var;
    TRY(initial_designs_fit(run, where, schema, err));
    TRY_ROOM(*X, run->n_front * n_var + 1, "designs", err);
    for (size_t i = 0; i < run->n_front; i++)
        memcpy(*X + i * n_var, run_x(run, run->front[i]), n_var * sizeof **X);
    *n = run->n_front;
    return STATUS_OK;
}

static Status read_front(const char *where, const char *folder, const Schema *schema, double **X, size_t *n, Err *err)
{
    Run run;
    TRY(run_read(&run, folder, err));
    const Status status = copy_front(where, &run, schema, X, n, err);
    run_free(&run);
    return status;
}

/* Behind the n designs that X has. */
static Status append(const char *where, const char *start, const Schema *schema, double **X, size_t *n, Err *err)
{
    struct stat there;
    double *more = NULL, *all;
    size_t n_more = 0;
    if (stat(start, &there) != 0)
        return fail(err, STATUS_MISSING, "%s: %s: is not there", where, start);
    Status status = S_ISDIR(there.st_mode) ? read_front(where, start, schema, &more, &n_more, err)
                                           : read_table(where, start, schema, &more, &n_more, err);
    const size_t size = schema->n_var * sizeof *more;
    all = status == STATUS_OK ? realloc(*X, (*n + n_more + 1) * size) : NULL;
    if (all) {
        memcpy(all + *n * schema->n_var, more, n_more * size);
        *X = all;
        *n += n_more;
    } else if (status == STATUS_OK) {
        status = fail_memory(err, n_more, "designs");
    }
    free(more);
    return status;
}

Status initial_designs_read(const char *where, const char *start, const Schema *schema, double **X, size_t *n, Err *err)
{
    char item[OPTION_TEXT_MAX];
    Status status = STATUS_OK;
    *X = NULL;
    *n = 0;
    for (size_t i = 0; strcmp(start, "none") != 0 && status == STATUS_OK && i < list_count(start); i++)
        status = list_item(start, i, item, sizeof item) ? append(where, item, schema, X, n, err)
                                                        : bad_data(err, "%s: item %zu is empty", where, i + 1);
    if (status != STATUS_OK) {
        free(*X);
        *X = NULL;
    }
    return status;
}
