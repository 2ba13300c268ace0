#include "moga/batch.h"

size_t batch_size_max(const SearchConfig *c)
{
    return c->surrogate == SURROGATE_OFF ? c->population / 2 : c->population;
}

size_t batch_size(const Common *c)
{
    const size_t least = c->config->population / BATCH_POPULATION_SHARE + 1, most = batch_size_max(c->config),
                 grown = c->archive.n / BATCH_ARCHIVE_SHARE, wanted = MAX_OF(grown, least), size = MIN_OF(wanted, most);
    return c->config->ahead < 0 ? size : MIN_OF(size, (size_t)c->config->ahead + 1);
}

static int is_there(const Batch *b, size_t n_var, size_t n, const double x[])
{
    for (size_t i = 0; i < n; i++)
        if (memcmp(b->X + i * n_var, x, n_var * sizeof *x) == 0)
            return 1;
    return 0;
}

size_t batch_add(Batch *b, const Common *c, size_t n, const double x[], EvaluationKind kind)
{
    const size_t n_var = c->problem->n_var;
    if (n >= b->size_max || n >= b->room || is_there(b, n_var, n, x) ||
        pareto_archive_find(&c->archive, x) < c->archive.n || pending_has(&c->pending, x))
        return n;
    memcpy(b->X + n * n_var, x, n_var * sizeof *x);
    b->repeat[n] = 0;
    b->kind[n] = kind;
    b->criterion[n] = INFILL_KINDS;
    return n + 1;
}

size_t batch_repeat(Batch *b, const Archive *a, size_t n, size_t row, size_t replicates)
{
    memcpy(b->X + n * a->n_var, a->X + row * a->n_var, a->n_var * sizeof *a->X);
    b->repeat[n] = replicates;
    return n + 1;
}
