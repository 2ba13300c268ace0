#include "moga/searching.h"

#include <math.h>

enum {
    CHECK_SHARE = 4, /* this part of a batch checks predictions that stand */
    AGE_MAX = 3      /* a prediction that stood so often is checked first */
};

/* Offspring i into the batch, and what is foretold of it. */
static size_t batch_take(Search *s, size_t n, size_t i, EvaluationKind kind)
{
    const Group *g = &s->offspring;
    if (n < s->batch_max)
        memcpy(s->foreseen + n * g->n_obj, g->F + i * g->n_obj, g->n_obj * sizeof *g->F);
    s->picked[i] = 1;
    return batch_add(s, n, g->X + i * g->n_var, kind);
}

/* Plain children are simulated in their order, up to `limit` designs in the batch. */
static size_t choose_plain(Search *s, size_t n, size_t limit)
{
    const size_t end = s->offspring.n - s->n_pending;
    for (size_t i = end - s->n_plain; i < end && n < limit; i++)
        n = batch_take(s, n, i, KIND_OFFSPRING);
    return n;
}

/* Up to `limit` designs among those allowed, by both ways of choosing in turn. */
static size_t choose_in_turn(Search *s, size_t n, size_t limit)
{
    const double share = guide_rays(s);
    while (n < limit) {
        const int rays = floor(share * (double)(n + 1)) > floor(share * (double)n);
        const size_t i = infill_pick(s->infill[rays ? INFILL_RAYS : INFILL_PBI], s->allowed);
        if (i == SIZE_MAX)
            break;
        infill_take(s->infill[rays ? INFILL_PBI : INFILL_RAYS], i);
        n = batch_take(s, n, i, KIND_INFILL);
    }
    return n;
}

/* All may be picked but those that are asked for already. */
static void forget_picks(Search *s)
{
    memset(s->picked, 0, s->offspring.n);
    memset(s->picked + s->offspring.n - s->n_pending, 1, s->n_pending);
}

/* First predictions that do not stand or have stood for long, then a few of those that do. */
static size_t choose_predicted(Search *s, size_t batch)
{
    const Group *g = &s->offspring;
    const size_t n_predicted = g->n - s->n_pending - s->n_plain, check = batch / CHECK_SHARE + 1;
    size_t n = 0;
    for (int kind = 0; kind < INFILL_KINDS; kind++)
        infill_offer(s->infill[kind], g->n, g->F, g->violation, g->uncertainty);
    for (size_t i = g->n - s->n_pending; i < g->n; i++)
        for (int kind = 0; kind < INFILL_KINDS; kind++)
            infill_take(s->infill[kind], i);
    for (int round = 0; round < 2; round++) {
        const size_t limit = round == 1 ? n + check : batch > check ? batch - check : 0;
        for (size_t i = 0; i < g->n; i++)
            s->allowed[i] =
                i < n_predicted && !s->picked[i] && (round == 1 || !guide_trusts(s, g, i) || g->age[i] >= AGE_MAX);
        n = choose_in_turn(s, n, limit < batch ? limit : batch);
    }
    return n;
}

/* Where the surface has nothing new to propose, plain children; where these are all known too, fresh samples. */
size_t choice_make(Search *s)
{
    const size_t batch = batch_size(s);
    size_t n = 0;
    forget_picks(s);
    if (guide_leads(s))
        n = choose_predicted(s, batch - s->n_plain);
    n = choose_plain(s, n, batch);
    if (n > 0)
        return n;
    offspring_make(s, 1);
    forget_picks(s);
    return choose_plain(s, n, batch);
}
