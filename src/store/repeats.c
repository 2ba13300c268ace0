#include "store/repeats.h"

#include <math.h>

#include "moga/archive.h"

static int is_known_to_search(const Evaluation *r)
{
    return r->kind != KIND_UNFINISHED && r->kind != KIND_POLISHED;
}

static Status insert_row(Archive *a, const Run *run, size_t i, Err *err)
{
    double f[OBJECTIVES_MAX];
    const size_t m = run->schema.n_obj;
    for (size_t k = 0; k < m; k++)
        f[k] = schema_objective(&run->schema, k)->sense * run->table.f[i * m + k];
    return pareto_archive_insert(a, 1, run_x(run, i), f, NULL, &(unsigned char){run->place[i].ok != 0},
                                 (unsigned char)run->table.row[i].kind, (size_t)run->table.row[i].generation, err);
}

/* Row i of the run is row `at` of the archive. */
static void take_design(Run *run, size_t i, const Archive *a, size_t at)
{
    const size_t m = run->schema.n_obj;
    const double replicates = (double)run->schema.replicates;
    Evaluation *r = &run->table.row[i];
    if (a->replicates[at] == 0)
        return;
    r->replicates = (int)((long)a->replicates[at] * run->schema.replicates);
    for (size_t k = 0; k < m && a->usable[at]; k++) {
        run->F[i * m + k] = schema_objective(&run->schema, k)->sense * a->F[at * m + k];
        if (a->n_replicates > 0)
            r->sd[k] = a->sd[at * m + k] * sqrt(replicates);
    }
}

static Status join(Run *run, Archive *a, Err *err)
{
    for (size_t i = 0; i < run->table.n; i++)
        if (is_known_to_search(&run->table.row[i]))
            TRY(insert_row(a, run, i, err));
    pareto_archive_update_noise(a);
    for (size_t i = 0, at = 0; i < run->table.n; i++)
        if (is_known_to_search(&run->table.row[i]))
            take_design(run, i, a, at++);
    return STATUS_OK;
}

Status repeats_join(Run *run, Err *err)
{
    Archive a;
    if (!run->schema.is_noisy || run->table.n == 0)
        return STATUS_OK;
    TRY(pareto_archive_init(&a, run->table.n, run->schema.n_var, run->schema.n_obj, 0, err));
    const Status status = join(run, &a, err);
    pareto_archive_free(&a);
    return status;
}
