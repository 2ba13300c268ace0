#include "store/front.h"

#include <limits.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "store/saved.h"
#include "simulator/measures.h"
#include "settings/settings.h"

/* Of id, variables and objectives; spreads may follow. */
static size_t n_columns(const Table *t)
{
    size_t n = 0;
    while (n < t->n_cols && strncmp(t->names[n], "spread_", 7) != 0)
        n++;
    return n;
}

static Status check_columns(const Front *front, const char *path, Err *err)
{
    const Table *t = &front->table;
    for (size_t j = 0; j < n_columns(t); j++) {
        const char *want = j == 0 ? "id" : front->schema.column[j - 1].name;
        if (strcmp(t->names[j], want) != 0)
            return fail(err, STATUS_BAD_DATA, "%s: column %zu is '%s', expected %s", path, j + 1, t->names[j], want);
    }
    return STATUS_OK;
}

/* A tower's number of floors is told by the columns, all else by the run's settings. */
static Status find_schema(Front *front, const char *folder, const char *path, Err *err)
{
    char settings[PATH_MAX + 32];
    Settings s;
    snprintf(settings, sizeof settings, "%s/settings.ini", folder);
    settings_defaults(&s);
    if (access(settings, F_OK) == 0)
        TRY(settings_read(&s, settings, NULL, NULL, err));
    const size_t n_cols = n_columns(&front->table);
    if (s.problem.kind == PROBLEM_TOWER && n_cols < 4 + N_OBJECTIVES)
        return fail(err, STATUS_BAD_DATA, "%s: %zu columns are not a front", path, n_cols);
    TRY(schema_of(&front->schema, &s, (int)n_cols - 3 - N_OBJECTIVES, err));
    if (n_cols != 1 + front->schema.n_var + front->schema.n_obj)
        return fail(err, STATUS_BAD_DATA, "%s: %zu columns are not a front of %zu variables and %zu objectives", path,
                    n_cols, front->schema.n_var, front->schema.n_obj);
    front->n_var = (int)front->schema.n_var;
    front->n_obj = front->schema.n_obj;
    return check_columns(front, path, err);
}

/* id, variables, objectives of the designs on the front; the columns pass over to it. */
static Status take_front(Front *front, Saved *h, Err *err)
{
    const size_t n_cols = 1 + h->schema.n_var + h->schema.n_obj;
    front->table = (Table){.n_cols = n_cols, .values = calloc(h->n_front * n_cols + 1, sizeof(double))};
    if (!front->table.values)
        return fail(err, STATUS_NO_MEMORY, "no memory for a front of %zu designs", h->n_front);
    for (size_t i = 0; i < h->n; i++) {
        if (!h->row[i].on_front)
            continue;
        double *to = front->table.values + front->table.n_rows++ * n_cols;
        to[0] = (double)h->row[i].id;
        memcpy(to + 1, h->X + i * h->schema.n_var, h->schema.n_var * sizeof *to);
        memcpy(to + 1 + h->schema.n_var, h->F + i * h->schema.n_obj, h->schema.n_obj * sizeof *to);
    }
    front->schema = h->schema;
    h->schema = (Schema){0};
    front->n = front->table.n_rows;
    front->n_var = (int)front->schema.n_var;
    front->n_obj = front->schema.n_obj;
    return STATUS_OK;
}

static Status read_database(Front *front, const char *folder, Err *err)
{
    Saved h;
    TRY(saved_read(&h, folder, err));
    const Status status = take_front(front, &h, err);
    saved_free(&h);
    return status;
}

