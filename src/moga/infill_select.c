#include "moga/state.h"

#include <math.h>

/* Offspring i into the batch, with its prediction. */
static size_t take(Search *s, size_t n, size_t i, EvaluationKind kind)
{
    const Population *p = &s->offspring.members;
    if (n < s->batch.size_max)
        memcpy(s->batch.predicted + n * p->n_obj, p->F + i * p->n_obj, p->n_obj * sizeof *p->F);
    s->offspring.excluded[i] = 1;
    return batch_add(s, n, p->X + i * p->n_var, kind);
}

/* All may be picked but pending designs. */
static void exclude(Search *s)
{
    const Offspring *o = &s->offspring;
    const Population *p = &o->members;
    memset(o->excluded, 0, p->n);
    memset(o->excluded + p->n - o->n_pending, 1, o->n_pending);
}

/* Candidates are offered to both criteria with lower confidence bounds of their objectives; pending designs lower the
 * values to beat, by their predictions. */
static void offer(Search *s)
{
    const Population *p = &s->offspring.members;
    const size_t first_pending = p->n - s->offspring.n_pending;
    double *bound = s->scratch.bound;
    for (size_t i = 0; i < p->n * p->n_obj; i++)
        bound[i] = p->F[i] - (i < first_pending * p->n_obj ? OPTIMISM * p->error[i] : 0.0);
    for (int kind = 0; kind < INFILL_KINDS; kind++)
        infill_offer(s->criteria.select[kind], p->n, bound, p->violation, p->uncertainty,
                     search_has_front(s) ? p->chance : NULL);
    for (size_t i = first_pending; i < p->n; i++)
        for (int kind = 0; kind < INFILL_KINDS; kind++)
            infill_take(s->criteria.select[kind], i);
}

/* Allowed designs up to `limit` in the batch, by both criteria in turn: INFILL_HYPERVOLUME picks the given share. */
static size_t pick_in_turn(Search *s, size_t n, size_t limit, double hypervolume, EvaluationKind kind)
{
    while (n < limit) {
        const int is_turn = floor(hypervolume * (double)(n + 1) + 0.5) > floor(hypervolume * (double)n + 0.5);
        const InfillKind criterion = is_turn ? INFILL_HYPERVOLUME : INFILL_PBI;
        const size_t i = infill_pick(s->criteria.select[criterion], s->offspring.allowed);
        if (i == SIZE_MAX)
            break;
        infill_take(s->criteria.select[is_turn ? INFILL_PBI : INFILL_HYPERVOLUME], i);
        s->batch.criterion[n] = (unsigned char)criterion;
        n = take(s, n, i, kind);
    }
    return n;
}

/* Of `size` designs: predictions that are not trusted or have been trusted for long, then some trusted ones, which
 * validates them. */
static size_t pick_infill(Search *s, size_t size, double hypervolume)
{
    const Offspring *o = &s->offspring;
    const Population *p = &o->members;
    const size_t end = p->n - o->n_pending - o->n_variation - o->n_probes, n_validated = size / VALIDATION_SHARE + 1;
    size_t n = 0;
    for (int validating = 0; validating < 2; validating++) {
        const size_t limit = validating ? n + n_validated : size > n_validated ? size - n_validated : 0;
        for (size_t i = 0; i < p->n; i++)
            o->allowed[i] = i < end && !o->excluded[i] &&
                            (validating || !search_trusts(s, p, i) || p->age[i] >= PREDICTION_AGE_MAX);
        n = pick_in_turn(s, n, limit < size ? limit : size, hypervolume, KIND_INFILL);
    }
    return n;
}

/* Of the children of variation those with the greatest gain beside what is picked already. */
static size_t pick_variation(Search *s, size_t n, size_t size)
{
    const Offspring *o = &s->offspring;
    const size_t end = o->members.n - o->n_pending;
    for (size_t i = 0; i < o->members.n; i++)
        o->allowed[i] = i >= end - o->n_variation && i < end && !o->excluded[i];
    return pick_in_turn(s, n, size, 0.5, KIND_OFFSPRING);
}

/* As many as fit in. */
static size_t take_probes(Search *s, size_t n, size_t size)
{
    const Offspring *o = &s->offspring;
    const size_t end = o->members.n - o->n_pending - o->n_variation;
    for (size_t i = end - o->n_probes; i < end && n < size; i++) {
        s->batch.criterion[n] = CRITERION_NONE;
        n = take(s, n, i, KIND_OFFSPRING);
    }
    return n;
}

/* Without a surrogate: children of variation in their order. */
static size_t take_variation(Search *s, size_t size)
{
    const size_t end = s->offspring.members.n - s->offspring.n_pending;
    size_t n = 0;
    for (size_t i = end - s->offspring.n_variation; i < end && n < size; i++)
        n = take(s, n, i, KIND_OFFSPRING);
    return n;
}

/* No new design on the surrogate, or without it too few among the first children: all children of variation. */
size_t infill_select_batch(Search *s)
{
    const size_t size = batch_size(s);
    const int with_surrogate = search_uses_surrogate(s);
    size_t n;
    exclude(s);
    if (with_surrogate) {
        const BatchShares shares = control_batch_shares(&s->control, size, s->archive.n, s->problem->n_var);
        const size_t probes = s->offspring.n_probes, room = size > probes ? size - probes : 0,
                     variation = shares.n_variation < room ? shares.n_variation : room;
        offer(s);
        n = pick_variation(s, pick_infill(s, room - variation, shares.hypervolume), room);
        n = take_probes(s, n, size);
    } else
        n = take_variation(s, size);
    if (n >= size || (with_surrogate && n > 0))
        return n;
    offspring_make(s, 1);
    exclude(s);
    return take_variation(s, size);
}
