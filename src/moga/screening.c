/* moga/screening.c -- screening: most designs are evaluated by the cheap level of the problem alone.
 *
 * The whole evaluation is predicted from the cheap one, output by output, over the designs that have both, y = a + b
 * y_cheap by least squares, and the predictions stand in the archive. Of the designs on the front of results and
 * predictions those that add most to the front of the whole evaluations are finished: evaluated as a whole, to the
 * same bytes as if asked for at once, of the first replicates the other simulations alone. A row of the cheap level
 * is never on the front of the archive. One design is finished for SCREENED_PER_FINISHED, LEVEL_PAIRS after the
 * initial sample, most at the end.
 *
 * The levels agree while Kendall's tau, mean over the objectives, is LEVEL_TAU_MIN at least: of the pairs of designs
 * that the whole evaluation tells apart; those that the cheap level does not tell apart speak neither for it nor
 * against it, so that tau of a constant is 0. Where they do not agree the initial sample is finished and nothing is
 * screened any more.
 *
 * Sources  Kennedy and O'Hagan, Biometrika 87 (2000) 1-13 (autoregression between levels)
 * Threads  one */
#include "moga/state.h"

#include <float.h>
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
    q->is_on = 1;
    q->cost = (LevelCosts){p->n_cheap, p->n_parts - p->n_cheap, p->n_parts};
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

static int is_open(const Search *s, size_t i)
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
    const size_t due = (q->n + n) / SCREENED_PER_FINISHED;
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
    *d = (Screened){s->archive.n, SIZE_MAX, done->parts ? malloc(size) : NULL};
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

/* -- what the cheap level says of the whole evaluation ------------------------------------------------------------- */

/* Output k of design i by the cheap level, and of its row in the archive. */
static double cheap_value(const Search *s, size_t i, size_t k)
{
    return s->screening.y[i * (s->problem->n_obj + s->problem->n_con) + k];
}

static double value_of(const Search *s, size_t row, size_t k)
{
    const Archive *a = &s->archive;
    return k < a->n_obj ? a->Y[row * a->n_obj + k] : a->H[row * a->n_con + k - a->n_obj];
}

/* Output k of screened design i by the whole evaluation, which it has. */
static double whole_value(const Search *s, size_t i, size_t k)
{
    return value_of(s, s->screening.design[i].finished, k);
}

/* Sums over designs and lines through them stay finite. */
static int is_far_from_overflow(const Search *s, size_t i)
{
    static const double MOST = DBL_MAX * 0x1p-32;
    for (size_t k = 0; k < s->problem->n_obj + s->problem->n_con; k++)
        if (!(fabs(cheap_value(s, i, k)) < MOST && fabs(whole_value(s, i, k)) < MOST))
            return 0;
    return 1;
}

/* Designs that have both levels, in screening.rows. */
static size_t find_pairs(Search *s)
{
    Screening *q = &s->screening;
    q->n_rows = 0;
    for (size_t i = 0; i < q->n; i++)
        if (q->design[i].finished != SIZE_MAX && s->archive.usable[q->design[i].finished] && is_far_from_overflow(s, i))
            q->rows[q->n_rows++] = i;
    return q->n_rows;
}

/* The power of two of `most`: what is divided by it keeps its digits. */
static double scale_of(double most)
{
    return most > 0.0 ? ldexp(1.0, ilogb(most)) : 1.0;
}

typedef struct {
    double from, to, slope; /* means, slope between them */
} Line;

static Line fit_line(const Search *s, size_t k)
{
    const Screening *q = &s->screening;
    const double n = (double)q->n_rows;
    Line line = {0.0, 0.0, 1.0};
    double xx = 0.0, xy = 0.0, x_most = 0.0, y_most = 0.0;
    for (size_t j = 0; j < q->n_rows; j++) {
        line.from += cheap_value(s, q->rows[j], k) / n;
        line.to += whole_value(s, q->rows[j], k) / n;
    }
    for (size_t j = 0; j < q->n_rows; j++) {
        x_most = fmax(x_most, fabs(cheap_value(s, q->rows[j], k) - line.from));
        y_most = fmax(y_most, fabs(whole_value(s, q->rows[j], k) - line.to));
    }
    const double x_scale = scale_of(x_most), y_scale = scale_of(y_most);
    for (size_t j = 0; j < q->n_rows; j++) {
        const double x = (cheap_value(s, q->rows[j], k) - line.from) / x_scale;
        xx += x * x;
        xy += x * ((whole_value(s, q->rows[j], k) - line.to) / y_scale);
    }
    line.slope = xx > 0.0 ? xy / xx * (y_scale / x_scale) : 1.0;
    if (!isfinite(line.slope)) /* beside what the whole evaluation says, the cheap level is constant */
        line.slope = 0.0;
    return line;
}

