#include "moga/replication.h"

/* -- how many ------------------------------------------------------------------------------------------------------ */

/* Replicates that are due where n evaluations are asked for: replicate_share of those beyond the first REPLICATE_AFTER
 * for each variable, before which new designs are worth more; none where the standard deviation of one is negligible
 * beside the front's range, in every objective. */
static size_t replicates_due(const Common *c, size_t n)
{
    const Archive *a = &c->archive;
    const double late = (double)n - (double)(REPLICATE_AFTER * c->problem->n_var),
                 due = floor(c->config->replicate_share * fmax(late, 0.0));
    const size_t made = a->n_replicates + c->pending.n_of_kind[KIND_REPEAT];
    int is_noticeable = a->n_replicates < NOISE_SAMPLE;
    for (size_t k = 0; k < a->n_obj && !is_noticeable; k++) {
        double min = INFINITY, max = -INFINITY, sd = 0.0;
        for (size_t i = 0; i < a->n_front; i++) {
            const size_t at = a->front[i] * a->n_obj + k;
            min = fmin(min, a->F[at]);
            max = fmax(max, a->F[at]);
            sd = fmax(sd, a->sd[at]);
        }
        is_noticeable = sd > NOISE_NEGLIGIBLE * (max - min);
    }
    if (!c->problem->is_noisy || c->config->replicates_max < 2 || due <= made || !is_noticeable)
        return 0;
    return (size_t)due - made;
}

/* -- which --------------------------------------------------------------------------------------------------------- */

/* The best of each objective and the knee, nearest to the ideal, count more than all reference vectors together. */
static size_t importance_of_extremes(const Criteria *q)
{
    return INFILL_KINDS * q->vectors.n + 1;
}

/* In how many reference vectors a design is the best one, by both criteria; and the extremes. */
static void weigh_designs(const Archive *a, const Criteria *q, size_t importance[])
{
    size_t knee = *a->front;
    double nearest = INFINITY;
    memset(importance, 0, a->n * sizeof *importance);
    for (int kind = 0; kind < INFILL_KINDS; kind++)
        for (size_t r = 0; r < q->vectors.n; r++)
            importance[infill_best(q->select[kind], r)]++;
    for (size_t k = 0; k < a->n_obj; k++) {
        size_t best = *a->front;
        for (size_t i = 1; i < a->n_front; i++)
            if (a->F[a->front[i] * a->n_obj + k] < a->F[best * a->n_obj + k])
                best = a->front[i];
        importance[best] += importance_of_extremes(q);
    }
    for (size_t i = 0; i < a->n_front; i++) {
        const double length = infill_length(q->select[INFILL_PBI], a->F + a->front[i] * a->n_obj);
        if (length < nearest) {
            nearest = length;
            knee = a->front[i];
        }
    }
    importance[knee] += importance_of_extremes(q);
}

/* The front has been measured, as it is now. Of its designs with any importance comes first the one with the fewest
 * replicates, of these the most important one. Extremes with a single replicate go alone: where they prove wrong there
 * are others next time, which are then replicated before anything else. */
void replication_add(const Common *c, const Criteria *q, Batch *b)
{
    const Archive *a = &c->archive;
    const size_t asked = common_asked(c), end = common_end(c), left = end > asked ? end - asked : 0,
                 due = replicates_due(c, asked + b->n), room = MIN_OF(b->size_max, left),
                 limit = MIN_OF(room, b->n + due);
    size_t *importance = a->scratch.row;
    int extremes_alone = 0;
    if (a->n_front == 0 || b->n >= limit)
        return;
    weigh_designs(a, q, importance);
    while (b->n < limit) {
        size_t row = a->n;
        for (size_t i = 0; i < a->n_front; i++) {
            const size_t other = a->front[i];
            const int comes_first = row == a->n || a->replicates[other] < a->replicates[row] ||
                                    (a->replicates[other] == a->replicates[row] && importance[other] > importance[row]);
            if (importance[other] > 0 && a->replicates[other] < c->config->replicates_max && comes_first &&
                !pending_has(&c->pending, a->X + other * a->n_var))
                row = other;
        }
        if (row == a->n)
            break;
        const int is_new_extreme = importance[row] >= importance_of_extremes(q) && a->replicates[row] == 1;
        if (extremes_alone && !is_new_extreme)
            break;
        extremes_alone = is_new_extreme;
        batch_repeat(b, a, row, KIND_REPEAT, a->replicates[row]);
        importance[row] = 0;
    }
}
