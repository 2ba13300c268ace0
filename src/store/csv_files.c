#include "store/csv_files.h"

#include <math.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include "base/clock.h"
#include "store/export.h"
#include "store/output.h"
#include "store/run_read.h"

static void put_header(FILE *f, const void *schema)
{
    export_evaluations_header(f, schema);
}

static void put_evaluations(FILE *f, const void *run)
{
    const Run *r = run;
    export_evaluations_header(f, &r->schema);
    export_evaluations(f, &r->table);
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

static size_t n_kept(const Schema *schema)
{
    return (schema->has_spread ? schema->n_obj : 0) + schema->n_limited;
}

Status csv_files_begin(CsvFiles *c, const Folder *folder, const Schema *schema, Err *err)
{
    *c = (CsvFiles){.folder = folder, .schema = schema, .n_kept = n_kept(schema)};
    TRY(folder_write(folder, "evaluations.csv", put_header, schema, err));
    return append_open(&c->evaluations, folder, "evaluations.csv", err);
}

/* Of the first n rows of the table, behind those that are known. */
static Status keep(CsvFiles *c, size_t n, const EvaluationTable *t, Err *err)
{
    const Schema *s = c->schema;
    if (c->n_kept == 0 || n == 0)
        return STATUS_OK;
    double *wider = realloc(c->kept, (c->n_appended + n) * c->n_kept * sizeof *wider);
    if (!wider)
        return fail(err, STATUS_NO_MEMORY, "no memory for %zu designs", c->n_appended + n);
    c->kept = wider;
    wider += c->n_appended * c->n_kept;
    for (size_t i = 0; i < n; i++, wider += c->n_kept) {
        memcpy(wider, t->row[i].sd, (c->n_kept - s->n_limited) * sizeof *wider);
        schema_limited(s, t->row[i].extra, wider + c->n_kept - s->n_limited);
    }
    return STATUS_OK;
}

/* front.csv has the lines of a front of this run. */
static void know_front(CsvFiles *c)
{
    char path[PATH_MAX];
    folder_path(c->folder, "front.csv", path);
    if (lstat(path, &c->front) != 0)
        c->front.st_ino = 0;
}

Status csv_files_resume(CsvFiles *c, const Folder *folder, const Schema *schema, const Run *run, Err *err)
{
    const size_t n = run_n_finished(run);
    *c = (CsvFiles){.folder = folder, .schema = schema, .run = run, .n_kept = n_kept(schema)};
    TRY(keep(c, n, &run->table, err));
    c->n_appended = n;
    if (run->n_ahead == 0)
        TRY(folder_write(folder, "evaluations.csv", put_evaluations, run, err));
    if (run->n_ahead == 0 && run->n_generations > 0) {
        TRY(folder_write(folder, "front.csv", put_front, run, err));
        know_front(c);
    }
    return append_open(&c->evaluations, folder, "evaluations.csv", err);
}

/* Opened behind its header, if it has that. */
static void open_lines(const CsvFiles *c, const char *name, RunHeader *header, RowLines *l)
{
    char path[PATH_MAX], *wanted = NULL;
    size_t length;
    folder_path(c->folder, name, path);
    *l = (RowLines){.f = fopen(path, "re")};
    if (l->f)
        setvbuf(l->f, l->buffer, _IOFBF, sizeof l->buffer);
    FILE *f = open_memstream(&wanted, &length);
    if (f)
        header(f, c->schema);
    l->are_same = f && fclose(f) == 0 && l->f && getline(&l->line, &l->room, l->f) > 0 && strcmp(l->line, wanted) == 0;
    free(wanted);
}

/* Whether all was the same, to its end. */
static int close_lines(RowLines *l)
{
    const int are_same = l->are_same && getc(l->f) == EOF;
    if (l->f)
        fclose(l->f);
    free(l->line);
    return are_same;
}

void csv_files_pass(const CsvFiles *c, CsvPassing *p)
{
    open_lines(c, "evaluations.csv", export_evaluations_header, &p->lines);
    open_lines(c, "front.csv", export_front_header, &p->front);
}

/* Without replicates a line of front.csv is the number and the cells of that of evaluations.csv. */
void csv_files_pass_design(const CsvFiles *c, CsvPassing *p, long id)
{
    RowLines *l = &p->front;
    const size_t n = p->lines.n_cells;
    char *at;
    if (!c->run->place[id - 1].on_front || !l->are_same)
        return;
    l->are_same = p->lines.are_same && getline(&l->line, &l->room, l->f) > 0 && strtol(l->line, &at, 10) == id &&
                  strncmp(at, p->lines.cells, n) == 0 && strcmp(at + n, "\n") == 0;
}

static Status reprint(const CsvFiles *c, Database *db, const char *name, Err *err)
{
    const Schema *s = c->schema;
    char path[PATH_MAX];
    Output o;
    size_t printed;
    folder_path(c->folder, name, path);
    TRY(output_open_inside(&o, path, err));
    if (strcmp(name, "front.csv") == 0)
        return output_end(&o, export_front_of(o.stream, c->folder->path, err), err);
    export_evaluations_header(o.stream, s);
    return output_end(
        &o,
        rows_print(db, o.stream, (RowShape){s->n_var, s->n_obj, s->n_extra}, 1, (long)c->n_appended, 0, &printed, err),
        err);
}

Status csv_files_passed(CsvFiles *c, CsvPassing *p, Database *db, Status passed, Err *err)
{
    const int are_same = close_lines(&p->lines), front_is_same = close_lines(&p->front);
    TRY(passed);
    if (!front_is_same)
        TRY(reprint(c, db, "front.csv", err));
    know_front(c);
    if (are_same)
        return STATUS_OK;
    append_free(&c->evaluations);
    TRY(reprint(c, db, "evaluations.csv", err));
    return append_open(&c->evaluations, c->folder, "evaluations.csv", err);
}

static Status read_kept(CsvFiles *c, Database *db, size_t n, Err *err)
{
    EvaluationTable rows = evaluation_table(c->schema->n_var, c->schema->n_obj, c->schema->n_extra);
    Status status = rows_read(db, &rows, (long)c->n_appended + 1, (long)n, err);
    if (status == STATUS_OK)
        status = keep(c, rows.n, &rows, err);
    evaluation_table_free(&rows);
    return status;
}

Status csv_files_append(CsvFiles *c, Database *db, size_t n, Err *err)
{
    const Schema *s = c->schema;
    size_t printed;
    if (n == c->n_appended)
        return STATUS_OK;
    TRY(rows_print(db, c->evaluations.stream, (RowShape){s->n_var, s->n_obj, s->n_extra}, (long)c->n_appended + 1,
                   (long)n, 0, &printed, err));
    if (printed != n - c->n_appended)
        return fail(err, STATUS_INTERNAL, "%s: the search knows of %zu simulations, %zu are stored", database_path(db),
                    n, c->n_appended + printed);
    if (c->n_kept > 0)
        TRY(read_kept(c, db, n, err));
    c->n_appended = n;
    return append_flush(&c->evaluations, err);
}

/* -- front.csv ----------------------------------------------------------------------------------------------------- */

typedef struct {
    const CsvFiles *files;
    const SearchView *view;
    FILE *before; /* front.csv as it is; NULL: its lines are of no use */
} Front;

typedef struct {
    double f[OBJECTIVES_MAX], sd[OBJECTIVES_MAX], extra[N_MEASURES];
} Numbers;

/* The design in that row as the search sees it now: with the means and deviations of its replicates. Borrows x. */
static Evaluation design_at(const Front *front, size_t row, Numbers *to)
{
    const SearchView *v = front->view;
    const CsvFiles *c = front->files;
    const Schema *s = c->schema;
    const double *kept = c->kept ? c->kept + row * c->n_kept : NULL;
    for (size_t k = 0; k < v->n_obj; k++) {
        to->f[k] = schema_objective(s, k)->sense * v->F[row * v->n_obj + k];
        to->sd[k] = v->n_replicates > 0     ? v->sd[row * v->n_obj + k] * sqrt((double)s->replicates)
                    : kept && s->has_spread ? kept[k]
                                            : NAN;
    }
    for (size_t k = 0; k < s->n_extra; k++)
        to->extra[k] = NAN;
    for (size_t k = 0; kept && k < s->n_limited; k++)
        to->extra[s->limited[k]] = kept[c->n_kept - s->n_limited + k];
    return (Evaluation){.id = (long)row + 1,
                        .kind = (EvaluationKind)v->kind[row],
                        .replicates = (int)((long)v->replicates[row] * s->replicates),
                        .x = (double *)(uintptr_t)(v->X + row * v->n_var),
                        .f = to->f,
                        .sd = to->sd,
                        .extra = to->extra};
}

/* A line of the file before and the number that it begins with; 0: there is none any more. */
typedef struct {
    FILE *file;
    char *text;
    size_t room;
    ssize_t length;
    long id;
} Line;

static void next_line(Line *l)
{
    l->length = l->file ? getline(&l->text, &l->room, l->file) : 0;
    l->id = l->length > 0 && l->text[l->length - 1] == '\n' ? strtol(l->text, NULL, 10) : 0;
}

static void put_front_of_search(FILE *f, const void *user)
{
    const Front *front = user;
    Numbers numbers;
    Line line = {.file = front->before};
    export_front_header(f, front->files->schema);
    next_line(&line); /* the header */
    next_line(&line);
    for (size_t i = 0; i < front->view->n; i++) {
        if (!front->view->on_front[i])
            continue;
        while (line.id > 0 && line.id < (long)i + 1)
            next_line(&line);
        if (line.id == (long)i + 1) {
            fwrite(line.text, 1, (size_t)line.length, f);
            continue;
        }
        const Evaluation e = design_at(front, i, &numbers);
        export_design_as(f, front->files->schema, &e, numbers.f);
    }
    free(line.text);
}

/* The front of the search and the polished designs, as a run without anything else. */
static Status gather_front(const Front *from, Run *front, Err *err)
{
    EvaluationTable *t = &front->table;
    const Run *run = from->files->run;
    const size_t polished = run_first_polished(run);
    Numbers numbers;
    for (size_t i = 0; i < from->view->n; i++)
        if (from->view->on_front[i]) {
            const Evaluation e = design_at(from, i, &numbers);
            TRY(evaluation_table_append(t, &e, err));
        }
    const size_t n = t->n;
    for (size_t i = polished; i < run->table.n; i++)
        TRY(evaluation_table_append(t, &run->table.row[i], err));
    front->place = calloc(t->n + 1, sizeof *front->place);
    if (!front->place)
        return fail(err, STATUS_NO_MEMORY, "no memory for a front of %zu designs", t->n);
    for (size_t i = 0; i < t->n; i++)
        front->place[i] = (RunPlace){.ok = i < n || run->place[polished + i - n].ok, .on_front = i < n};
    front->F = t->f;
    return run_settle_front(front, err);
}

static Status replace_joined_front(const Front *from, Err *err)
{
    const Schema *schema = from->files->schema;
    Run front = {.schema = *schema, .table = evaluation_table(schema->n_var, schema->n_obj, schema->n_extra)};
    Status status = gather_front(from, &front, err);
    if (status == STATUS_OK)
        status = folder_write(from->files->folder, "front.csv", put_front, &front, err);
    evaluation_table_free(&front.table);
    free(front.place);
    free(front.front);
    return status;
}

/* Without replicates, and if nothing else has touched it. */
static FILE *front_before(const CsvFiles *c, const SearchView *v)
{
    char path[PATH_MAX];
    struct stat now;
    folder_path(c->folder, "front.csv", path);
    FILE *f = c->front.st_ino != 0 && v->n_replicates == 0 ? fopen(path, "re") : NULL;
    if (!f || (fstat(fileno(f), &now) == 0 && now.st_ino == c->front.st_ino && now.st_size == c->front.st_size &&
               now.st_mtim.tv_sec == c->front.st_mtim.tv_sec && now.st_mtim.tv_nsec == c->front.st_mtim.tv_nsec))
        return f;
    fclose(f);
    return NULL;
}

static Status replace_front(const CsvFiles *c, const SearchView *v, Err *err)
{
    char buffer[1 << 16];
    Front front = {c, v, NULL};
    if (c->run && run_has_polished(c->run))
        return replace_joined_front(&front, err);
    front.before = front_before(c, v);
    if (front.before)
        setvbuf(front.before, buffer, _IOFBF, sizeof buffer);
    const Status status = folder_write(c->folder, "front.csv", put_front_of_search, &front, err);
    if (front.before)
        fclose(front.before);
    return status;
}

Status csv_files_front(CsvFiles *c, const SearchView *v, Err *err)
{
    const double begun = clock_seconds();
    c->is_behind = v->n > FRONT_ALWAYS && begun < c->next_front && !v->is_last;
    if (c->is_behind)
        return STATUS_OK;
    TRY(replace_front(c, v, err));
    know_front(c);
    c->next_front = clock_seconds() + 20.0 * (clock_seconds() - begun);
    return STATUS_OK;
}

Status csv_files_close(CsvFiles *c, Err *err)
{
    return append_close(&c->evaluations, err);
}

void csv_files_free(CsvFiles *c)
{
    append_free(&c->evaluations);
    free(c->kept);
    *c = (CsvFiles){0};
}
