#include "moga/infill.h"

#include <float.h>

#include "base/carve.h"
#include "base/clones.h"
#include "moga/constants.h"
#include "moga/normalisation.h"

/* Component of a ray along an axis of which the others are 0. */
static const double LEAST = 1e-9;

struct Infill {
    InfillKind kind;
    size_t n_obj, n_dir, n_max, n;
    Normalisation normalisation;
    double *unit, *across;                          /* (n_dir, n_obj) vectors of length 1; (n_obj, n_dir) */
    double *over;                                   /* (n_obj, n_dir) 1 / component, at most 1e9 */
    double *row;                                    /* (n_dir) */
    double *best_value;                             /* (n_dir) of the front, lowered by what is picked */
    size_t *best;                                   /* (n_dir) row of the front that has it */
    double *value;                                  /* (n, n_dir) of the candidates */
    double *gain;                                   /* (n) */
    const double *violation, *uncertainty, *chance; /* (n) */
    const double *aspire;                           /* (n_obj) or NULL */
};

static void layout(void *infill, Carve *c)
{
    Infill *q = infill;
    const size_t m = q->n_obj;
    CARVE(c, q->normalisation.ideal, m);
    CARVE(c, q->normalisation.width, m);
    CARVE(c, q->unit, q->n_dir * m);
    CARVE(c, q->across, q->n_dir * m);
    CARVE(c, q->over, q->n_dir * m);
    CARVE(c, q->row, q->n_dir);
    CARVE(c, q->best_value, q->n_dir);
    CARVE(c, q->best, q->n_dir);
    CARVE(c, q->value, q->n_max * q->n_dir);
    CARVE(c, q->gain, q->n_max);
}

Status infill_create(Infill **out, InfillKind kind, size_t candidates_max, const Directions *vectors,
                     const double aspire[], Err *err)
{
    const size_t n_obj = vectors->n_obj, n_dir = vectors->n;
    Infill plain = {aspire ? INFILL_HYPERVOLUME : kind, n_obj,           n_dir, candidates_max,
                    .normalisation.n_obj = n_obj,       .aspire = aspire};
    Infill *q = *out = carve_object(layout, &plain, sizeof plain);
    if (!q)
        return fail_memory(err, candidates_max, "candidates of infill");
    directions_across(vectors, q->across);
    for (size_t i = 0; aspire && i < n_dir * n_obj; i++)
        q->across[i] = exp2(2.0 * (q->across[i] - 0.5));
    for (size_t r = 0; r < n_dir; r++)
        for (size_t k = 0; k < n_obj; k++) {
            q->unit[r * n_obj + k] = q->across[k * n_dir + r];
            q->over[k * n_dir + r] = 1.0 / fmax(q->across[k * n_dir + r], LEAST);
        }
    return STATUS_OK;
}

/* Of f (n_obj) objective k, from the reference point of the rays. */
static double off(const Infill *q, size_t k, const double f[])
{
    return q->aspire ? normalised_behind(&q->normalisation, k, q->aspire[k], f[k])
                     : normalised(&q->normalisation, k, f[k]) - RAY_START;
}

/* Minus the length of every ray that f dominates; from levels on it may also be behind. */
CLONED_V3 static void ray_values(const Infill *q, const double f[], double value[])
{
    for (size_t r = 0; r < q->n_dir; r++)
        value[r] = -DBL_MAX;
    for (size_t k = 0; k < q->n_obj; k++) {
        const double from = off(q, k, f), *over = q->over + k * q->n_dir;
#pragma omp simd
        for (size_t r = 0; r < q->n_dir; r++) {
            const double end = from * over[r];
            value[r] = MAX_OF(end, value[r]);
        }
    }
    if (q->aspire)
        return;
#pragma omp simd
    for (size_t r = 0; r < q->n_dir; r++)
        value[r] = MIN_OF(value[r], 0.0);
}

/* With |w| = 1, off^2 = |z|^2 - along^2. */
CLONED_V3 static void pbi_values(const Infill *q, const double f[], double pbi[])
{
    double square = 0.0;
    for (size_t r = 0; r < q->n_dir; r++)
        pbi[r] = 0.0;
    for (size_t k = 0; k < q->n_obj; k++) {
        const double z = normalised(&q->normalisation, k, f[k]), *w = q->across + k * q->n_dir;
        square += z * z;
#pragma omp simd
        for (size_t r = 0; r < q->n_dir; r++)
            pbi[r] += z * w[r];
    }
#pragma omp simd
    for (size_t r = 0; r < q->n_dir; r++) {
        const double rest = square - pbi[r] * pbi[r];
        pbi[r] += PBI_THETA * sqrt(MAX_OF(rest, 0.0));
    }
}

static void values_of(const Infill *q, const double f[], double value[])
{
    if (q->kind == INFILL_HYPERVOLUME)
        ray_values(q, f, value);
    else
        pbi_values(q, f, value);
}

CLONED_V3 static void keep_least(size_t n, const double value[], size_t row, double best_value[], size_t best[])
{
#pragma omp simd
    for (size_t r = 0; r < n; r++) {
        const int is_less = value[r] < best_value[r];
        best[r] = is_less ? row : best[r];
        best_value[r] = is_less ? value[r] : best_value[r];
    }
}

