#include "store/csv_files.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/clock.h"
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
    export_evaluations(f, &r->table, 0, 0);
}

static void put_front(FILE *f, const void *run)
{
    export_front(f, run);
}

/* Evaluations first: a design that is in front.csv is in evaluations.csv too. */
Status csv_files_replace(const Folder *folder, const Run *run, Err *err)
{
    TRY(folder_write(folder, "evaluations.csv", put_evaluations, run, err));
    return folder_write(folder, "front.csv", put_front, run, err);
}

static CsvFiles csv_files(const Folder *folder, const Schema *schema)
{
    return (CsvFiles){
        .folder = folder, .schema = schema, .search = evaluation_table(schema->n_var, schema->n_obj, schema->n_extra)};
}

Status csv_files_begin(CsvFiles *c, const Folder *folder, const Schema *schema, Err *err)
{
    *c = csv_files(folder, schema);
    TRY(folder_write(folder, "evaluations.csv", put_header, schema, err));
    return append_open(&c->evaluations, folder, "evaluations.csv", err);
}

Status csv_files_resume(CsvFiles *c, const Folder *folder, const Schema *schema, const Run *run, Err *err)
{
    const size_t n = run_n_finished(run);
    *c = csv_files(folder, schema);
    c->run = run;
    for (size_t i = 0; i < n; i++)
        TRY(evaluation_table_append(&c->search, &run->table.row[i], err));
    TRY(folder_write(folder, "evaluations.csv", put_evaluations, run, err));
    if (run->n_generations > 0)
        TRY(folder_write(folder, "front.csv", put_front, run, err));
    return append_open(&c->evaluations, folder, "evaluations.csv", err);
}

Status csv_files_append(CsvFiles *c, Database *db, size_t n, Err *err)
{
    const size_t first = c->search.n;
    TRY(rows_read(db, &c->search, (long)first + 1, (long)n, err));
    if (c->search.n != n)
        return fail(err, STATUS_INTERNAL, "%s: the search knows of %zu simulations, %zu are stored", database_path(db),
                    n, c->search.n);
    export_evaluations(c->evaluations.stream, &c->search, first, 0);
    return append_flush(&c->evaluations, err);
}

/* -- front.csv ----------------------------------------------------------------------------------------------------- */

/* The design in that row as the search sees it now: with the means and deviations of its replicates. */
static Status add_design(const CsvFiles *c, const SearchView *v, size_t row, EvaluationTable *front, Err *err)
{
    TRY(evaluation_table_append(front, &c->search.row[row], err));
    Evaluation *e = &front->row[front->n - 1];
    e->replicates = (int)((long)v->replicates[row] * c->schema->replicates);
    for (size_t k = 0; k < v->n_obj; k++) {
        e->f[k] = schema_objective(c->schema, k)->sense * v->F[row * v->n_obj + k];
        if (v->n_replicates > 0)
            e->sd[k] = v->sd[row * v->n_obj + k] * sqrt((double)c->schema->replicates);
    }
    return STATUS_OK;
}

/* The front of the search and the polished designs, as a run without anything else. */
static Status gather_front(const CsvFiles *c, const SearchView *v, Run *front, Err *err)
{
    EvaluationTable *t = &front->table;
    const size_t polished = c->run ? run_find(c->run, POLISHED_FIRST) : 0, end = c->run ? c->run->table.n : 0;
    for (size_t i = 0; i < v->n; i++)
        if (v->on_front[i])
            TRY(add_design(c, v, i, t, err));
    const size_t n = t->n;
    for (size_t i = polished; i < end; i++)
        TRY(evaluation_table_append(t, &c->run->table.row[i], err));
    front->place = calloc(t->n + 1, sizeof *front->place);
    if (!front->place)
        return fail(err, STATUS_NO_MEMORY, "no memory for a front of %zu designs", t->n);
    for (size_t i = 0; i < t->n; i++)
        front->place[i] = (RunPlace){.ok = i < n || c->run->place[polished + i - n].ok, .on_front = i < n};
    front->F = t->f;
    return run_settle_front(front, err);
}

/* Lines of designs that came onto the front; all of them where replicates change its numbers. */
static Status print_lines(CsvFiles *c, const SearchView *v, const Run *front, Err *err)
{
    char **line = realloc(c->line, (v->n + 1) * sizeof *line);
    size_t length;
    if (!line)
        return fail(err, STATUS_NO_MEMORY, "no memory for %zu designs", v->n);
    memset(line + c->n_lines, 0, (v->n - c->n_lines) * sizeof *line);
    c->line = line;
    c->n_lines = v->n;
    for (size_t i = 0; i < v->n; i++)
        if (!v->on_front[i] || v->n_replicates > 0) {
            free(line[i]);
            line[i] = NULL;
        }
    for (size_t i = 0; i < front->n_front; i++) {
        const long id = front->table.row[front->front[i]].id;
        if (id >= POLISHED_FIRST || line[id - 1])
            continue;
        FILE *f = open_memstream(&line[id - 1], &length);
        if (f)
            export_design(f, front, front->front[i]);
        if (!f || fclose(f) != 0)
            return fail(err, STATUS_NO_MEMORY, "no memory for the front");
    }
    return STATUS_OK;
}

typedef struct {
    const Run *front;
    char **line;
} Lines;

static void put_lines(FILE *f, const void *lines)
{
    const Lines *l = lines;
    export_front_header(f, &l->front->schema);
    for (size_t i = 0; i < l->front->n_front; i++) {
        const size_t row = l->front->front[i];
        const long id = l->front->table.row[row].id;
        if (id < POLISHED_FIRST)
            fputs(l->line[id - 1], f);
        else
            export_design(f, l->front, row);
    }
}

Status csv_files_front(CsvFiles *c, const SearchView *v, Err *err)
{
    const double begun = clock_seconds();
    c->is_behind = v->n > FRONT_ALWAYS && begun < c->next_front;
    if (c->is_behind)
        return STATUS_OK;
    Run front = {.schema = *c->schema, .table = evaluation_table(v->n_var, v->n_obj, c->schema->n_extra)};
    Status status = gather_front(c, v, &front, err);
    if (status == STATUS_OK)
        status = print_lines(c, v, &front, err);
    if (status == STATUS_OK)
        status = folder_write(c->folder, "front.csv", put_lines, &(Lines){&front, c->line}, err);
    evaluation_table_free(&front.table);
    free(front.place);
    free(front.front);
    c->next_front = clock_seconds() + 10.0 * (clock_seconds() - begun);
    return status;
}

Status csv_files_close(CsvFiles *c, Err *err)
{
    return append_close(&c->evaluations, err);
}

void csv_files_free(CsvFiles *c)
{
    append_free(&c->evaluations);
    evaluation_table_free(&c->search);
    for (size_t i = 0; i < c->n_lines; i++)
        free(c->line[i]);
    free(c->line);
    *c = (CsvFiles){0};
}
