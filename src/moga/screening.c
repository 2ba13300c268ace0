#include "moga/state.h"

#include <math.h>
#include <stdlib.h>

#include "moga/hypervolume.h"

void screening_begin(Search *s)
{
    const Problem *p = s->problem;
    Screening *q = &s->screening;
    *q = (Screening){.cost = {.whole = 1}, .agreement = NAN};
    if (s->config->fidelity == FIDELITY_OFF || p->n_cheap == 0 || p->is_noisy)
        return;
    const LevelCosts parts = {p->n_cheap, p->n_parts - p->n_cheap, p->n_parts};
    q->is_on = 1;
    q->is_apart = p->cheap_cost > 0.0;
    q->cost = q->is_apart ? level_costs(p->cheap_cost) : parts;
    q->per_finished = q->is_apart ? APART_PER_FINISHED : SCREENED_PER_FINISHED;
    q->n_pairs = q->is_apart ? APART_PAIRS : LEVEL_PAIRS;
    q->tau_min = q->is_apart ? APART_TAU_MIN : LEVEL_TAU_MIN;
}

void screening_free(Search *s)
{
    Screening *q = &s->screening;
    for (size_t i = 0; i < q->n; i++)
        free(q->design[i].parts);
    free(q->design);
    free(q->y);
    free(q->front);
    free(q->is_chosen);
    free(q->rows);
}

/* -- what it costs ------------------------------------------------------------------------------------------------- */

/* So far. */
static size_t spent(const Search *s)
{
    const Screening *q = &s->screening;
    return (s->archive.n - q->n - q->n_finished) * q->cost.whole + q->n * q->cost.cheap + q->n_finished * q->cost.rest;
}

size_t search_evaluations(const Search *s)
{
    return spent(s) / s->screening.cost.whole;
}

static size_t left(const Search *s)
{
    const size_t all = search_evals(s) * s->screening.cost.whole, now = spent(s) + queue_pending(s->queue);
    return all > now ? all - now : 0;
}

int search_is_spent(const Search *s)
{
    const Screening *q = &s->screening;
    const size_t next = q->n_open > 0 ? q->cost.rest : q->is_on ? q->cost.cheap + q->cost.rest : q->cost.whole;
    return spent(s) + next > search_evals(s) * q->cost.whole;
}

int screening_is_open(const Search *s, size_t i)
{
    const Screened *d = &s->screening.design[i];
    return d->finished == SIZE_MAX && s->archive.usable[d->row];
}

static size_t min_size(size_t a, size_t b)
{
    return a < b ? a : b;
}

/* Designs to be finished when n more have been screened. */
static size_t finish_due(const Search *s, size_t n)
{
    const Screening *q = &s->screening;
    const size_t due = (q->n + n) / q->per_finished;
    return due > q->n_finished ? min_size(due - q->n_finished, q->n_open + n) : 0;
}

int screening_has_room(const Search *s, size_t n)
{
    const Screening *q = &s->screening;
    if (q->cost.whole == 1)
        return s->archive.n + queue_pending(s->queue) + n + s->reserved < search_evals(s);
    const size_t one = q->is_on ? q->cost.cheap : q->cost.whole,
                 kept = q->is_on ? finish_due(s, n + 1) * q->cost.rest : 0;
    return (n + 1) * one + kept <= left(s);
}

/* -- results ------------------------------------------------------------------------------------------------------- */

static Status grow(Screening *q, size_t n_out, Err *err)
{
    if (q->n < q->n_max)
        return STATUS_OK;
    const size_t n_max = q->n_max > 0 ? 2 * q->n_max : 128;
    Screened *design = realloc(q->design, n_max * sizeof *design);
    q->design = design ? design : q->design;
    double *y = realloc(q->y, n_max * n_out * sizeof *y);
    q->y = y ? y : q->y;
    size_t *rows = realloc(q->rows, n_max * sizeof *rows);
    q->rows = rows ? rows : q->rows;
    if (!design || !y || !rows)
        return fail(err, STATUS_NO_MEMORY, "no memory for %zu screened designs", n_max);
    q->n_max = n_max;
    return STATUS_OK;
}

/* Screened design x, or n. */
static size_t find(const Search *s, const double x[])
{
    const Screening *q = &s->screening;
    const size_t row = q->n > 0 ? pareto_archive_find(&s->archive, x) : 0;
    size_t low = 0, high = q->n;
    while (low < high) {
        const size_t middle = (low + high) / 2;
        if (q->design[middle].row < row)
            low = middle + 1;
        else
            high = middle;
    }
    return low < q->n && q->design[low].row == row ? low : q->n;
}