void infill_measure(Infill *q, size_t n, const size_t front[], const double F[])
{
    normalisation_fit_range(&q->normalisation, n, front, F);
    for (size_t r = 0; r < q->n_dir; r++)
        q->best_value[r] = DBL_MAX;
    for (size_t i = 0; i < n; i++) {
        values_of(q, F + front[i] * q->n_obj, q->row);
        keep_least(q->n_dir, q->row, front[i], q->best_value, q->best);
    }
}

size_t infill_best(const Infill *q, size_t vector)
{
    return q->best[vector];
}

/* Derivative of the maximum as a softmax: every objective near the maximum has a part in it. */
static double ray_slope(const Infill *q, const double w[], const double f[], double slope[])
{
    double length = -DBL_MAX, sum = 0.0;
    for (size_t k = 0; k < q->n_obj; k++) {
        slope[k] = off(q, k, f) / fmax(w[k], LEAST);
        length = fmax(length, slope[k]);
    }
    for (size_t k = 0; k < q->n_obj; k++) {
        slope[k] = exp((slope[k] - length) / RAY_SOFTNESS);
        sum += slope[k];
    }
    for (size_t k = 0; k < q->n_obj; k++)
        slope[k] /= sum * fmax(w[k], LEAST) * q->normalisation.width[k];
    return length;
}

static double pbi_slope(const Infill *q, const double w[], const double f[], double slope[])
{
    double along = 0.0, aside = 0.0;
    for (size_t k = 0; k < q->n_obj; k++)
        along += normalised(&q->normalisation, k, f[k]) * w[k];
    for (size_t k = 0; k < q->n_obj; k++) {
        slope[k] = normalised(&q->normalisation, k, f[k]) - along * w[k];
        aside += slope[k] * slope[k];
    }
    aside = sqrt(aside);
    for (size_t k = 0; k < q->n_obj; k++) /* the side is at right angles to w, so d aside / d z_k = side_k / aside */
        slope[k] = (w[k] + (aside > 0.0 ? PBI_THETA * slope[k] / aside : 0.0)) / q->normalisation.width[k];
    return along + PBI_THETA * aside;
}

double infill_length(const Infill *q, const double f[])
{
    double square = 0.0;
    for (size_t k = 0; k < q->n_obj; k++) {
        const double z = normalised(&q->normalisation, k, f[k]);
        square += z * z;
    }
    return sqrt(square);
}

double infill_slope(const Infill *q, size_t vector, const double f[], double slope[])
{
    const double *w = q->unit + vector * q->n_obj;
    return q->kind == INFILL_HYPERVOLUME ? ray_slope(q, w, f, slope) : pbi_slope(q, w, f, slope);
}

double infill_distance(Infill *q, const double f[])
{
    double nearest = DBL_MAX;
    values_of(q, f, q->row);
#pragma omp simd reduction(min : nearest)
    for (size_t r = 0; r < q->n_dir; r++) {
        const double more = q->row[r] - q->best_value[r];
        nearest = MIN_OF(more, nearest);
    }
    return nearest;
}

/* Of a design by its values. */
static double gain_of(const Infill *q, const double value[])
{
    double gain = 0.0;
    for (size_t r = 0; r < q->n_dir; r++)
        if (value[r] < q->best_value[r])
            gain += q->best_value[r] - value[r];
    return gain;
}

double infill_gain(Infill *q, const double f[])
{
    values_of(q, f, q->row);
    return gain_of(q, q->row);
}

void infill_offer(Infill *q, size_t n, const double F[], const double violation[], const double uncertainty[],
                  const double chance[])
{
    q->n = n;
    q->violation = violation;
    q->uncertainty = uncertainty;
    q->chance = chance;
    for (size_t i = 0; i < n; i++) {
        values_of(q, F + i * q->n_obj, q->value + i * q->n_dir);
        q->gain[i] = INFINITY;
    }
}

/* Feasible before infeasible where there is no chance to weigh gains with, then gain, violation, uncertainty. */
static int is_better(const Infill *q, size_t a, size_t b)
{
    const double *violation = q->violation;
    if (!q->chance && violation[a] != violation[b])
        return violation[a] < violation[b];
    if (q->gain[a] != q->gain[b])
        return q->gain[a] > q->gain[b];
    if (violation[a] != violation[b])
        return violation[a] < violation[b];
    return q->uncertainty[a] > q->uncertainty[b];
}

/* Gains only fall while designs are taken: one that was not enough before is not measured again. */
size_t infill_pick(Infill *q, unsigned char allowed[])
{
    size_t best = SIZE_MAX;
    for (size_t i = 0; i < q->n; i++) {
        if (!allowed[i] || (best != SIZE_MAX && !is_better(q, i, best)))
            continue;
        q->gain[i] = gain_of(q, q->value + i * q->n_dir) * (q->chance ? q->chance[i] : 1.0);
        if (best == SIZE_MAX || is_better(q, i, best))
            best = i;
    }
    if (best == SIZE_MAX)
        return best;
    allowed[best] = 0;
    infill_take(q, best);
    return best;
}

void infill_take(Infill *q, size_t candidate)
{
    for (size_t r = 0; r < q->n_dir; r++)
        q->best_value[r] = fmin(q->best_value[r], q->value[candidate * q->n_dir + r]);
}
