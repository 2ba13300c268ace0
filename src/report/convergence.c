#include "report/convergence.h"

#include <limits.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "base/random.h"
#include "moga/dominance.h"
#include "moga/hypervolume.h"

enum { SAMPLES = 20000, EXACT_MAX = 3, CELLS_MAX = 512 };
static const double MARGIN = 1.1; /* so that the worst of each objective still counts */

/* ---- the file -------------------------------------------------------------------------------------------------- */

/* Cells of one line, cut in place; quotes are respected. Returns their number; *line moves to the next line. */
static size_t cut_line(char **line, char *cells[CELLS_MAX])
{
    size_t n = 0;
    char *p = *line;
    int quoted = 0;
    cells[n++] = p;
    for (; *p && (quoted || *p != '\n'); p++) {
        if (*p == '"')
            quoted = !quoted;
        if (quoted || *p != ',')
            continue;
        *p = 0;
        if (n < CELLS_MAX)
            cells[n++] = p + 1;
    }
    *line = *p ? p + 1 : p;
    *p = 0;
    return n;
}

typedef struct {
    size_t n_columns, generation, objective[OBJECTIVES_MAX];
} Places;

static Status find_places(const Front *front, size_t n, char *cells[], const char *path, Places *at, Err *err)
{
    at->n_columns = n;
    at->generation = n;
    for (size_t k = 0; k < front->n_obj; k++)
        at->objective[k] = n;
    for (size_t i = 0; i < n; i++) {
        const size_t k = schema_find_objective(&front->schema, cells[i]);
        if (strcmp(cells[i], "generation") == 0)
            at->generation = i;
        else if (k < front->n_obj)
            at->objective[k] = i;
    }
    for (size_t k = 0; k < front->n_obj; k++)
        if (at->objective[k] == n || at->generation == n)
            return fail(err, STATUS_BAD_DATA, "%s: no column generation or no column %s", path,
                        schema_objective(&front->schema, k)->name);
    return STATUS_OK;
}

static double number_in(const char *cell)
{
    char *end;
    const double value = strtod(cell, &end);
    return end == cell ? NAN : value;
}

static Status parse(const Front *front, char *text, size_t room, const char *path, double generation[], double F[],
                    size_t *n, Err *err)
{
    char *cells[CELLS_MAX], *line = text;
    Places at;
    TRY(find_places(front, cut_line(&line, cells), cells, path, &at, err));
    for (*n = 0; *line && *n < room;) {
        const size_t count = cut_line(&line, cells);
        if (count != at.n_columns)
            return fail(err, STATUS_BAD_DATA, "%s: row %zu has %zu columns, the header %zu", path, *n + 1, count,
                        at.n_columns);
        generation[*n] = number_in(cells[at.generation]);
        for (size_t k = 0; k < front->n_obj; k++)
            F[*n * front->n_obj + k] = schema_objective(&front->schema, k)->sense * number_in(cells[at.objective[k]]);
        ++*n;
    }
    return STATUS_OK;
}

static size_t count_lines(const char *text)
{
    size_t n = 1;
    for (; *text; text++)
        n += *text == '\n';
    return n;
}

Status convergence_read(const Front *front, const char *folder, Convergence *out, Err *err)
{
    char path[PATH_MAX], *text;
    size_t length, n = 0;
    double ideal[OBJECTIVES_MAX], span[OBJECTIVES_MAX];
    memset(out, 0, sizeof *out);
    if (snprintf(path, sizeof path, "%s/evaluations.csv", folder) >= (int)sizeof path || access(path, F_OK) != 0 ||
        front->n == 0)
        return STATUS_OK;
    TRY(file_read(path, &text, &length, err));
    const size_t room = count_lines(text);
    double *generation = calloc(room * (1 + front->n_obj), sizeof *generation);
    Status status = generation ? STATUS_OK : fail(err, STATUS_NO_MEMORY, "%s: no memory for %zu rows", path, room);
    if (status == STATUS_OK)
        status = parse(front, text, room, path, generation, generation + room, &n, err);
    if (status == STATUS_OK) {
        front_box(front, ideal, span);
        status = convergence_of(n, front->n_obj, generation, generation + room, ideal, span, out, err);
    }
    free(generation);
    free(text);
    return status;
}

/* ---- the volume ------------------------------------------------------------------------------------------------ */

