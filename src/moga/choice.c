#include "moga/searching.h"

#include <math.h>

/* Offspring i into the batch, and what is foretold of it. */
static size_t batch_take(Search *s, size_t n, size_t i, EvaluationKind kind)
{
    const Population *g = &s->offspring;
    if (n < s->batch_max)
        memcpy(s->foreseen + n * g->n_obj, g->F + i * g->n_obj, g->n_obj * sizeof *g->F);
    s->picked[i] = 1;
    return batch_add(s, n, g->X + i * g->n_var, kind);
}

/* Plain children in their order, up to `limit` designs in the batch. */
static size_t take_plain(Search *s, size_t n, size_t limit)
{
    const size_t end = s->offspring.n - s->n_pending;
    for (size_t i = end - s->n_plain; i < end && n < limit; i++)
        n = batch_take(s, n, i, KIND_OFFSPRING);
    return n;
}

/* Up to `limit` designs among those allowed, by both ways of choosing in turn; rays choose their share. */
static size_t choose_in_turn(Search *s, size_t n, size_t limit, double rays, EvaluationKind kind)
{
    while (n < limit) {
        const InfillKind way =
            floor(rays * (double)(n + 1) + 0.5) > floor(rays * (double)n + 0.5) ? INFILL_HYPERVOLUME : INFILL_PBI;
        const size_t i = infill_pick(s->infill[way], s->allowed);
        if (i == SIZE_MAX)
            break;
        infill_take(s->infill[way == INFILL_HYPERVOLUME ? INFILL_PBI : INFILL_HYPERVOLUME], i);
        s->way[n] = (unsigned char)way;
        n = batch_take(s, n, i, kind);
    }
    return n;
}

/* All may be picked but those that are asked for already and, `wary`, those that are expected to fail. */
static void forget_picks(Search *s, int wary)
{
    for (size_t i = 0; i < s->offspring.n; i++)
        s->picked[i] = wary && guide_expects_failure(s, s->offspring.X + i * s->problem->n_var);
    memset(s->picked + s->offspring.n - s->n_pending, 1, s->n_pending);
}

/* First predictions that do not stand or have stood for long, then a few of those that do. */
static size_t choose_predicted(Search *s, size_t batch)
{
    const Population *g = &s->offspring;
    const size_t n_predicted = g->n - s->n_pending - s->n_plain, check = batch / VALIDATION_SHARE + 1;
    size_t n = 0;
    for (int kind = 0; kind < INFILL_KINDS; kind++)
        infill_offer(s->infill[kind], g->n, g->F, g->violation, g->uncertainty);
    for (size_t i = g->n - s->n_pending; i < g->n; i++)
        for (int kind = 0; kind < INFILL_KINDS; kind++)
            infill_take(s->infill[kind], i);
    for (int round = 0; round < 2; round++) {
        const size_t limit = round == 1 ? n + check : batch > check ? batch - check : 0;
        for (size_t i = 0; i < g->n; i++)
            s->allowed[i] = i < n_predicted && !s->picked[i] &&
                            (round == 1 || !guide_trusts(s, g, i) || g->age[i] >= PREDICTION_AGE_MAX);
        n = choose_in_turn(s, n, limit < batch ? limit : batch, guide_rays(s), KIND_INFILL);
    }
    return n;
}

/* Of a whole population of plain children those that promise most beside what is chosen already. */
static size_t choose_plain(Search *s, size_t n, size_t batch)
{
    const size_t end = s->offspring.n - s->n_pending;
    for (size_t i = 0; i < s->offspring.n; i++)
        s->allowed[i] = i >= end - s->n_plain && i < end && !s->picked[i];
    return choose_in_turn(s, n, batch, 0.5, KIND_OFFSPRING);
}

/* Where the surface has nothing new to propose, plain children; where these are all known too, fresh samples. */
size_t choice_make(Search *s)
{
    const size_t batch = batch_size(s);
    size_t n = 0;
    forget_picks(s, guide_leads(s));
    if (guide_leads(s))
        n = choose_plain(s, choose_predicted(s, batch - guide_plain(s)), batch);
    else
        n = take_plain(s, n, batch);
    if (n > 0)
        return n;
    offspring_make(s, 1);
    forget_picks(s, 0);
    return take_plain(s, n, batch);
}
