#include "moga/state.h"

#include <math.h>

/* Offspring i into the batch, with its prediction. */
static size_t take(Search *s, size_t n, size_t i, EvaluationKind kind)
{
    const Population *p = &s->offspring.members;
    if (n < s->batch.size_max)
        memcpy(s->batch.predicted + n * p->n_obj, p->F + i * p->n_obj, p->n_obj * sizeof *p->F);
    return batch_add(s, n, p->X + i * p->n_var, kind);
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

/* Of `count` members from `first` on those with the greatest gain beside what is picked already, by both criteria in
 * turn, up to `limit` in the batch. */
static size_t pick(Search *s, size_t n, size_t limit, size_t first, size_t count, EvaluationKind kind)
{
    unsigned char *allowed = s->offspring.allowed;
    memset(allowed, 0, s->offspring.members.n);
    memset(allowed + first, 1, count);
    while (n < limit) {
        const InfillKind criterion = n % 2 == 0 ? INFILL_HYPERVOLUME : INFILL_PBI;
        const size_t i = infill_pick(s->criteria.select[criterion], allowed);
        if (i == SIZE_MAX)
            break;
        infill_take(s->criteria.select[criterion == INFILL_PBI ? INFILL_HYPERVOLUME : INFILL_PBI], i);
        n = take(s, n, i, kind);
    }
    return n;
}

/* `count` members from `first` on in their order, up to `limit` in the batch. */
static size_t take_in_order(Search *s, size_t n, size_t limit, size_t first, size_t count, int is_probe)
{
    for (size_t i = first; i < first + count && n < limit; i++) {
        const size_t before = n;
        n = take(s, n, i, KIND_OFFSPRING);
        if (n > before)
            s->batch.is_probe[before] = (unsigned char)is_probe;
    }
    return n;
}

/* No new design on the surrogate, or without it too few among the first children: all children of variation. */
size_t infill_select_batch(Search *s)
{
    const Offspring *o = &s->offspring;
    const size_t size = batch_size(s), first_child = o->members.n - o->n_pending - o->n_variation,
                 first_probe = first_child - o->n_probes;
    const int with_surrogate = search_uses_surrogate(s);
    size_t n = 0;
    if (with_surrogate) {
        const size_t room = size > o->n_probes ? size - o->n_probes : 0, wanted = control_variation(&s->control, size),
                     variation = wanted < room ? wanted : room;
        offer(s);
        n = pick(s, n, room - variation, 0, first_probe, KIND_INFILL);
        n = pick(s, n, room, first_child, o->n_variation, KIND_OFFSPRING);
        n = take_in_order(s, n, size, first_probe, o->n_probes, 1);
    } else
        n = take_in_order(s, n, size, first_child, o->n_variation, 0);
    if (n >= size || (with_surrogate && n > 0))
        return n;
    offspring_make(s, 1);
    return take_in_order(s, 0, size, o->members.n - o->n_pending - o->n_variation, o->n_variation, 0);
}
