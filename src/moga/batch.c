#include "moga/searching.h"

enum { BATCH_SHARE = 8 }; /* a batch is this part of the population at least */

static int in_batch(const Search *s, size_t n, const double x[])
{
    for (size_t i = 0; i < n; i++)
        if (memcmp(s->X + i * s->problem->n_var, x, s->problem->n_var * sizeof *x) == 0)
            return 1;
    return 0;
}

size_t batch_add(Search *s, size_t n, const double x[])
{
    if (n >= s->batch_max || s->archive.n + n >= s->config->max_evals || in_batch(s, n, x) ||
        archive_find(&s->archive, x) < s->archive.n)
        return n;
    memcpy(s->X + n * s->problem->n_var, x, s->problem->n_var * sizeof *x);
    return n + 1;
}

Status batch_simulate(Search *s, size_t n, EvaluationKind kind, Err *err)
{
    const Problem *p = s->problem;
    if (n == 0)
        return STATUS_OK;
    const double before = search_seconds(s);
    TRY(p->evaluate(n, s->X, NULL, s->F, s->G, s->ok, p->user, err));
    s->simulating_s += search_seconds(s) - before;
    s->n_timed += n;
    return archive_insert(&s->archive, n, s->X, s->F, s->G, s->ok, (unsigned char)kind, s->generation, err);
}

/* Failed ones do not join. */
void batch_join(Search *s, Group *group, size_t first)
{
    const Archive *a = &s->archive;
    for (size_t row = first; row < a->n; row++) {
        if (!a->ok[row])
            continue;
        const size_t i = group_add(group, a->X + row * a->n_var);
        memcpy(group->F + i * a->n_obj, a->F + row * a->n_obj, a->n_obj * sizeof *a->F);
        group->violation[i] = a->violation[row];
        group->row[i] = row;
    }
}

/* Simulations between two fits of the surface: more as they accumulate, so that fitting never takes over. */
size_t batch_size(const Search *s)
{
    const size_t population = s->config->population, least = population / BATCH_SHARE + 1, grown = s->archive.n / 40;
    return grown < least ? least : grown < population / 2 ? grown : population / 2;
}
