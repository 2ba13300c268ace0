#include "study/initial_designs.h"

#include <sys/stat.h>

#include "base/csv.h"
#include "evaluate/device.h"
#include "store/run_read.h"

/* Room for n_more designs behind the n that X has. */
static Status grow(double **X, size_t n, size_t n_more, size_t n_var, Err *err)
{
    double *all = realloc(*X, ((n + n_more) * n_var + 1) * sizeof *all);
    if (!all)
        return fail_memory(err, n_more, "designs");
    *X = all;
    return STATUS_OK;
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

/* A run has its front; columns of a table beside the variables may hold anything, as of exported evaluations. */
static Status append_read(const char *where, const char *start, const Schema *schema, double **X, size_t *n, Err *err)
{
    const size_t n_var = schema->n_var;
    struct stat there;
    Status status;
    if (stat(start, &there) != 0)
        return fail(err, STATUS_MISSING, "%s: %s: is not there", where, start);
    if (S_ISDIR(there.st_mode)) {
        Run run;
        TRY(run_read(&run, start, err));
        status = initial_designs_fit(&run, where, schema, err);
        THEN(status, grow(X, *n, run.n_front, n_var, err));
        for (size_t i = 0; status == STATUS_OK && i < run.n_front; i++)
            memcpy(*X + (*n)++ * n_var, run_x(&run, run.front[i]), n_var * sizeof **X);
        run_free(&run);
        return status;
    }
    Table t = {0};
    TRY(table_read(&t, start, TABLE_WORDS, err));
    status = grow(X, *n, t.n_rows, n_var, err);
    for (size_t j = 0; j < n_var && status == STATUS_OK; j++) {
        const char *name = schema_variable(schema, j)->name;
        if (table_column(&t, name) < 0)
            status = bad_data(err, "%s: %s: has no column %s", where, t.path, name);
        for (size_t i = 0; i < t.n_rows; i++)
            THEN(status, schema_cell(schema, j, &t, i, *X + (*n + i) * n_var + j, err));
    }
    *n += t.n_rows;
    table_free(&t);
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

Status initial_designs_of_devices(const Problem *p, const DesignOptions *o, double **X, size_t *n, Err *err)
{
    static const SceneKind KIND[] = {SCENE_LINKS, SCENE_TMD};
    static const double WALL[] = {0.5, 0}; /* of a tuned mass the mass of the core is the objective */
    const DesignSpace *space = tower_of(p) ? tower_design(tower_of(p)) : NULL;
    DeviceSearch search[2];
    double more[2 * DESIGN_VARIABLES_MAX], unused[DESIGN_VARIABLES_MAX];
    SceneModes modes;
    size_t n_searches = 0;

    /* 1. Those that the space has at all, in the middle of what is searched, with a wall so far from the thinnest. */
    for (int i = 0; i < 2 && space; i++) {
        double *x = more + n_searches * p->n_var;
        for (size_t d = 0; d < p->n_var; d++)
            x[d] = problem_spread(p, d, design_is_wall(space, (int)d) ? WALL[i] : 0.5);
        problem_repair(p, x);
        if (KIND[i] == SCENE_LINKS ? o->link_exponent == 1 && design_put_links(space, 1, unused)
                                   : design_put_mass(space, 1, 1, 1, unused))
            search[n_searches++] = (DeviceSearch){.kind = KIND[i], .x = x};
    }
    if (n_searches == 0)
        return STATUS_OK;
    TRY(devices_find(p, n_searches, search, err));

    /* 2. The device that was found alone, where it is in the box. */
    for (size_t i = 0; i < n_searches; i++) {
        double *x = more + i * p->n_var;
        const LinearDevice *d = &search[i].device;
        TRY(scene_frequencies(tower_record(tower_of(p), 0)->scene, x, &modes, err));
        int is_in = search[i].kind == SCENE_LINKS
                        ? design_put_links(space, d->link_ns_m, x)
                        : design_put_mass(space, modes.core_mass_kg, d->tmd_hz, d->tmd_damping, x);
        for (size_t j = 0; j < p->n_var; j++)
            is_in = is_in && x[j] >= p->lower[j] && x[j] <= p->upper[j];
        if (!is_in)
            continue;
        TRY(grow(X, *n, 1, p->n_var, err));
        memcpy(*X + (*n)++ * p->n_var, x, p->n_var * sizeof *x);
    }
    return STATUS_OK;
}
