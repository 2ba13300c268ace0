#include "store/repeats.h"

#include <math.h>

#include "moga/archive.h"
#include "settings/settings.h"

static int is_known_to_search(const Evaluation *r)
{
    return r->kind != KIND_UNFINISHED && r->kind != KIND_POLISHED;
}

static Status insert_row(Archive *a, const Run *h, size_t i, Err *err)
{
    double f[OBJECTIVES_MAX];
    const size_t m = h->schema.n_obj;
    for (size_t k = 0; k < m; k++)
        f[k] = schema_objective(&h->schema, k)->sense * h->table.f[i * m + k];
    return archive_insert(a, 1, run_x(h, i), f, NULL, &(unsigned char){h->place[i].ok != 0},
                          (unsigned char)h->table.row[i].kind, (size_t)h->table.row[i].generation, err);
}

/* Row i of the run is row `at` of the archive. */
static void take_design(Run *h, size_t i, const Archive *a, size_t at)
{
    const size_t m = h->schema.n_obj;
    const double replicates = (double)h->settings->sim.replicates;
    Evaluation *r = &h->table.row[i];
    if (a->replicates[at] == 0)
        return;
    r->replicates = (int)((long)a->replicates[at] * h->settings->sim.replicates);
    for (size_t k = 0; k < m && a->usable[at]; k++) {
        h->F[i * m + k] = schema_objective(&h->schema, k)->sense * a->F[at * m + k];
        if (a->n_replicates > 0)
            r->sd[k] = a->sd[at * m + k] * sqrt(replicates);
    }
}

static Status join(Run *h, Archive *a, Err *err)
{
    for (size_t i = 0; i < h->table.n; i++)
        if (is_known_to_search(&h->table.row[i]))
            TRY(insert_row(a, h, i, err));
    archive_update_noise(a);
    for (size_t i = 0, at = 0; i < h->table.n; i++)
        if (is_known_to_search(&h->table.row[i]))
            take_design(h, i, a, at++);
    return STATUS_OK;
}

Status repeats_join(Run *h, Err *err)
{
    Archive a;
    if (!schema_is_noisy(h->settings) || h->table.n == 0)
        return STATUS_OK;
    TRY(archive_init(&a, h->table.n, h->schema.n_var, h->schema.n_obj, 0, err));
    const Status status = join(h, &a, err);
    archive_free(&a);
    return status;
}
