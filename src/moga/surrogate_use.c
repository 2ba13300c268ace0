#include "moga/state.h"

#include <math.h>

/* The front to be improved; where nothing is feasible yet, the population. Plain search does not look at it, but for
 * the choice of designs to be replicated. */
void search_measure_front(Search *s)
{
    if (s->config->surrogate == SURROGATE_OFF && !s->problem->is_noisy)
        return;
    Archive *a = &s->archive;
    const Population *p = &s->population;
    pareto_archive_list_front(a);
    for (size_t i = 0; i < p->n; i++)
        s->scratch.members[i] = i;
    for (int k = 0; k < INFILL_KINDS; k++)
        if (s->screening.n_front > 0)
            infill_measure(s->criteria.select[k], s->screening.n_front, s->screening.front, a->estimate);
        else if (a->n_front > 0)
            infill_measure(s->criteria.select[k], a->n_front, a->front, a->estimate);
        else
            infill_measure(s->criteria.select[k], p->n, s->scratch.members, p->F);
}

int search_uses_surrogate(const Search *s)
{
    return s->config->surrogate == SURROGATE_ON && surrogate_is_usable(s->surrogate) && control_agrees(&s->control);
}

/* -- the surrogate, timed ------------------------------------------------------------------------------------------ */

Status search_fit_surrogate(Search *s, Err *err)
{
    const double before = search_seconds(s);
    const Status status = surrogate_fit(s->surrogate, &s->archive, s->criteria.select[INFILL_PBI], err);
    s->surrogate_s += search_seconds(s) - before;
    return status;
}

void search_predict(Search *s, Population *p, size_t first, int with_uncertainty)
{
    const double before = search_seconds(s);
    surrogate_predict(s->surrogate, p, first, with_uncertainty);
    s->surrogate_s += search_seconds(s) - before;
}

void search_descend(Search *s, InfillKind kind, size_t n, const size_t vectors[], double X[])
{
    const double before = search_seconds(s);
    surrogate_descend(s->surrogate, &s->archive, s->criteria.select[kind], n, vectors, X);
    s->surrogate_s += search_seconds(s) - before;
}