Status front_read(Front *front, const char *folder, Err *err)
{
    char path[PATH_MAX];
    memset(front, 0, sizeof *front);
    if (saved_path(folder, path, sizeof path))
        return read_database(front, folder, err);
    if (snprintf(path, sizeof path, "%s/front.csv", folder) >= (int)sizeof path)
        return fail(err, STATUS_MISSING, "%.200s...: the path is too long", folder);
    TRY(table_read(&front->table, path, 1, err));
    front->n = front->table.n_rows;
    const Status status = find_schema(front, folder, path, err);
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

static double sense_of(const Front *front, size_t k)
{
    return schema_objective(&front->schema, k)->sense;
}

size_t front_best(const Front *front, size_t objective)
{
    const double sense = sense_of(front, objective);
    size_t best = 0;
    for (size_t i = 1; i < front->n; i++)
        if (sense * front_f(front, i)[objective] < sense * front_f(front, best)[objective])
            best = i;
    return best;
}

void front_box(const Front *front, double ideal[], double span[])
{
    for (size_t k = 0; k < front->n_obj; k++) {
        const double sense = sense_of(front, k);
        double worst = -INFINITY;
        ideal[k] = sense * front_f(front, front_best(front, k))[k];
        for (size_t i = 0; i < front->n; i++)
            worst = fmax(worst, sense * front_f(front, i)[k]);
        span[k] = worst > ideal[k] ? worst - ideal[k] : 1.0;
    }
}

size_t front_knee(const Front *front)
{
    double ideal[OBJECTIVES_MAX], span[OBJECTIVES_MAX], least = INFINITY;
    size_t knee = 0;
    front_box(front, ideal, span);
    for (size_t i = 0; i < front->n; i++) {
        double d2 = 0;
        for (size_t k = 0; k < front->n_obj; k++) {
            const double d = (sense_of(front, k) * front_f(front, i)[k] - ideal[k]) / span[k];
            d2 += d * d;
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

static size_t nearest_id(const Front *front, long id)
{
    size_t nearest = 0;
    for (size_t i = 1; i < front->n; i++)
        if (labs(front_id(front, i) - id) < labs(front_id(front, nearest) - id))
            nearest = i;
    return nearest;
}

static Status why_empty(const Saved *h, const char *folder, Err *err)
{
    char nearest[PATH_MAX + 16];
    const size_t n_ok = h->n - h->n_failed;
    snprintf(nearest, sizeof nearest, "%s/nearest.csv", folder);
    if (h->n > 0 && n_ok == 0)
        return fail(err, STATUS_INTERNAL, "%s: all %zu simulations failed; `imtet status` has the reasons", folder,
                    h->n);
    if (h->n_generations == 0)
        return fail(err, STATUS_BAD_DATA,
                    "%s: there is no front before the initial sample is complete; %zu designs are simulated", folder,
                    h->n);
    if (strcmp(h->settings.search.limits, "none") != 0)
        return fail(err, STATUS_UNMET, "%s: search.limits: none of %zu designs keeps %.120s%s%s", folder, n_ok,
                    h->settings.search.limits, access(nearest, F_OK) == 0 ? "; those that come nearest: " : "",
                    access(nearest, F_OK) == 0 ? nearest : "");
    if (schema_is_noisy(&h->settings) && h->settings.search.members_min > 1)
        return fail(err, STATUS_BAD_DATA, "%s: no design was simulated %ld times yet (search.members_min)", folder,
                    h->settings.search.members_min);
    return fail(err, STATUS_BAD_DATA, "%s: the front is empty", folder);
}

Status front_why_empty(const char *folder, Err *err)
{
    char path[PATH_MAX];
    Saved h;
    if (!saved_path(folder, path, sizeof path))
        return fail(err, STATUS_BAD_DATA, "%s/front.csv: the front is empty", folder);
    TRY(saved_read(&h, folder, err));
    const Status status = why_empty(&h, folder, err);
    saved_free(&h);
    return status;
}

Status front_pick(const Front *front, const char *folder, const char *word, size_t *row, Err *err)
{
    char *end;
    if (front->n == 0)
        return front_why_empty(folder, err);
    if (strcmp(word, "knee") == 0) {
        *row = front_knee(front);
        return STATUS_OK;
    }
    const long id = strtol(word, &end, 10);
    if (end == word || *end)
        return fail(err, STATUS_BAD_DATA,
                    "--design %.40s: neither an id of %s/front.csv nor a word; did you mean knee?", word, folder);
    *row = front_find(front, id);
    if (*row == front->n)
        return fail(err, STATUS_BAD_DATA, "--design %ld: no such id on the front of %s; the nearest is %ld", id, folder,
                    front_id(front, nearest_id(front, id)));
    return STATUS_OK;
}

void front_free(Front *front)
{
    table_free(&front->table);
    schema_free(&front->schema);
    memset(front, 0, sizeof *front);
}
