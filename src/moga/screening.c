/* moga/screening.c -- screening: most designs are evaluated by the cheap level of the problem alone.
 *
 * The whole evaluation is predicted from the cheap one (moga/levels.h), and the predictions stand in the archive. Of
 * the designs on the front of results and predictions those that add most to the front of the whole evaluations are
 * finished: evaluated as a whole, to the same bytes as if asked for at once, of the first replicates the other
 * simulations alone. A row of the cheap level is never on the front of the archive. LEVEL_PAIRS are finished after the
 * initial sample, then one for SCREENED_PER_FINISHED: at the end where the cheap level is a noisy sample of the whole
 * (replicates), as the search goes on where it is a biased one (records), so that it learns where it is deceived.
 *
 * The levels agree while Kendall's tau, mean over the objectives, is LEVEL_TAU_MIN at least: of the pairs of designs
 * that the whole evaluation tells apart; those that the cheap level does not tell apart speak neither for it nor
 * against it, so that tau of a constant is 0. Where they do not agree the initial sample is finished and nothing is
 * screened any more.
 *
 * Threads  one */
#include "moga/screening.h"

#include "base/carve.h"
#include "base/hypervolume.h"
#include "moga/normalisation.h"

void screening_begin(Screening *q, const Common *c)
{
    const Problem *p = c->problem;
    *q = (Screening){.problem = p, .cost = {.whole = 1}, .agreement = NAN, .n_out = p->n_obj + p->n_con};
    if (c->config->fidelity == FIDELITY_OFF || p->n_cheap == 0 || p->is_noisy)
        return;
    q->is_on = 1;
    q->is_biased = c->config->fidelity == FIDELITY_RECORDS;
    q->cost = (LevelCosts){p->n_cheap, p->n_parts - p->n_cheap, p->n_parts};
}

void screening_free(Screening *q)
{
    for (size_t i = 0; i < q->n; i++)
        free(q->design[i].parts);
    free(q->design);
    free(q->y);
}

/* Output k, an objective or a limit, of a row of the archive; of screened design i by the cheap level; by the whole
 * evaluation, which it has. */
static double *output_of(const Archive *a, size_t row, size_t k)
{
    return k < a->n_obj ? a->Y + row * a->n_obj + k : a->H + row * a->n_con + k - a->n_obj;
}

static double cheap_value(const Screening *q, size_t i, size_t k)
{
    return q->y[i * q->n_out + k];
}

static double whole_value(const Screening *q, const Archive *a, size_t i, size_t k)
{
    return *output_of(a, q->design[i].finished, k);
}

/* -- what it costs ------------------------------------------------------------------------------------------------- */

/* So far. */
static size_t spent(const Screening *q, const Common *c)
{
    return (c->archive.n - q->n - q->n_finished) * q->cost.whole + q->n * q->cost.cheap + q->n_finished * q->cost.rest;
}

size_t screening_evaluations(const Screening *q, const Common *c)
{
    return spent(q, c) / q->cost.whole;
}

/* What is left beside what is under way, and was asked for as the levels were then. */
static size_t left(const Screening *q, const Common *c)
{
    const LevelCosts cost = q->cost;
    const size_t *n = c->pending.n_of_kind, n_parts = n[KIND_SCREENED] + n[KIND_FINISHED];
    const size_t all = common_end(c) * cost.whole, now = spent(q, c) + n[KIND_SCREENED] * cost.cheap +
                                                         n[KIND_FINISHED] * cost.rest +
                                                         (c->pending.n - n_parts) * cost.whole;
    return all > now ? all - now : 0;
}

int screening_is_spent(const Screening *q, const Common *c)
{
    const size_t next = q->n_open > 0 ? q->cost.rest : q->is_on ? q->cost.cheap + q->cost.rest : q->cost.whole;
    return spent(q, c) + next > common_end(c) * q->cost.whole;
}

static int is_open(const Screening *q, const Archive *a, size_t i)
{
    const Screened *d = &q->design[i];
    return d->finished == SIZE_MAX && a->usable[d->row];
}

