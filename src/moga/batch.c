#include "moga/state.h"

static size_t largest_batch(const SearchConfig *c)
{
    return c->surrogate == SURROGATE_OFF ? c->population / 2 : c->population;
}

/* Designs between two fits of the surrogate: more as evaluations accumulate, so that fitting never dominates. */
size_t batch_size(const Search *s)
{
    const size_t population = s->config->population, min = population / BATCH_POPULATION_SHARE + 1,
                 max = largest_batch(s->config), grown = s->archive.n / BATCH_ARCHIVE_SHARE;
    return grown < min ? min : grown < max ? grown : max;
}

static int in_batch(const Search *s, size_t n, const double x[])
{
    for (size_t i = 0; i < n; i++)
        if (memcmp(s->batch.X + i * s->problem->n_var, x, s->problem->n_var * sizeof *x) == 0)
            return 1;
    return 0;
}

size_t batch_add(Search *s, size_t n, const double x[], EvaluationKind kind)
{
    Batch *b = &s->batch;
    if (n >= b->size_max || !screening_has_room(s, n) || in_batch(s, n, x) ||
        pareto_archive_find(&s->archive, x) < s->archive.n || queue_has(s->queue, x))
        return n;
    memcpy(b->X + n * s->problem->n_var, x, s->problem->n_var * sizeof *x);
    b->repeat[n] = 0;
    b->is_probe[n] = 0;
    b->kind[n] = (unsigned char)kind;
    return n + 1;
}

/* -- asking -------------------------------------------------------------------------------------------------------- */

/* New designs but samples, where there is a surrogate. */
static unsigned char is_predicted(const Search *s, size_t i)
{
    const unsigned char kind = s->batch.kind[i];
    return kind != KIND_SAMPLED && kind != KIND_REPEAT && kind != KIND_FINISHED && surrogate_is_usable(s->surrogate);
}

static Status ask(Search *s, size_t n, Err *err)
{
    const Problem *p = s->problem;
    const Batch *b = &s->batch;
    double *note = s->scratch.note;
    for (size_t i = 0; i < n; i++) {
        Asked asked = {
            .x = b->X + i * p->n_var, .repeat = b->repeat[i], .kind = (EvaluationKind)b->kind[i], .note = note};
        if (asked.kind == KIND_FINISHED)
            asked.cheap_parts = screening_parts(s, asked.x);
        else if (s->screening.is_on) {
            asked.n_parts = p->n_cheap;
            asked.kind = KIND_SCREENED;
        }
        note[NOTE_KIND] = b->kind[i];
        note[NOTE_WAS_PREDICTED] = is_predicted(s, i);
        note[NOTE_IS_PROBE] = b->is_probe[i];
        memcpy(note + NOTE_PREDICTED, b->predicted + i * p->n_obj, p->n_obj * sizeof *note);
        TRY(queue_ask(s->queue, &asked, err));
    }
    return STATUS_OK;
}

/* -- results ------------------------------------------------------------------------------------------------------- */

/* Result number i of this generation. */
static Status take_result(Search *s, size_t i, const Finished *done, Err *err)
{
    const Problem *p = s->problem;
    const Evaluation *e = done->evaluation;
    Batch *b = &s->batch;
    memcpy(b->X + i * p->n_var, e->x, p->n_var * sizeof *e->x);
    memcpy(b->F + i * p->n_obj, done->f, p->n_obj * sizeof *done->f);
    b->ok[i] = e->outcome == OUTCOME_OK;
    b->kind[i] = done->note ? (unsigned char)done->note[NOTE_KIND] : (unsigned char)e->kind;
    b->was_predicted[i] = done->note && done->note[NOTE_WAS_PREDICTED] != 0.0;
    b->is_probe[i] = done->note && done->note[NOTE_IS_PROBE] != 0.0;
    if (b->was_predicted[i])
        memcpy(b->predicted + i * p->n_obj, done->note + NOTE_PREDICTED, p->n_obj * sizeof *b->predicted);
    TRY(screening_take(s, done, err));
    return pareto_archive_insert(&s->archive, 1, e->x, done->f, p->n_con > 0 ? done->g : NULL, &b->ok[i],
                                 (unsigned char)e->kind, s->generation, err);
}

/* All but the last `pending` of what is asked for. */
static Status take_results(Search *s, size_t pending, Err *err)
{
    Finished done;
    Batch *b = &s->batch;
    for (b->n = 0; queue_pending(s->queue) > pending && b->n < b->n_max; b->n++) {
        TRY(queue_next(s->queue, &done, err));
        TRY(take_result(s, b->n, &done, err));
    }
    pareto_archive_update_noise(&s->archive);
    return screening_update(s, err);
}

size_t batch_pending_max(const SearchConfig *c, size_t n_workers)
{
    return c->asynchronous && n_workers > 1 ? n_workers + largest_batch(c) / LOOK_AHEAD_SHARE + 1 : 0;
}

/* Designs that may be pending when the next batch is selected: none in batches; asynchronous, so many that no worker
 * waits meanwhile, but at least one result is taken where no design is new (n = 0). */
static size_t pending_wanted(const Search *s, size_t n)
{
    const size_t workers = s->problem->n_workers, pending = queue_pending(s->queue);
    const int is_last = s->archive.n + pending >= search_evals(s) || s->generation >= s->config->generations;
    const size_t max = n == 0 && pending > 0 ? pending - 1 : pending;
    const size_t wanted = workers < 2 || is_last ? 0 : workers + batch_size(s) / LOOK_AHEAD_SHARE;
    return !s->config->asynchronous ? 0 : wanted < max ? wanted : max;
}

Status batch_evaluate(Search *s, size_t n_new, size_t n, Err *err)
{
    const double before = search_seconds(s);
    memset(s->batch.kind + n_new, s->screening.cost.whole > 1 ? KIND_FINISHED : KIND_REPEAT, n - n_new);
    TRY(ask(s, n, err));
    const Status status = take_results(s, pending_wanted(s, n), err);
    s->waited_s += search_seconds(s) - before;
    return status;
}

Status batch_finish(Search *s, Err *err)
{
    queue_withdraw(s->queue);
    return take_results(s, 0, err);
}

/* Failed designs and further replicates do not join. */
void batch_join(Search *s, Population *p, size_t first)
{
    const Archive *a = &s->archive;
    for (size_t row = first; row < a->n; row++) {
        if (!a->usable[row])
            continue;
        const size_t i = population_add(p, a->X + row * a->n_var);
        memcpy(p->F + i * a->n_obj, a->F + row * a->n_obj, a->n_obj * sizeof *a->F);
        p->violation[i] = a->violation[row];
        p->row[i] = row;
    }
}
