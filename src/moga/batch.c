#include "moga/searching.h"

/* Simulations between two fits of the surface: more as they accumulate, so that fitting never takes over. */
size_t batch_size(const Search *s)
{
    const size_t population = s->config->population, least = population / BATCH_POPULATION_SHARE + 1,
                 grown = s->archive.n / BATCH_ARCHIVE_SHARE;
    return grown < least ? least : grown < population / 2 ? grown : population / 2;
}

static int in_batch(const Search *s, size_t n, const double x[])
{
    for (size_t i = 0; i < n; i++)
        if (memcmp(s->X + i * s->problem->n_var, x, s->problem->n_var * sizeof *x) == 0)
            return 1;
    return 0;
}

size_t batch_pending(const Search *s)
{
    return s->feed ? feed_pending(s->feed) : 0;
}

size_t batch_add(Search *s, size_t n, const double x[], EvaluationKind kind)
{
    if (n >= s->batch_max || s->archive.n + batch_pending(s) + n + s->reserved >= s->config->max_evals ||
        in_batch(s, n, x) || archive_find(&s->archive, x) < s->archive.n || (s->feed && feed_has(s->feed, x)))
        return n;
    memcpy(s->X + n * s->problem->n_var, x, s->problem->n_var * sizeof *x);
    s->draws[n] = 0;
    s->kind[n] = (unsigned char)kind;
    return n + 1;
}

/* -- all at once --------------------------------------------------------------------------------------------------- */

/* Whether the order of design i was foretold: new ones but samples, where there is a surface. */
static unsigned char is_foretold(const Search *s, size_t i)
{
    return s->kind[i] != KIND_SAMPLED && s->kind[i] != KIND_REPEAT && surrogate_is_usable(s->surrogate);
}

static Status simulate_all(Search *s, size_t n, Err *err)
{
    const Problem *p = s->problem;
    Archive *a = &s->archive;
    s->n_came = n;
    if (n == 0)
        return STATUS_OK;
    for (size_t i = 0; i < n; i++)
        s->foretold[i] = is_foretold(s, i);
    TRY(p->evaluate(n, s->X, s->draws, s->F, s->G, s->ok, p->user, err));
    for (size_t i = 0; i < n; i++)
        TRY(archive_insert(a, 1, s->X + i * p->n_var, s->F + i * p->n_obj, s->G + i * p->n_con, s->ok + i, s->kind[i],
                           s->generation, err));
    return STATUS_OK;
}

/* -- one by one ---------------------------------------------------------------------------------------------------- */

size_t batch_lead_max(const SearchConfig *c, size_t n_workers)
{
    return n_workers > 1 ? n_workers + c->population / 2 / LOOK_AHEAD_SHARE + 1 : 0;
}

/* Designs that may be pending when the next batch is chosen: so many that no worker waits meanwhile. */
static size_t lead(const Search *s)
{
    const size_t workers = s->problem->n_workers;
    const int is_last =
        s->archive.n + batch_pending(s) >= s->config->max_evals || s->generation >= s->config->generations;
    return workers < 2 || is_last ? 0 : workers + batch_size(s) / LOOK_AHEAD_SHARE;
}

static Status ask(Search *s, size_t n, Err *err)
{
    const Problem *p = s->problem;
    for (size_t i = 0; i < n; i++) {
        const Asked asked = {.draws = s->draws[i],
                             .kind = s->kind[i],
                             .foretold = is_foretold(s, i),
                             .way = s->way[i],
                             .foreseen = s->foreseen + i * p->n_obj};
        TRY(feed_ask(s->feed, s->X + i * p->n_var, &asked, err));
    }
    return STATUS_OK;
}

/* Result number i of this generation. */
static Status take_in(Search *s, size_t i, const Arrived *a, Err *err)
{
    const Problem *p = s->problem;
    memcpy(s->X + i * p->n_var, a->x, p->n_var * sizeof *a->x);
    memcpy(s->F + i * p->n_obj, a->f, p->n_obj * sizeof *a->f);
    s->ok[i] = a->ok;
    s->kind[i] = a->asked.kind;
    s->way[i] = a->asked.way;
    s->foretold[i] = a->asked.foretold;
    if (a->asked.foretold)
        memcpy(s->foreseen + i * p->n_obj, a->asked.foreseen, p->n_obj * sizeof *a->f);
    return archive_insert(&s->archive, 1, a->x, a->f, p->n_con > 0 ? a->g : NULL, &a->ok, a->asked.kind, s->generation,
                          err);
}

/* All but the youngest `pending` of what is asked for. */
static Status take_results(Search *s, size_t pending, Err *err)
{
    Arrived a;
    for (s->n_came = 0; feed_pending(s->feed) > pending && s->n_came < s->came_max; s->n_came++) {
        if (!feed_next(s->feed, &a))
            return STATUS_STOPPED;
        TRY(take_in(s, s->n_came, &a, err));
    }
    return STATUS_OK;
}

static Status simulate_in_turn(Search *s, size_t n, Err *err)
{
    TRY(ask(s, n, err));
    const size_t most = lead(s), pending = feed_pending(s->feed);
    const size_t least =
        n == 0 && pending > 0 ? pending - 1 : pending; /* a generation without a new design goes on too */
    return take_results(s, most < least ? most : least, err);
}

Status batch_simulate(Search *s, size_t n_new, size_t n, Err *err)
{
    const double before = search_seconds(s);
    memset(s->kind + n_new, KIND_REPEAT, n - n_new);
    const Status status = s->feed ? simulate_in_turn(s, n, err) : simulate_all(s, n, err);
    archive_update_noise(&s->archive);
    s->waited_s += search_seconds(s) - before;
    s->n_timed += s->n_came;
    s->simulating_s = s->waited_s;
    if (s->feed)
        s->simulating_s = feed_busy(s->feed, &s->n_timed) / (double)s->problem->n_workers;
    return status;
}

Status batch_finish(Search *s, Err *err)
{
    feed_withdraw(s->feed);
    TRY(take_results(s, 0, err));
    archive_update_noise(&s->archive);
    return STATUS_OK;
}

/* Failed ones and repeats do not join. */
void batch_join(Search *s, Population *group, size_t first)
{
    const Archive *a = &s->archive;
    for (size_t row = first; row < a->n; row++) {
        if (!a->usable[row])
            continue;
        const size_t i = population_add(group, a->X + row * a->n_var);
        memcpy(group->F + i * a->n_obj, a->F + row * a->n_obj, a->n_obj * sizeof *a->F);
        group->violation[i] = a->violation[row];
        group->row[i] = row;
    }
}
