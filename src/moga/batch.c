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

size_t batch_add(Search *s, size_t n, const double x[], EvaluationKind kind)
{
    if (n >= s->batch_max || s->archive.n + queue_pending(s->queue) + n + s->reserved >= s->config->max_evals ||
        in_batch(s, n, x) || archive_find(&s->archive, x) < s->archive.n || queue_has(s->queue, x))
        return n;
    memcpy(s->X + n * s->problem->n_var, x, s->problem->n_var * sizeof *x);
    s->draws[n] = 0;
    s->kind[n] = (unsigned char)kind;
    return n + 1;
}

/* -- simulation ---------------------------------------------------------------------------------------------------- */

/* Whether the order of design i was predicted: new ones but samples, where there is a surface. */
static unsigned char is_foretold(const Search *s, size_t i)
{
    return s->kind[i] != KIND_SAMPLED && s->kind[i] != KIND_REPEAT && surrogate_is_usable(s->surrogate);
}

static Status ask(Search *s, size_t n, Err *err)
{
    const Problem *p = s->problem;
    for (size_t i = 0; i < n; i++) {
        const Asked asked = {
            .x = s->X + i * p->n_var, .repeat = s->draws[i], .kind = (EvaluationKind)s->kind[i], .note = s->note};
        s->note[NOTE_FORETOLD] = is_foretold(s, i);
        s->note[NOTE_WAY] = s->way[i];
        memcpy(s->note + NOTE_FORESEEN, s->foreseen + i * p->n_obj, p->n_obj * sizeof *s->note);
        TRY(queue_ask(s->queue, &asked, err));
    }
    return STATUS_OK;
}

/* Result number i of this generation. */
static Status take_in(Search *s, size_t i, const Finished *done, Err *err)
{
    const Problem *p = s->problem;
    const Evaluation *e = done->evaluation;
    memcpy(s->X + i * p->n_var, e->x, p->n_var * sizeof *e->x);
    memcpy(s->F + i * p->n_obj, done->f, p->n_obj * sizeof *done->f);
    s->ok[i] = e->outcome == OUTCOME_OK;
    s->kind[i] = (unsigned char)e->kind;
    s->foretold[i] = done->note && done->note[NOTE_FORETOLD] != 0.0;
    s->way[i] = done->note ? (unsigned char)done->note[NOTE_WAY] : 0;
    if (s->foretold[i])
        memcpy(s->foreseen + i * p->n_obj, done->note + NOTE_FORESEEN, p->n_obj * sizeof *s->foreseen);
    return archive_insert(&s->archive, 1, e->x, done->f, p->n_con > 0 ? done->g : NULL, &s->ok[i], s->kind[i],
                          s->generation, err);
}

/* All but the last `pending` of what is asked for. */
static Status take_results(Search *s, size_t pending, Err *err)
{
    Finished done;
    for (s->n_came = 0; queue_pending(s->queue) > pending && s->n_came < s->came_max; s->n_came++) {
        TRY(queue_next(s->queue, &done, err));
        TRY(take_in(s, s->n_came, &done, err));
    }
    return STATUS_OK;
}

size_t batch_lead_max(const SearchConfig *c, size_t n_workers)
{
    return c->asynchronous && n_workers > 1 ? n_workers + c->population / 2 / LOOK_AHEAD_SHARE + 1 : 0;
}

/* Designs that may be pending when the next batch is chosen. In batches, none; asynchronous, so many that no worker
 * waits meanwhile, but a generation without a new design (n = 0) goes on too. */
static size_t lead(const Search *s, size_t n)
{
    const size_t workers = s->problem->n_workers, pending = queue_pending(s->queue);
    const int is_last = s->archive.n + pending >= s->config->max_evals || s->generation >= s->config->generations;
    const size_t max = n == 0 && pending > 0 ? pending - 1 : pending;
    const size_t wanted = workers < 2 || is_last ? 0 : workers + batch_size(s) / LOOK_AHEAD_SHARE;
    return !s->config->asynchronous ? 0 : wanted < max ? wanted : max;
}

Status batch_simulate(Search *s, size_t n_new, size_t n, Err *err)
{
    const double before = search_seconds(s);
    memset(s->kind + n_new, KIND_REPEAT, n - n_new);
    TRY(ask(s, n, err));
    const Status status = take_results(s, lead(s, n), err);
    archive_update_noise(&s->archive);
    s->waited_s += search_seconds(s) - before;
    s->n_timed += s->n_came;
    s->simulating_s = s->waited_s;
    if (s->config->asynchronous)
        s->simulating_s = queue_busy(s->queue, &s->n_timed) / (double)s->problem->n_workers;
    return status;
}

Status batch_finish(Search *s, Err *err)
{
    queue_withdraw(s->queue);
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
