#include "store/front_lines.h"

#include <stdlib.h>
#include <string.h>

#include "store/export.h"

static Status make_line(FrontLines *lines, const SearchView *v, size_t row, Err *err)
{
    double natural[OBJECTIVES_MAX];
    size_t length;
    FILE *f = open_memstream(&lines->line[row], &length);
    for (size_t k = 0; f && k < v->n_obj; k++)
        natural[k] = schema_objective(lines->schema, k)->sense * v->F[row * v->n_obj + k];
    if (f)
        export_front_row(f, lines->schema, &(FrontRow){.id = (long)row + 1, .x = v->X + row * v->n_var, .f = natural});
    return f && fclose(f) == 0 ? STATUS_OK : fail(err, STATUS_NO_MEMORY, "no memory for the front");
}

Status front_lines_follow(FrontLines *lines, const Schema *schema, const SearchView *v, Err *err)
{
    char **line = realloc(lines->line, (v->n + 1) * sizeof *line);
    if (!line)
        return fail(err, STATUS_NO_MEMORY, "no memory for %zu designs", v->n);
    memset(line + lines->n, 0, (v->n - lines->n) * sizeof *line);
    lines->schema = schema;
    lines->line = line;
    lines->n = v->n;
    for (size_t i = 0; i < v->n; i++) {
        if (v->on_front[i] && !line[i])
            TRY(make_line(lines, v, i, err));
        if (v->on_front[i])
            continue;
        free(line[i]);
        line[i] = NULL;
    }
    return STATUS_OK;
}

void front_lines_put(FILE *f, const void *user)
{
    const FrontLines *lines = user;
    export_front_header(f, lines->schema);
    for (size_t i = 0; i < lines->n; i++)
        if (lines->line[i])
            fputs(lines->line[i], f);
}

void front_lines_free(FrontLines *lines)
{
    for (size_t i = 0; i < lines->n; i++)
        free(lines->line[i]);
    free(lines->line);
    *lines = (FrontLines){0};
}