static int order_of(double a, double b)
{
    return (a > b) - (a < b);
}

/* Kendall's tau of objective k, of the pairs that the whole evaluation tells apart: one that the cheap level does not
 * tell apart counts as half of an agreement and half of its contrary. NAN: there is no such pair. */
static double agreement_of(const Search *s, size_t k)
{
    const Screening *q = &s->screening;
    double same = 0.0, pairs = 0.0;
    for (size_t i = 0; i < q->n_rows; i++)
        for (size_t j = 0; j < i; j++) {
            const size_t a = q->rows[i], b = q->rows[j];
            const int whole = order_of(whole_value(s, a, k), whole_value(s, b, k));
            same += whole * order_of(cheap_value(s, a, k), cheap_value(s, b, k));
            pairs += whole != 0;
        }
    return pairs > 0.0 ? same / pairs : NAN;
}

/* An objective that the whole evaluation does not tell apart says nothing. */
static double mean_agreement(const Search *s)
{
    const size_t m = s->problem->n_obj;
    double sum = 0.0, n = 0.0, *tau = s->scratch.f;
    for (size_t k = 0; k < m; k++) {
        tau[k] = agreement_of(s, k);
        n += !isnan(tau[k]);
    }
    for (size_t k = 0; k < m; k++)
        sum += isnan(tau[k]) ? 0.0 : tau[k] / n;
    return n > 0.0 ? sum : 1.0;
}

/* What is predicted from the cheap level is not used any more, but for an initial sample that is to be finished. */
static void turn_off(Search *s)
{
    Screening *q = &s->screening;
    q->is_on = 0;
    for (size_t i = 0; i < q->n; i++)
        if (q->design[i].finished == SIZE_MAX && s->archive.generation[q->design[i].row] > 0)
            pareto_archive_drop(&s->archive, q->design[i].row);
}

static void look_at_agreement(Search *s)
{
    Screening *q = &s->screening;
    q->agreement = mean_agreement(s);
    if (q->agreement < LEVEL_TAU_MIN || !q->is_on)
        turn_off(s);
}

/* -- predictions --------------------------------------------------------------------------------------------------- */

static double *output_of(Search *s, size_t row, size_t k)
{
    Archive *a = &s->archive;
    return k < a->n_obj ? a->Y + row * a->n_obj + k : a->H + row * a->n_con + k - a->n_obj;
}

static int is_finite_prediction(const Search *s, size_t row)
{
    int is_finite = 1;
    for (size_t k = 0; k < s->problem->n_obj + s->problem->n_con; k++)
        is_finite &= isfinite(value_of(s, row, k)) != 0;
    return is_finite;
}

static void predict(Search *s)
{
    const Problem *p = s->problem;
    const Screening *q = &s->screening;
    for (size_t k = 0; k < p->n_obj + p->n_con; k++) {
        const Line line = q->n_rows >= LEVEL_PAIRS ? fit_line(s, k) : (Line){0.0, 0.0, 1.0};
        for (size_t i = 0; i < q->n; i++)
            if (is_open(s, i))
                *output_of(s, q->design[i].row, k) = line.to + line.slope * (cheap_value(s, i, k) - line.from);
    }
    for (size_t i = 0; i < q->n; i++)
        if (is_open(s, i) && !is_finite_prediction(s, q->design[i].row))
            pareto_archive_drop(&s->archive, q->design[i].row);
        else if (is_open(s, i))
            pareto_archive_predicted(&s->archive, q->design[i].row);
}

/* -- the front ----------------------------------------------------------------------------------------------------- */

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
    if (find_pairs(s) >= LEVEL_PAIRS)
        look_at_agreement(s);
    predict(s);
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
        if (is_open(s, i) && !q->is_chosen[q->design[i].row])
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

/* Pairs to compare the levels by, or the initial sample where nothing is screened any more. */
static size_t wanted_now(const Screening *q)
{
    return !q->is_on ? q->n : q->n_finished < LEVEL_PAIRS ? LEVEL_PAIRS - q->n_finished : 0;
}

Status screening_finish(Search *s, size_t *n, Err *err)
{
    const Screening *q = &s->screening;
    if (q->n == 0)
        return STATUS_OK;
    const size_t size = size_with(s, *n, wanted_now(q));
    if (size <= *n)
        return STATUS_OK;
    if (q->is_on)
        TRY(append_best(s, n, size, err));
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
