#include "moga/state.h"

#include <math.h>
#include <stdlib.h>

#include "moga/hypervolume.h"

/* Screening: most designs are evaluated by the cheap level of the problem alone, and the whole evaluation is predicted
 * from it, output by output, by least squares over the designs that have both,
 *
 *   y = a + b y_cheap
 *
 * (autoregression of Kennedy and O'Hagan, Biometrika 87 (2000) 1-13, with a constant difference). Those that add most
 * to the front of the whole evaluations are finished: their other simulations are made, to the same bytes as if they had
 * been asked for at once. One for SCREENED_PER_FINISHED: LEVEL_PAIRS after the initial sample, the rest at the end of the
 * search, when most is known. A row of the cheap level is never on the front of the archive. */

void screening_begin(Search *s)
{
    const Problem *p = s->problem;
    Screening *q = &s->screening;
    *q = (Screening){.full = 1, .agreement = NAN};
    if (s->config->fidelity == FIDELITY_OFF || p->n_cheap == 0 || p->is_noisy)
        return;
    q->full = p->n_parts;
    q->cheap = p->n_cheap;
    q->is_on = 1;
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

/* Simulations so far. */
static size_t spent(const Search *s)
{
    const Screening *q = &s->screening;
    return s->archive.n * q->full - q->n * (q->full - q->cheap) - q->n_finished * q->cheap;
}

size_t search_evaluations(const Search *s)
{
    return spent(s) / s->screening.full;
}

/* Simulations that are left. */
static size_t left(const Search *s)
{
    const size_t all = search_evals(s) * s->screening.full, now = spent(s) + queue_pending(s->queue);
    return all > now ? all - now : 0;
}

int search_is_spent(const Search *s)
{
    const Screening *q = &s->screening;
    return spent(s) + q->full - (q->n_open > 0 ? q->cheap : 0) > search_evals(s) * q->full;
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
    if (q->full == 1)
        return s->archive.n + queue_pending(s->queue) + n + s->reserved < search_evals(s);
    const size_t one = q->is_on ? q->cheap : q->full, kept = q->is_on ? finish_due(s, n + 1) * (q->full - q->cheap) : 0;
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

/* -- the levels ---------------------------------------------------------------------------------------------------- */

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

/* Designs that have both levels, in screening.rows. */
static size_t find_pairs(Search *s)
{
    Screening *q = &s->screening;
    q->n_rows = 0;
    for (size_t i = 0; i < q->n; i++)
        if (q->design[i].finished != SIZE_MAX && s->archive.usable[q->design[i].finished])
            q->rows[q->n_rows++] = i;
    return q->n_rows;
}

typedef struct {
    double from, to, slope; /* means, slope between them */
} Line;

static Line fit_line(const Search *s, size_t k)
{
    const Screening *q = &s->screening;
    const double n = (double)q->n_rows;
    Line line = {0.0, 0.0, 1.0};
    double xx = 0.0, xy = 0.0;
    for (size_t j = 0; j < q->n_rows; j++) {
        line.from += cheap_value(s, q->rows[j], k) / n;
        line.to += value_of(s, q->design[q->rows[j]].finished, k) / n;
    }
    for (size_t j = 0; j < q->n_rows; j++) {
        const double x = cheap_value(s, q->rows[j], k) - line.from;
        xx += x * x;
        xy += x * (value_of(s, q->design[q->rows[j]].finished, k) - line.to);
    }
    line.slope = xx > 0.0 ? xy / xx : 1.0;
    return line;
}

/* Kendall's tau of objective k. */
static double agreement_of(const Search *s, size_t k)
{
    const Screening *q = &s->screening;
    double same = 0.0, pairs = 0.0;
    for (size_t i = 0; i < q->n_rows; i++)
        for (size_t j = 0; j < i; j++) {
            const double product =
                (cheap_value(s, q->rows[i], k) - cheap_value(s, q->rows[j], k)) *
                (value_of(s, q->design[q->rows[i]].finished, k) - value_of(s, q->design[q->rows[j]].finished, k));
            same += (product > 0.0) - (product < 0.0);
            pairs += product != 0.0;
        }
    return pairs > 0.0 ? same / pairs : 1.0;
}

/* Nothing is screened any more, and what is predicted from the cheap level is not used, but for the initial sample, which
 * is finished. */
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
    q->agreement = 0.0;
    for (size_t k = 0; k < s->problem->n_obj; k++)
        q->agreement += agreement_of(s, k) / (double)s->problem->n_obj;
    if (q->agreement < LEVEL_TAU_MIN || !q->is_on)
        turn_off(s);
}

static void predict(Search *s, int has_line)
{
    const Problem *p = s->problem;
    const Screening *q = &s->screening;
    const size_t n_out = p->n_obj + p->n_con;
    for (size_t k = 0; k < n_out; k++) {
        const Line line = has_line ? fit_line(s, k) : (Line){0.0, 0.0, 1.0};
        for (size_t i = 0; i < q->n; i++)
            if (is_open(s, i)) {
                const size_t row = q->design[i].row;
                double *to =
                    k < p->n_obj ? s->archive.Y + row * p->n_obj + k : s->archive.H + row * p->n_con + k - p->n_obj;
                *to = line.to + line.slope * (cheap_value(s, i, k) - line.from);
            }
    }
    for (size_t i = 0; i < q->n; i++)
        if (is_open(s, i))
            pareto_archive_predicted(&s->archive, q->design[i].row);
}

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
    Screening *q = &s->screening;
    if (q->n == 0)
        return STATUS_OK;
    const int has_line = find_pairs(s) >= LEVEL_PAIRS;
    if (has_line)
        look_at_agreement(s);
    predict(s, has_line);
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
    const size_t asked = n * (q->is_on ? q->cheap : q->full), all = left(s), room = all > asked ? all - asked : 0;
    return min_size(s->batch.size_max, n + min_size(wanted, room / (q->full - q->cheap)));
}

/* Pairs for the line, or the initial sample where nothing is screened any more. */
Status screening_finish(Search *s, size_t *n, Err *err)
{
    const Screening *q = &s->screening;
    const size_t wanted = !q->is_on ? q->n : q->n_finished < LEVEL_PAIRS ? LEVEL_PAIRS - q->n_finished : 0;
    if (q->n == 0 || wanted == 0)
        return STATUS_OK;
    const size_t size = size_with(s, *n, wanted);
    if (q->is_on)
        TRY(append_best(s, n, size, err));
    append_open(s, n, size);
    return STATUS_OK;
}

int screening_is_due(const Search *s)
{
    const Screening *q = &s->screening;
    return q->is_on && q->n_open > 0 && finish_due(s, 0) > 0 && left(s) >= q->full - q->cheap;
}

Status screening_last(Search *s, size_t *n, Err *err)
{
    const Screening *q = &s->screening;
    const int is_last = s->generation > s->config->generations || !screening_has_room(s, 0);
    if (*n > 0 || q->n == 0 || !q->is_on || !is_last)
        return STATUS_OK;
    return append_best(s, n, size_with(s, 0, batch_size(s)), err);
}
