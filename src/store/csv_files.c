#include "store/csv_files.h"

#include <stdlib.h>
#include <string.h>

#include "store/export.h"
#include "store/rows.h"

static void put_header(FILE *f, const void *schema)
{
    export_evaluations_header(f, schema);
}

static void put_evaluations(FILE *f, const void *run)
{
    const Run *r = run;
    export_evaluations_header(f, &r->schema);
    export_evaluations(f, &r->table, 0);
}

static void put_front(FILE *f, const void *run)
{
    export_front(f, run);
}

/* Evaluations first: a design that is in front.csv is in evaluations.csv too. */
Status csv_files_replace(const Folder *folder, const Run *run, int evaluations_too, Err *err)
{
    if (evaluations_too)
        TRY(folder_write(folder, "evaluations.csv", put_evaluations, run, err));
    return folder_write(folder, "front.csv", put_front, run, err);
}

Status csv_files_begin(CsvFiles *c, const Folder *folder, const Schema *schema, Err *err)
{
    *c = (CsvFiles){.folder = folder, .schema = schema};
    TRY(folder_write(folder, "evaluations.csv", put_header, schema, err));
    return append_open(&c->evaluations, folder, "evaluations.csv", err);
}

Status csv_files_resume(CsvFiles *c, const Folder *folder, const Schema *schema, const Run *run, Err *err)
{
    *c = (CsvFiles){.folder = folder, .schema = schema, .n_appended = run_n_finished(run)};
    TRY(folder_write(folder, "evaluations.csv", put_evaluations, run, err));
    if (run->n_generations > 0)
        TRY(folder_write(folder, "front.csv", put_front, run, err));
    return append_open(&c->evaluations, folder, "evaluations.csv", err);
}

Status csv_files_append(CsvFiles *c, Database *db, size_t n, Err *err)
{
    EvaluationTable t = evaluation_table(c->schema->n_var, c->schema->n_obj, c->schema->n_extra);
    Status status = rows_read(db, &t, (long)c->n_appended + 1, (long)n, err);
    if (status == STATUS_OK && t.n != n - c->n_appended)
        status = fail(err, STATUS_INTERNAL, "%s: the search knows of %zu simulations, %zu are stored",
                      database_path(db), n, c->n_appended + t.n);
    if (status == STATUS_OK)
        export_evaluations(c->evaluations.stream, &t, 0);
    evaluation_table_free(&t);
    TRY(status);
    c->n_appended = n;
    return append_flush(&c->evaluations, err);
}

/* -- front.csv ----------------------------------------------------------------------------------------------------- */

static Status make_line(CsvFiles *c, const SearchView *v, size_t row, Err *err)
{
    double natural[OBJECTIVES_MAX];
    size_t length;
    FILE *f = open_memstream(&c->line[row], &length);
    for (size_t k = 0; f && k < v->n_obj; k++)
        natural[k] = schema_objective(c->schema, k)->sense * v->F[row * v->n_obj + k];
    if (f)
        export_front_row(f, c->schema, &(FrontRow){.id = (long)row + 1, .x = v->X + row * v->n_var, .f = natural});
    return f && fclose(f) == 0 ? STATUS_OK : fail(err, STATUS_NO_MEMORY, "no memory for the front");
}

static Status follow(CsvFiles *c, const SearchView *v, Err *err)
{
    char **line = realloc(c->line, (v->n + 1) * sizeof *line);
    if (!line)
        return fail(err, STATUS_NO_MEMORY, "no memory for %zu designs", v->n);
    memset(line + c->n_lines, 0, (v->n - c->n_lines) * sizeof *line);
    c->line = line;
    c->n_lines = v->n;
    for (size_t i = 0; i < v->n; i++) {
        if (v->on_front[i] && !line[i])
            TRY(make_line(c, v, i, err));
        if (v->on_front[i])
            continue;
        free(line[i]);
        line[i] = NULL;
    }
    return STATUS_OK;
}

static void put_lines(FILE *f, const void *files)
{
    const CsvFiles *c = files;
    export_front_header(f, c->schema);
    for (size_t i = 0; i < c->n_lines; i++)
        if (c->line[i])
            fputs(c->line[i], f);
}

Status csv_files_front(CsvFiles *c, const SearchView *v, Err *err)
{
    TRY(follow(c, v, err));
    return folder_write(c->folder, "front.csv", put_lines, c, err);
}

Status csv_files_close(CsvFiles *c, Err *err)
{
    return append_close(&c->evaluations, err);
}

void csv_files_free(CsvFiles *c)
{
    append_free(&c->evaluations);
    for (size_t i = 0; i < c->n_lines; i++)
        free(c->line[i]);
    free(c->line);
    *c = (CsvFiles){0};
}
