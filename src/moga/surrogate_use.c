#include "moga/state.h"

#include <math.h>

/* The front to be improved; where nothing is feasible yet, the population. Plain search does not look at it, but for the
 * choice of designs to be replicated. */
void search_measure_front(Search *s)
{
    if (!control_allows(&s->control, s->config->surrogate) && !s->problem->is_noisy)
        return;
    Archive *a = &s->archive;
    const Population *p = &s->population;
    pareto_archive_list_front(a);
    for (size_t i = 0; i < p->n; i++)
        s->scratch.members[i] = i;
    for (int k = 0; k < 2 * INFILL_KINDS; k++) {
        Infill *q = k < INFILL_KINDS ? s->criteria.select[k] : s->criteria.gain[k - INFILL_KINDS];
        if (a->n_front > 0)
            infill_measure(q, a->n_front, a->front, a->estimate);
        else
            infill_measure(q, p->n, s->scratch.members, p->F);
    }
}

int search_uses_surrogate(const Search *s)
{
    return control_allows(&s->control, s->config->surrogate) && surrogate_is_usable(s->surrogate) &&
           control_agrees(&s->control);
}

int search_trusts(const Search *s, const Population *p, size_t i)
{
    return search_uses_surrogate(s) && p->uncertainty[i] < s->config->trust_error;
}

/* -- predicted failures -------------------------------------------------------------------------------------------- */

/* The FAILURE_NEIGHBOURS nearest designs so far, in ascending order of their squared distance in the unit cube. */
typedef struct {
    double square[FAILURE_NEIGHBOURS];
    int failed[FAILURE_NEIGHBOURS];
} Neighbours;

static void insert_neighbour(Neighbours *q, double square, int failed)
{
    int k = FAILURE_NEIGHBOURS;
    for (; k > 0 && square < q->square[k - 1]; k--)
        if (k < FAILURE_NEIGHBOURS) {
            q->square[k] = q->square[k - 1];
            q->failed[k] = q->failed[k - 1];
        }
    if (k < FAILURE_NEIGHBOURS) {
        q->square[k] = square;
        q->failed[k] = failed;
    }
}

static double square_distance(const Problem *p, const double x[], const double y[])
{
    double square = 0.0;
    for (size_t d = 0; d < p->n_var; d++) {
        const double width = p->upper[d] - p->lower[d], off = x[d] - y[d];
        square += width > 0.0 ? off * off / (width * width) : 0.0;
    }
    return square;
}

/* One of the nearest evaluated designs failed. */
int search_predicts_failure(const Search *s, const double x[])
{
    const Archive *a = &s->archive;
    Neighbours near = {0};
    int any = 0;
    for (int k = 0; k < FAILURE_NEIGHBOURS; k++)
        near.square[k] = INFINITY;
    for (size_t row = 0; a->n_failed > 0 && row < a->n; row++)
        if (a->replicates[row] > 0)
            insert_neighbour(&near, square_distance(s->problem, x, a->X + row * a->n_var), !a->usable[row]);
    for (int k = 0; k < FAILURE_NEIGHBOURS; k++)
        any |= near.failed[k];
    return any;
}

/* The surrogate has no failed designs among its centres: a predicted failure counts as infeasible. */
static void add_failures(const Search *s, Population *p, size_t first)
{
    if (s->archive.n_failed == 0)
        return;
#pragma omp parallel for schedule(static)
    for (size_t i = first; i < p->n; i++)
        if (p->row[i] == PREDICTED)
            p->violation[i] += search_predicts_failure(s, p->X + i * p->n_var);
}

/* -- the surrogate, timed ------------------------------------------------------------------------------------------ */

Status search_fit_surrogate(Search *s, Err *err)
{
    const double before = search_seconds(s);
    const Status status = surrogate_fit(s->surrogate, &s->archive, s->criteria.select[INFILL_PBI], err);
    s->control.times.surrogate += search_seconds(s) - before;
    return status;
}

void search_predict(Search *s, Population *p, size_t first, int with_uncertainty)
{
    const double before = search_seconds(s);
    surrogate_predict(s->surrogate, p, first, with_uncertainty);
    if (surrogate_is_usable(s->surrogate))
        add_failures(s, p, first);
    s->control.times.surrogate += search_seconds(s) - before;
}

void search_descend(Search *s, InfillKind kind, size_t n, const size_t vectors[], double X[])
{
    const double before = search_seconds(s);
    surrogate_descend(s->surrogate, &s->archive, s->criteria.select[kind], n, vectors, X);
    s->control.times.surrogate += search_seconds(s) - before;
}
