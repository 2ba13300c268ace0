#include "moga/state.h"

#include <math.h>

static void range_of_front(const Archive *a, size_t k, double *min, double *max)
{
    *min = INFINITY;
    *max = -INFINITY;
    for (size_t i = 0; i < a->n_front; i++) {
        *min = fmin(*min, a->F[a->front[i] * a->n_obj + k]);
        *max = fmax(*max, a->F[a->front[i] * a->n_obj + k]);
    }
}

/* The standard deviation of one replicate exceeds `part` of the front's range, in any objective. */
static int noise_exceeds(const Archive *a, double part)
{
    double min, max;
    for (size_t k = 0; k < a->n_obj; k++) {
        range_of_front(a, k, &min, &max);
        for (size_t i = 0; i < a->n_front; i++)
            if (a->sd[a->front[i] * a->n_obj + k] > part * (max - min))
                return 1;
    }
    return 0;
}

int replication_noise_is_significant(const Search *s)
{
    return s->archive.n_replicates > 0 && noise_exceeds(&s->archive, NOISE_SIGNIFICANT);
}

/* -- how many ------------------------------------------------------------------------------------------------------ */

static size_t n_pending_replicates(const Search *s)
{
    size_t n = 0;
    for (size_t i = 0; i < queue_pending(s->queue); i++)
        n += queue_design(s->queue, i).kind == KIND_REPEAT;
    return n;
}

/* Evaluations that are left to be asked for. */
static size_t evaluations_left(const Search *s)
{
    const size_t asked = s->archive.n + queue_pending(s->queue);
    const size_t end = search_evals(s);
    return end > asked ? end - asked : 0;
}

/* Further replicates among n evaluations at most: share * max(0, n - REPLICATE_AFTER n_var). Before that, new designs
 * are worth more. */
static double search_replicates(size_t n, double share, size_t n_var)
{
    return share * fmax((double)n - (double)(REPLICATE_AFTER * n_var), 0.0);
}

/* Replicates that are still due, where `part` of those is due that n evaluations bring with them. */
static size_t replicates_due(const Search *s, size_t n, double part)
{
    const Archive *a = &s->archive;
    const double due = floor(part * search_replicates(n, s->config->replicate_share, s->problem->n_var));
    const size_t made = a->n_replicates + n_pending_replicates(s);
    const int is_noticeable = a->n_replicates < NOISE_SAMPLE || noise_exceeds(a, NOISE_NEGLIGIBLE);
    if (!s->problem->is_noisy || s->config->replicates_max < 2 || due <= (double)made || !is_noticeable)
        return 0;
    return (size_t)due - made;
}

size_t replication_due(const Search *s)
{
    return replicates_due(s, s->archive.n + queue_pending(s->queue), 1.0);
}

/* -- which --------------------------------------------------------------------------------------------------------- */

/* The best of each objective and the knee, nearest to the ideal, count more than all reference vectors together. */
static size_t importance_of_extremes(const Search *s)
{
    return INFILL_KINDS * s->criteria.vectors.n + 1;
}

static void add_extremes(Search *s)
{
    const Archive *a = &s->archive;
    size_t knee = a->front[0];
    double nearest = INFINITY;
    for (size_t k = 0; k < a->n_obj; k++) {
        size_t best = a->front[0];
        for (size_t i = 1; i < a->n_front; i++)
            if (a->F[a->front[i] * a->n_obj + k] < a->F[best * a->n_obj + k])
                best = a->front[i];
        s->rows.importance[best] += importance_of_extremes(s);
    }
    for (size_t i = 0; i < a->n_front; i++) {
        const double length = infill_length(s->criteria.select[INFILL_PBI], a->F + a->front[i] * a->n_obj);
        if (length < nearest) {
            nearest = length;
            knee = a->front[i];
        }
    }
    s->rows.importance[knee] += importance_of_extremes(s);
}

/* In how many reference vectors a design is the best one, by both criteria. */
static void weigh_designs(Search *s)
{
    memset(s->rows.importance, 0, s->archive.n * sizeof *s->rows.importance);
    for (int kind = 0; kind < INFILL_KINDS; kind++)
        for (size_t r = 0; r < s->criteria.vectors.n; r++)
            s->rows.importance[infill_best(s->criteria.select[kind], r)]++;
    add_extremes(s);
}

/* Of the front's designs with any importance the one with the fewest replicates, of these the most important one;
 * archive.n where none is left. */
static size_t pick(const Search *s)
{
    const Archive *a = &s->archive;
    const size_t *importance = s->rows.importance;
    size_t best = a->n;
    for (size_t i = 0; i < a->n_front; i++) {
        const size_t row = a->front[i];
        const int comes_first = best == a->n || a->replicates[row] < a->replicates[best] ||
                                (a->replicates[row] == a->replicates[best] && importance[row] > importance[best]);
        if (importance[row] > 0 && a->replicates[row] < s->config->replicates_max && comes_first &&
            !queue_has(s->queue, a->X + row * a->n_var))
            best = row;
    }
    return best;
}

/* The front has been measured, as it is now. Extremes with a single replicate go alone: where they prove wrong there
 * are others next time, which are then replicated before anything else. */
static size_t append(Search *s, size_t n, size_t limit)
{
    const Archive *a = &s->archive;
    const size_t n_var = s->problem->n_var;
    int extremes_alone = 0;
    if (a->n_front == 0 || n >= limit)
        return n;
    weigh_designs(s);
    for (size_t row; n < limit && (row = pick(s)) < a->n; n++) {
        const int is_new_extreme = s->rows.importance[row] >= importance_of_extremes(s) && a->replicates[row] == 1;
        if (extremes_alone && !is_new_extreme)
            break;
        extremes_alone = is_new_extreme;
        memcpy(s->batch.X + n * n_var, a->X + row * n_var, n_var * sizeof *s->batch.X);
        s->batch.repeat[n] = a->replicates[row];
        s->rows.importance[row] = 0;
    }
    return n;
}

static size_t min_size(size_t a, size_t b)
{
    return a < b ? a : b;
}

size_t replication_add(Search *s, size_t n)
{
    const size_t room = min_size(s->batch.size_max, evaluations_left(s)),
                 asked = s->archive.n + queue_pending(s->queue) + n;
    return append(s, n, min_size(room, n + replicates_due(s, asked, REPLICATE_EARLY)));
}

size_t replication_last(Search *s)
{
    const size_t room = evaluations_left(s);
    s->reserved = replicates_due(s, search_evals(s), 1.0);
    if (room > s->reserved)
        return 0;
    s->reserved = 0; /* where no design is left to replicate, new ones use the evaluations */
    return append(s, 0, min_size(room, batch_size(s)));
}