static Status keep(Search *s, const Finished *done, Err *err)
{
    const Problem *p = s->problem;
    Screening *q = &s->screening;
    const size_t n_out = p->n_obj + p->n_con, size = p->n_cheap * p->part_size;
    TRY(grow(q, n_out, err));
    Screened *d = &q->design[q->n];
    *d = (Screened){s->archive.n, SIZE_MAX, done->parts && !q->is_apart ? malloc(size) : NULL};
    if (d->parts)
        memcpy(d->parts, done->parts, size);
    memcpy(q->y + q->n * n_out, done->f, p->n_obj * sizeof *q->y);
    if (p->n_con > 0)
        memcpy(q->y + q->n * n_out + p->n_obj, done->g, p->n_con * sizeof *q->y);
    q->n++;
    return STATUS_OK;
}

Status screening_take(Search *s, const Finished *done, Err *err)
{
    Screening *q = &s->screening;
    if (done->evaluation->kind == KIND_SCREENED)
        return keep(s, done, err);
    const size_t i = find(s, done->evaluation->x);
    if (i == q->n)
        return STATUS_OK;
    q->design[i].finished = s->archive.n;
    q->n_finished++;
    free(q->design[i].parts);
    q->design[i].parts = NULL;
    return STATUS_OK;
}

static void exchange(size_t n, double a[], double b[])
{
    for (size_t k = 0; k < n; k++) {
        const double value = a[k];
        a[k] = b[k];
        b[k] = value;
    }
}

void screening_exchange(Search *s)
{
    Archive *a = &s->archive;
    const size_t m = a->n_obj, c = a->n_con;
    for (size_t i = 0; i < s->screening.n; i++) {
        const size_t row = s->screening.design[i].row;
        double *y = s->screening.y + i * (m + c);
        exchange(m, a->Y + row * m, y);
        exchange(c, a->H + row * c, y + m);
    }
}

const void *screening_parts(const Search *s, const double x[])
{
    const size_t i = find(s, x);
    return i < s->screening.n ? s->screening.design[i].parts : NULL;
}

/* -- the front ------------------------------------------------------------------------------------------------------ */

/* Of whole evaluations and predictions together. */
static Status find_front(Search *s, Err *err)
{
    const Archive *a = &s->archive;
    Screening *q = &s->screening;
    NdTree *tree;
    NdChange change;
    size_t n = 0;
    q->n_open = 0;
    if (q->front_max < a->n) {
        free(q->front);
        free(q->is_chosen);
        q->front_max = 2 * a->n;
        q->front = calloc(q->front_max, sizeof *q->front);
        q->is_chosen = calloc(q->front_max, 1);
        if (!q->front || !q->is_chosen)
            return fail(err, STATUS_NO_MEMORY, "no memory for %zu designs", q->front_max);
    }
    memset(q->is_chosen, 0, a->n);
    Status status = nd_tree_create(&tree, a->n_obj, err);
    for (size_t row = 0; status == STATUS_OK && row < a->n; row++) {
        q->front[row] = 0;
        if (!a->usable[row] || a->violation[row] > 0.0)
            continue;
        status = nd_tree_insert(tree, a->Y, row, &change, err);
        q->front[row] = change.is_in;
        for (size_t i = 0; change.is_in && i < change.n_removed; i++)
            q->front[change.removed[i]] = 0;
    }
    for (size_t row = 0; row < a->n; row++)
        if (q->front[row]) {
            q->n_open += a->kind[row] == KIND_SCREENED;
            q->front[n++] = row;
        }
    q->n_front = n;
    nd_tree_free(tree);
    return status;
}

Status screening_update(Search *s, Err *err)
{
    if (s->screening.n == 0)
        return STATUS_OK;
    TRY(levels_compare(s, err));
    return find_front(s, err);
}

/* -- finishing ----------------------------------------------------------------------------------------------------- */

static size_t append(Search *s, size_t n, size_t row)
{
    const Archive *a = &s->archive;
    memcpy(s->batch.X + n * a->n_var, a->X + row * a->n_var, a->n_var * sizeof *a->X);
    s->batch.repeat[n] = 0;
    s->screening.is_chosen[row] = 1;
    return n + 1;
}