static int is_finite(size_t n_obj, const double f[])
{
    int finite = 1;
    for (size_t k = 0; k < n_obj; k++)
        finite = finite && isfinite(f[k]);
    return finite;
}

/* Keeps only the nondominated of `kept` and f; returns how many there are. */
static size_t keep(size_t n, size_t n_obj, double kept[], const double f[])
{
    size_t m = 0;
    for (size_t i = 0; i < n; i++)
        if (dominates(n_obj, kept + i * n_obj, f) || memcmp(kept + i * n_obj, f, n_obj * sizeof *f) == 0)
            return n;
    for (size_t i = 0; i < n; i++)
        if (!dominates(n_obj, f, kept + i * n_obj))
            memmove(kept + m++ * n_obj, kept + i * n_obj, n_obj * sizeof *f);
    memcpy(kept + m * n_obj, f, n_obj * sizeof *f);
    return m + 1;
}

/* Samples that f reaches are taken off the list; returns how many are left. */
static size_t reach(size_t n_left, size_t n_obj, double samples[], const double f[])
{
    for (size_t s = 0; s < n_left;) {
        size_t k = 0;
        while (k < n_obj && f[k] <= samples[s * n_obj + k])
            k++;
        if (k < n_obj)
            s++;
        else
            memmove(samples + s * n_obj, samples + --n_left * n_obj, n_obj * sizeof *samples);
    }
    return n_left;
}

static Status allocate(size_t n, Convergence *c, Err *err)
{
    c->simulated = calloc(3 * (n + 1), sizeof *c->simulated);
    if (!c->simulated)
        return fail(err, STATUS_NO_MEMORY, "no memory for %zu generations", n);
    c->volume = c->simulated + n + 1;
    c->standard_error = c->volume + n + 1;
    return STATUS_OK;
}

static Status follow(size_t n, size_t n_obj, const double generation[], const double F[], const double ideal[],
                     const double span[], double work[], Convergence *c, Err *err)
{
    const int exact = n_obj <= EXACT_MAX;
    double f[OBJECTIVES_MAX], reference[OBJECTIVES_MAX];
    Random random = random_stream(1, RANDOM_HYPERVOLUME, 0, 0);
    size_t n_kept = 0, n_left = SAMPLES;
    for (size_t i = 0; !exact && i < SAMPLES * n_obj; i++)
        work[i] = MARGIN * random_uniform(&random);
    for (size_t k = 0; k < n_obj; k++)
        reference[k] = MARGIN;
    for (size_t i = 0; i < n; i++) {
        for (size_t k = 0; k < n_obj; k++)
            f[k] = (F[i * n_obj + k] - ideal[k]) / span[k];
        if (!is_finite(n_obj, f))
            c->n_failed++;
        else if (exact)
            n_kept = keep(n_kept, n_obj, work, f);
        else
            n_left = reach(n_left, n_obj, work, f);
        if (i + 1 < n && !(generation[i + 1] > generation[i]))
            continue;
        Hypervolume v = {.volume = 1 - (double)n_left / SAMPLES};
        v.standard_error = sqrt(v.volume * (1 - v.volume) / SAMPLES);
        if (exact)
            TRY(hypervolume_exact(n_kept, n_obj, work, reference, &v, err));
        c->simulated[c->n] = (double)(i + 1);
        c->volume[c->n] = exact ? v.volume / pow(MARGIN, (double)n_obj) : v.volume;
        c->standard_error[c->n++] = v.standard_error;
    }
    return STATUS_OK;
}

Status convergence_of(size_t n, size_t n_obj, const double generation[], const double F[], const double ideal[],
                      const double span[], Convergence *out, Err *err)
{
    *out = (Convergence){.n_evaluated = n};
    double *work = calloc((n_obj <= EXACT_MAX ? n + 1 : SAMPLES) * n_obj, sizeof *work);
    Status status = work ? allocate(n, out, err) : fail(err, STATUS_NO_MEMORY, "no memory for a hypervolume");
    if (status == STATUS_OK)
        status = follow(n, n_obj, generation, F, ideal, span, work, out, err);
    free(work);
    if (status != STATUS_OK)
        convergence_free(out);
    return status;
}

void convergence_free(Convergence *c)
{
    free(c->simulated);
    memset(c, 0, sizeof *c);
}