/* Designs to be finished when n more have been screened, beside those that are under way. */
static size_t finish_due(const Screening *q, const Common *c, size_t n)
{
    const size_t *asked = c->pending.n_of_kind, n_screened = asked[KIND_SCREENED] + n,
                 due = (q->n + n_screened) / SCREENED_PER_FINISHED, done = q->n_finished + asked[KIND_FINISHED],
                 n_open = q->n_open > asked[KIND_FINISHED] ? q->n_open - asked[KIND_FINISHED] : 0;
    return due > done ? MIN_OF(due - done, n_open + n_screened) : 0;
}

size_t screening_room(const Screening *q, const Common *c, size_t n_max)
{
    const size_t one = q->is_on ? q->cost.cheap : q->cost.whole, all = left(q, c);
    size_t n = 0;
    while (n < n_max && (n + 1) * one + (q->is_on ? finish_due(q, c, n + 1) * q->cost.rest : 0) <= all)
        n++;
    return n;
}

/* -- results ------------------------------------------------------------------------------------------------------- */

/* Screened design x, or n. */
static size_t find(const Screening *q, const Common *c, const double x[])
{
    const size_t row = q->n > 0 ? pareto_archive_find(&c->archive, x) : 0;
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

/* One more screened design, the next row of the archive. */
static Status add_screened(Screening *q, const Common *c, const Answer *answer, Err *err)
{
    const size_t size = c->problem->n_cheap * c->problem->part_size;
    if (q->n == q->n_max) {
        const size_t n_max = q->n_max > 0 ? 2 * q->n_max : 128;
        int lacks = 0;
        q->design = widened(q->design, n_max, sizeof *q->design, &lacks);
        q->y = widened(q->y, n_max * q->n_out, sizeof *q->y, &lacks);
        if (lacks)
            return fail_memory(err, n_max, "screened designs");
        q->n_max = n_max;
    }
    Screened *d = &q->design[q->n];
    *d = (Screened){c->archive.n, SIZE_MAX, answer->parts ? malloc(size) : NULL};
    if (d->parts)
        memcpy(d->parts, answer->parts, size);
    copy_values(q->n_out, answer->f, q->y + q->n++ * q->n_out);
    return STATUS_OK;
}

/* What the screening keeps of it comes first: the whole evaluation of a design that was screened, or a screened one. */
Status screening_enter(Screening *q, Common *c, const Answer *answer, Err *err)
{
    const size_t i = answer->kind == KIND_SCREENED ? q->n : find(q, c, answer->x);
    if (answer->kind == KIND_SCREENED)
        TRY(add_screened(q, c, answer, err));
    else if (i < q->n) {
        Screened *d = &q->design[i];
        d->finished = c->archive.n;
        q->n_finished++;
        free(d->parts);
        d->parts = NULL;
    }
    return pareto_archive_insert(&c->archive, answer->x, answer->f, answer->f + c->problem->n_obj, answer->ok,
                                 answer->kind, answer->generation, err);
}

void screening_exchange(Screening *q, Archive *a)
{
    for (size_t i = 0; i < q->n; i++)
        for (size_t k = 0; k < q->n_out; k++) {
            double *y = q->y + i * q->n_out + k, *value = output_of(a, q->design[i].row, k), was = *y;
            *y = *value;
            *value = was;
        }
}

const void *screening_parts(const Screening *q, const Common *c, const double x[])
{
    const size_t i = find(q, c, x);
    return i < q->n ? q->design[i].parts : NULL;
}

/* -- what the cheap level says of the whole evaluation ------------------------------------------------------------- */

static int order_of(double a, double b)
{
    return (a > b) - (a < b);
}

/* Kendall's tau of objective k, of the pairs that the whole evaluation tells apart: one that the cheap level does not
 * tell apart counts as half of an agreement and half of its contrary. NAN: there is no such pair. */
static double agreement_of(const Screening *q, const Archive *a, size_t k)
{
    double same = 0.0, pairs = 0.0;
    for (size_t j = 0; j < q->n_rows; j++)
        for (size_t i = 0; i < j; i++) {
            const size_t x = a->scratch.row[j], y = a->scratch.row[i];
            const int whole = order_of(whole_value(q, a, x, k), whole_value(q, a, y, k));
            same += whole * order_of(cheap_value(q, x, k), cheap_value(q, y, k));
            pairs += whole != 0;
        }
    return pairs > 0.0 ? same / pairs : NAN;
}

/* -- predictions --------------------------------------------------------------------------------------------------- */

/* Of the designs that have both levels, whose rows are in scratch of the archive. */
static Status fit_levels(const Screening *q, const Archive *a, Levels **out, Err *err)
{
    const size_t n = q->n_rows, m = q->n_out;
    const double **x;
    TRY_ROOM(x, n, "designs of both levels", err);
    double *cheap = malloc(2 * n * m * sizeof *cheap);
    for (size_t j = 0; cheap && j < n; j++) {
        const size_t i = a->scratch.row[j];
        x[j] = a->X + q->design[i].row * q->problem->n_var;
        for (size_t k = 0; k < m; k++) {
            cheap[j * m + k] = cheap_value(q, i, k);
            cheap[(n + j) * m + k] = whole_value(q, a, i, k);
        }
    }
    const Status status = cheap ? levels_fit(out, q->problem, q->is_biased, n, m, x, cheap, cheap + n * m, err)
                                : fail_memory(err, n, "results of both levels");
    free(x);
    free(cheap);
    return status;
}

/* By the cheap level itself while there are few pairs. */
static Status predict(Screening *q, Archive *a, Err *err)
{
    Levels *levels = NULL;
    double *y;
    TRY_ROOM(y, q->n_out, "a prediction", err);
    Status status = q->n_rows >= LEVEL_PAIRS ? fit_levels(q, a, &levels, err) : STATUS_OK;
    for (size_t i = 0; status == STATUS_OK && i < q->n; i++) {
        const size_t row = q->design[i].row;
        const double *cheap = q->y + i * q->n_out;
        if (!is_open(q, a, i))
            continue;
        if (levels)
            levels_predict(levels, a->X + row * q->problem->n_var, cheap, y);
        else
            copy_values(q->n_out, cheap, y);
        for (size_t k = 0; k < q->n_out; k++)
            *output_of(a, row, k) = y[k];
        if (all_finite(q->n_out, y))
            a->violation[row] = violation_of(a->n_con, a->H + row * a->n_con);
        else
            pareto_archive_drop(a, row);
    }
    levels_free(levels);
    free(y);
    return status;
}

/* -- the front ----------------------------------------------------------------------------------------------------- */

/* Of whole evaluations and predictions together; chosen are those that are being finished. */
static Status find_front(Screening *q, const Common *c, Err *err)
{
    const Archive *a = &c->archive;
    NdTree *tree;
    NdChange change;
    size_t n = 0;
    q->n_open = 0;
    memset(a->is_chosen, 0, a->n);
    for (size_t i = 0; i < c->pending.n; i++) {
        const size_t row = pareto_archive_find(a, pending_x(&c->pending, i));
        if (row < a->n)
            a->is_chosen[row] = pending_at(&c->pending, i)->q.kind == KIND_FINISHED;
    }
    Status status = nd_tree_create(&tree, a->n_obj, err);
    for (size_t row = 0; status == STATUS_OK && row < a->n; row++) {
        a->expected[row] = 0;
        if (!a->usable[row] || a->violation[row] > 0.0)
            continue;
        status = nd_tree_insert(tree, a->Y, row, &change, err);
        a->expected[row] = change.is_in;
        for (size_t i = 0; i < change.n_removed; i++)
            a->expected[change.removed[i]] = 0;
    }
    for (size_t row = 0; row < a->n; row++)
        if (a->expected[row]) {
            q->n_open += a->kind[row] == KIND_SCREENED;
            a->expected[n++] = row;
        }
    q->n_front = n;
    nd_tree_free(tree);
    return status;
}

Status screening_update(Screening *q, Common *c, Err *err)
{
    Archive *a = &c->archive;
    if (q->n == 0)
        return STATUS_OK;

    /* 1. Designs that have both levels, and how the levels agree, in the mean over the objectives; one that the whole
     * evaluation does not tell apart says nothing. */
    q->n_rows = 0;
    for (size_t i = 0; i < q->n; i++)
        if (q->design[i].finished != SIZE_MAX && a->usable[q->design[i].finished])
            a->scratch.row[q->n_rows++] = i;
    if (q->n_rows >= LEVEL_PAIRS) {
        double sum = 0.0, n = 0.0;
        for (size_t k = 0; k < a->n_obj; k++) {
            const double tau = agreement_of(q, a, k);
            sum += isnan(tau) ? 0.0 : tau;
            n += !isnan(tau);
        }
        q->agreement = n > 0.0 ? sum / n : 1.0;
        if (q->agreement < LEVEL_TAU_MIN)
            q->is_on = 0;

        /* 2. Where they do not, what is predicted is not used any more, but for an initial sample to be finished. */
        for (size_t i = 0; !q->is_on && i < q->n; i++)
            if (q->design[i].finished == SIZE_MAX && a->generation[q->design[i].row] > 0)
                pareto_archive_drop(a, q->design[i].row);
    }
    TRY(predict(q, a, err));
    return find_front(q, c, err);
}

/* -- finishing ----------------------------------------------------------------------------------------------------- */

static void append(const Archive *a, Batch *b, size_t row)
{
    a->is_chosen[row] = 1;
    batch_repeat(b, a, row, KIND_FINISHED, 0);
}

/* Of the box about the front of results and predictions, what the front of the whole evaluations dominates. */
static Status measure_front(const Screening *q, Archive *a, uint32_t seed, Hypervolume **out, Err *err)
{
    const size_t m = a->n_obj;
    double *lower;
    TRY_ROOM(lower, 2 * m, "corners of objectives", err);
    double *reference = lower + m;
    normalisation_fit_range(&(Normalisation){m, .ideal = lower, .width = reference}, q->n_front, a->expected, a->Y);
    for (size_t k = 0; k < m; k++)
        reference[k] = lower[k] + RAY_START * reference[k];
    const Status status = hypervolume_create(out, m, lower, reference, seed, err);
    free(lower);
    pareto_archive_list_front(a);
    for (size_t i = 0; status == STATUS_OK && i < a->n_front; i++)
        hypervolume_add(*out, a->Y + a->front[i] * m);
    return status;
}

/* Of the open designs of the front those that add most, one after the other. */
static Status append_best(Screening *q, Common *c, Batch *b, size_t limit, Err *err)
{
    Archive *a = &c->archive;
    Hypervolume *h;
    TRY(measure_front(q, a, c->config->seed, &h, err));
    while (b->n < limit) {
        size_t best = SIZE_MAX;
        double most = -1.0;
        for (size_t j = 0; j < q->n_front; j++) {
            const size_t row = a->expected[j];
            const double gain =
                a->kind[row] == KIND_SCREENED && !a->is_chosen[row] ? hypervolume_gain(h, a->Y + row * a->n_obj) : -1.0;
            if (gain > most) {
                most = gain;
                best = row;
            }
        }
        if (best == SIZE_MAX)
            break;
        hypervolume_add(h, a->Y + best * a->n_obj);
        append(a, b, best);
    }
    hypervolume_free(h);
    return STATUS_OK;
}

/* Size of the batch with `wanted` to be finished, as far as there is room. */
static size_t size_with(const Screening *q, const Common *c, const Batch *b, size_t wanted)
{
    const size_t asked = b->n * (q->is_on ? q->cost.cheap : q->cost.whole), all = left(q, c),
                 room = all > asked ? all - asked : 0;
    return MIN_OF(b->size_max, b->n + MIN_OF(wanted, room / q->cost.rest));
}

/* Pairs to compare the levels by, then what is due where the cheap level is biased; the initial sample where nothing is
 * screened any more. */
Status screening_finish(Screening *q, Common *c, Batch *b, Err *err)
{
    if (q->n == 0)
        return STATUS_OK;
    const size_t done = q->n_finished + c->pending.n_of_kind[KIND_FINISHED], due = finish_due(q, c, b->n),
                 wanted = !q->is_on            ? q->n
                          : done < LEVEL_PAIRS ? LEVEL_PAIRS - done
                          : q->is_biased       ? due
                                               : 0,
                 size = size_with(q, c, b, wanted);
    if (size <= b->n)
        return STATUS_OK;
    if (q->is_on)
        TRY(append_best(q, c, b, size, err));
    for (size_t i = 0; i < q->n && b->n < size; i++) /* further ones in their order */
        if (is_open(q, &c->archive, i) && !c->archive.is_chosen[q->design[i].row])
            append(&c->archive, b, q->design[i].row);
    return STATUS_OK;
}

Status screening_last(Screening *q, Common *c, Batch *b, int is_exhausted, Err *err)
{
    if (q->n == 0 || !q->is_on || (b->room > 0 && !is_exhausted))
        return STATUS_OK;
    return append_best(q, c, b, size_with(q, c, b, batch_size(c)), err);
}
