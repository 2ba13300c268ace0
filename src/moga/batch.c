#include "moga/batch.h"

size_t batch_size(const Common *c)
{
    const size_t population = c->config->population, half = common_ahead(c, c->archive.n) / 2;
    return MIN_OF(MAX_OF(half, 1), c->config->surrogate == SURROGATE_OFF ? population / 2 : population);
}

static void append(Batch *b, size_t n_var, const double x[], Question q)
{
    q.x = memcpy(b->X + b->n * n_var, x, n_var * sizeof *x);
    b->q[b->n++] = q;
}

void batch_add(Batch *b, const Common *c, const double x[], EvaluationKind kind, InfillKind criterion)
{
    const size_t n_var = c->problem->n_var;
    int is_new = b->n < b->size_max && b->n < b->room && pareto_archive_find(&c->archive, x) == c->archive.n &&
                 !pending_has(&c->pending, x);
    for (size_t i = 0; i < b->n; i++)
        is_new = is_new && memcmp(b->q[i].x, x, n_var * sizeof *x) != 0;
    if (is_new)
        append(b, n_var, x, (Question){.kind = kind, .criterion = (unsigned char)criterion});
}

void batch_repeat(Batch *b, const Archive *a, size_t row, EvaluationKind kind, size_t replicates)
{
    append(b, a->n_var, a->X + row * a->n_var,
           (Question){.kind = kind, .criterion = INFILL_KINDS, .repeat = replicates});
}