/* Of the box about the front of results and predictions, what the front of the whole evaluations dominates. */
static Status measure_front(Search *s, Hypervolume **out, Err *err)
{
    const Screening *q = &s->screening;
    Archive *a = &s->archive;
    const size_t m = a->n_obj;
    double *lower = s->scratch.f, *reference = s->scratch.reference;
    for (size_t k = 0; k < m; k++) {
        double min = INFINITY, max = -INFINITY;
        for (size_t i = 0; i < q->n_front; i++) {
            min = fmin(min, a->Y[q->front[i] * m + k]);
            max = fmax(max, a->Y[q->front[i] * m + k]);
        }
        lower[k] = min;
        reference[k] = min + RAY_START * (max > min ? max - min : 1.0);
    }
    TRY(hypervolume_create(out, m, lower, reference, s->config->seed, err));
    pareto_archive_list_front(a);
    for (size_t i = 0; i < a->n_front; i++)
        hypervolume_add(*out, a->Y + a->front[i] * m);
    return STATUS_OK;
}

/* Of the open designs of the front those that add most, one after the other. */
static Status append_best(Search *s, size_t *n, size_t limit, Err *err)
{
    const Archive *a = &s->archive;
    Hypervolume *h;
    TRY(measure_front(s, &h, err));
    while (*n < limit) {
        size_t best = SIZE_MAX;
        double most = -1.0;
        for (size_t j = 0; j < s->screening.n_front; j++) {
            const size_t row = s->screening.front[j];
            const double gain = a->kind[row] == KIND_SCREENED && !s->screening.is_chosen[row]
                                    ? hypervolume_gain(h, a->Y + row * a->n_obj)
                                    : -1.0;
            if (gain > most) {
                most = gain;
                best = row;
            }
        }
        if (best == SIZE_MAX)
            break;
        hypervolume_add(h, a->Y + best * a->n_obj);
        *n = append(s, *n, best);
    }
    hypervolume_free(h);
    return STATUS_OK;
}

/* Open designs in their order. */
static void append_open(Search *s, size_t *n, size_t limit)
{
    const Screening *q = &s->screening;
    for (size_t i = 0; i < q->n && *n < limit; i++)
        if (screening_is_open(s, i) && !q->is_chosen[q->design[i].row])
            *n = append(s, *n, q->design[i].row);
}

/* Size of a batch of n new designs and `wanted` to be finished, as far as there is room. */
static size_t size_with(const Search *s, size_t n, size_t wanted)
{
    const Screening *q = &s->screening;
    const size_t asked = n * (q->is_on ? q->cost.cheap : q->cost.whole), all = left(s),
                 room = all > asked ? all - asked : 0;
    return min_size(s->batch.size_max, n + min_size(wanted, room / q->cost.rest));
}

static size_t pairs_missing(const Screening *q)
{
    const size_t n = q->is_apart ? q->n_rows : q->n_finished;
    return n < q->n_pairs ? q->n_pairs - n : 0;
}

/* Pairs to compare the levels by, then some of every batch, or the initial sample where nothing is screened any more. */
static size_t wanted_now(const Search *s, size_t n)
{
    const Screening *q = &s->screening;
    if (q->is_on && pairs_missing(q) > 0)
        return pairs_missing(q);
    return q->is_apart ? finish_due(s, n) : q->is_on ? 0 : q->n;
}

Status screening_finish(Search *s, size_t *n, Err *err)
{
    const Screening *q = &s->screening;
    const int has_pairs = pairs_missing(q) == 0;
    if (q->n == 0)
        return STATUS_OK;
    const size_t size = size_with(s, *n, wanted_now(s, *n));
    if (size <= *n)
        return STATUS_OK;
    if (q->is_on && (has_pairs || !q->is_apart))
        TRY(append_best(s, n, size, err));
    if (!has_pairs || !q->is_on)
        append_open(s, n, size);
    return STATUS_OK;
}

int screening_is_due(const Search *s)
{
    const Screening *q = &s->screening;
    return q->is_on && q->n_open > 0 && finish_due(s, 0) > 0 && left(s) >= q->cost.rest;
}

Status screening_last(Search *s, size_t *n, Err *err)
{
    const Screening *q = &s->screening;
    const int is_last = s->generation > s->config->generations || !screening_has_room(s, 0);
    if (*n > 0 || q->n == 0 || !q->is_on || !is_last)
        return STATUS_OK;
    return append_best(s, n, size_with(s, 0, batch_size(s)), err);
}
