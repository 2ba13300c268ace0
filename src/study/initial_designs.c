#include "study/initial_designs.h"

#include <sys/stat.h>

#include "base/csv.h"
#include "evaluate/device.h"
#include "store/run_read.h"

static Status copy_columns(const Table *t, const char *where, const Schema *schema, double *X, Err *err)
{
    for (size_t j = 0; j < schema->n_var; j++) {
        const char *name = schema_variable(schema, j)->name;
        if (table_column(t, name) < 0)
            return bad_data(err, "%s: %s: has no column %s", where, t->path, name);
        for (size_t i = 0; i < t->n_rows; i++)
            TRY(schema_cell(schema, j, t, i, &X[i * schema->n_var + j], err));
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
static Status append(size_t n_var, const double more[], size_t n_more, double **X, size_t *n, Err *err)
{
    double *all = realloc(*X, ((*n + n_more) * n_var + 1) * sizeof *all);
    if (!all)
        return fail_memory(err, n_more, "designs");
    memcpy(all + *n * n_var, more, n_more * n_var * sizeof *all);
    *X = all;
    *n += n_more;
    return STATUS_OK;
}

static Status append_read(const char *where, const char *start, const Schema *schema, double **X, size_t *n, Err *err)
{
    struct stat there;
    double *more = NULL;
    size_t n_more = 0;
    if (stat(start, &there) != 0)
        return fail(err, STATUS_MISSING, "%s: %s: is not there", where, start);
    Status status = S_ISDIR(there.st_mode) ? read_front(where, start, schema, &more, &n_more, err)
                                           : read_table(where, start, schema, &more, &n_more, err);
    THEN(status, append(schema->n_var, more, n_more, X, n, err));
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
        status = list_item(start, i, item, sizeof item) ? append_read(where, item, schema, X, n, err)
                                                        : bad_data(err, "%s: item %zu is empty", where, i + 1);
    if (status != STATUS_OK) {
        free(*X);
        *X = NULL;
    }
    return status;
}

/* -- devices that do best alone ------------------------------------------------------------------------------------ */

/* The middle of what is searched; `wall` of the way from the thinnest core to the thickest. */
static void set_core(const Problem *p, const DesignSpace *space, double wall, double x[])
{
    for (size_t d = 0; d < p->n_var; d++)
        x[d] = problem_spread(p, d, design_is_wall(space, (int)d) ? wall : 0.5);
    problem_repair(p, x);
}

static int is_in_box(const Problem *p, const double x[])
{
    int is = 1;
    for (size_t d = 0; d < p->n_var; d++)
        is &= x[d] >= p->lower[d] && x[d] <= p->upper[d];
    return is;
}

/* x with that device alone; 0: it is not in the space. */
static int put_device(const Problem *p, SceneKind kind, const LinearDevice *d, double core_kg, double x[])
{
    const DesignSpace *space = tower_design(tower_of(p));
    return (kind == SCENE_LINKS ? design_put_links(space, d->link_ns_m, x)
                                : design_put_mass(space, core_kg, d->tmd_hz, d->tmd_damping, x)) &&
           is_in_box(p, x);
}

/* Which of them the space has at all. */
static size_t ask_devices(const Problem *p, const DesignOptions *o, double X[], DeviceSearch search[])
{
    static const SceneKind KIND[] = {SCENE_LINKS, SCENE_TMD};
    static const double WALL[] = {0.5, 0}; /* of a tuned mass the mass of the core is the objective */
    const DesignSpace *space = tower_design(tower_of(p));
    size_t n = 0;
    for (int i = 0; i < 2; i++) {
        double *x = X + n * p->n_var, unused[DESIGN_VARIABLES_MAX];
        set_core(p, space, WALL[i], x);
        if (KIND[i] == SCENE_LINKS ? o->link_exponent == 1 && design_put_links(space, 1, unused)
                                   : design_put_mass(space, 1, 1, 1, unused))
            search[n++] = (DeviceSearch){.kind = KIND[i], .x = x};
    }
    return n;
}

Status initial_designs_of_devices(const Problem *p, const DesignOptions *o, double **X, size_t *n, Err *err)
{
    DeviceSearch search[2];
    double more[2 * DESIGN_VARIABLES_MAX];
    SceneModes modes;
    const size_t n_searches = tower_of(p) ? ask_devices(p, o, more, search) : 0;
    if (n_searches == 0)
        return STATUS_OK;
    TRY(devices_find(p, n_searches, search, err));
    for (size_t i = 0; i < n_searches; i++) {
        double *x = more + i * p->n_var;
        TRY(scene_frequencies(tower_record(tower_of(p), 0)->scene, x, &modes, err));
        if (put_device(p, search[i].kind, &search[i].device, modes.core_mass_kg, x))
            TRY(append(p->n_var, x, 1, X, n, err));
    }
    return STATUS_OK;
}
