#include "moga/surrogate.h"

#include <float.h>

#include "base/carve.h"
#include "base/rprop.h"
#include "base/stat.h"
#include "moga/constants.h"
#include "base/dominance.h"

/* Larger values, penalties say, would leave nothing of the others after standardisation. */
static const double VALUE_MAX = 1e60;

struct Surrogate {
    const Problem *problem;
    Rbf *rbf;
    Rbf *success;       /* 1 where a design succeeded, 0 where it failed */
    int knows_failures; /* it is fitted */
    size_t n_dim;       /* coordinates */
    size_t n_out, n_max, predict_max;
    size_t n, n_tuned; /* centres; size of the archive at the last tuning */
    int fitted;
    double *U, *F;          /* (n_max, n_dim) (n_max, n_out) centres */
    double *noise;          /* (n_max, n_out) variances of the values, in nuggets of each output */
    double *range;          /* (n_out) of each output in the archive */
    double *errors;         /* (n_max) sorted for the median; further n_max of distances */
    size_t *member;         /* (predict_max) members that are predicted */
    unsigned char *is_held; /* (n_dim) coordinates of choices: descents leave them */
    double *descent;        /* (predict_max + RBF_BLOCK, descent_length) */
    double *chance;         /* (predict_max) predictions of success */
    double *u, *f, *e;      /* (predict_max, n_dim) (predict_max, n_out) twice */
};

static size_t descent_length(const Surrogate *s);

/* -- coordinates of a design --------------------------------------------------------------------------------------- */

static size_t n_coordinates(const Problem *p, size_t d)
{
    return problem_kind(p, d) == VARIABLE_CHOICE && p->upper[d] > 1.0 ? (size_t)p->upper[d] : 1;
}

/* Corner `word` of the regular simplex of edge 1 in n dimensions: with every new dimension i a corner stands above the
 * middle of the i + 1 before it, at a height of sqrt((i + 2) / (2 i + 2)). */
static void set_corner(size_t n, size_t word, double u[])
{
    for (size_t i = 0; i < n; i++) {
        const double height = sqrt((double)(i + 2) / (double)(2 * i + 2));
        u[i] = i + 1 < word ? height / (double)(i + 2) : i + 1 == word ? height : 0.0;
    }
}

size_t surrogate_dimension(const Problem *p)
{
    size_t n = 0;
    for (size_t d = 0; d < p->n_var; d++)
        n += n_coordinates(p, d);
    return n;
}

void surrogate_coordinates(const Problem *p, const double x[], double u[])
{
    for (size_t d = 0; d < p->n_var; u += n_coordinates(p, d), d++)
        if (problem_kind(p, d) == VARIABLE_CHOICE)
            set_corner(n_coordinates(p, d), (size_t)x[d], u);
        else
            *u = problem_to_unit(p, d, x[d]);
}

static void layout(void *surrogate, Carve *c)
{
    Surrogate *s = surrogate;
    const size_t n_dim = s->n_dim;
    CARVE(c, s->U, s->n_max * n_dim);
    CARVE(c, s->F, s->n_max * s->n_out);
    CARVE(c, s->noise, s->n_max * s->n_out);
    CARVE(c, s->range, s->n_out);
    CARVE(c, s->errors, 2 * s->n_max);
    CARVE(c, s->u, s->predict_max * n_dim);
    CARVE(c, s->f, s->predict_max * s->n_out);
    CARVE(c, s->e, s->predict_max * s->n_out);
    CARVE(c, s->chance, s->predict_max);
    CARVE(c, s->member, s->predict_max);
    CARVE(c, s->is_held, n_dim);
    CARVE(c, s->descent, (s->predict_max + RBF_BLOCK) * descent_length(s));
}

Status surrogate_create(Surrogate **out, const Problem *problem, size_t surrogate_max, size_t predict_max, Err *err)
{
    Surrogate plain = {.problem = problem,
                       .n_dim = surrogate_dimension(problem),
                       .n_out = problem->n_obj + problem->n_con,
                       .n_max = surrogate_max,
                       .predict_max = predict_max};
    Surrogate *s = *out = carve_object(layout, &plain, sizeof plain);
    if (!s)
        return fail_memory(err, predict_max, "predictions");
    Status status = STATUS_OK;
    for (size_t d = 0, at = 0; d < problem->n_var; d++)
        for (const size_t end = at + n_coordinates(problem, d); at < end; at++)
            s->is_held[at] = problem_kind(problem, d) == VARIABLE_CHOICE;
    if (s->n_dim <= RBF_DIM_MAX) {
        THEN(status, rbf_create(&s->rbf, surrogate_max, s->n_dim, s->n_out, err));
        THEN(status, rbf_create(&s->success, surrogate_max, s->n_dim, 1, err));
    }
    if (status != STATUS_OK) {
        surrogate_free(s);
        *out = NULL;
    }
    return status;
}

void surrogate_free(Surrogate *s)
{
    if (s) {
        free(s->rbf);
        free(s->success);
    }
    free(s);
}

/* Rows by distance, equal ones by row. */
static int compare_rows(const void *first, const void *second, void *distance)
{
    const size_t a = *(const size_t *)first, b = *(const size_t *)second;
    const double *d = distance;
    return d[a] != d[b] ? (d[a] > d[b] ? 1 : -1) : (a > b) - (a < b);
}

/* Output k of a design: an objective, or behind them a constraint. */
static double output_of(const Archive *a, size_t row, size_t k)
{
    return k < a->n_obj ? a->F[row * a->n_obj + k] : a->G[row * a->n_con + k - a->n_obj];
}

static int is_centre(const Archive *a, size_t i)
{
    int fits = a->usable[i];
    for (size_t k = 0; fits && k < a->n_obj + a->n_con; k++)
        fits = fabs(output_of(a, i, k)) < VALUE_MAX;
    return fits;
}

/* Rows of the centres, into the archive's scratch; returns how many. */
static size_t select_centres(const Surrogate *s, const Archive *a, Infill *near)
{
    size_t n = 0, *centre = a->scratch.row;
    double *distance = a->scratch.value;
    for (size_t i = 0; i < a->n; i++)
        if (is_centre(a, i))
            centre[n++] = i;
    if (n <= s->n_max)
        return n;
    for (size_t i = 0; i < n; i++)
        distance[centre[i]] = infill_distance(near, a->F + centre[i] * a->n_obj);
    qsort_r(centre, n, sizeof *centre, compare_rows, distance);
    const size_t n_near = s->n_max - s->n_max / SPREAD_CENTRES_SHARE, n_rest = n - n_near, n_spread = s->n_max - n_near;
    for (size_t i = n_near; i < n; i++) /* the rest in the order of evaluation */
        distance[centre[i]] = 0.0;
    qsort_r(centre + n_near, n_rest, sizeof *centre, compare_rows, distance);
    for (size_t i = 0; i < n_spread; i++)
        centre[n_near + i] = centre[n_near + i * n_rest / n_spread];
    return s->n_max;
}

/* A limit that is never below 0, and 0 where it is kept, is learned with a slope there: minus the distance from the
 * nearest design that violates it, times the median of what such designs have over theirs. No such design has more than
 * its own distance comes to: of those that say no more than 1 it tells which are near. */
static void grade(Surrogate *s, size_t k)
{
    double *slope = s->errors, *across = slope + s->n_max;
    size_t n = 0;
    for (size_t i = 0; i < s->n; i++)
        if (s->F[i * s->n_out + k] > 0.0)
            n++;
        else if (s->F[i * s->n_out + k] < 0.0)
            return;
    if (n == 0 || n == s->n)
        return;
    for (size_t i = n = 0; i < s->n; i++) {
        const double g = s->F[i * s->n_out + k];
        double nearest = DBL_MAX;
        for (size_t j = 0; j < s->n; j++) {
            double square = (s->F[j * s->n_out + k] > 0.0) == (g > 0.0) ? DBL_MAX : DBL_EPSILON;
            for (size_t d = 0; d < s->n_dim && square < nearest; d++) {
                const double off = s->U[i * s->n_dim + d] - s->U[j * s->n_dim + d];
                square += off * off;
            }
            nearest = fmin(nearest, square);
        }
        across[i] = sqrt(nearest);
        if (g > 0.0)
            slope[n++] = g / across[i];
    }
    sort_values(n, slope);
    s->range[k] = 0.0;
    for (size_t i = 0; i < s->n; i++) {
        double *g = &s->F[i * s->n_out + k], far = slope[n / 2] * across[i];
        *g = *g > 0.0 ? fmin(*g, far) : -far;
        s->range[k] = fmax(s->range[k], fabs(*g));
    }
}

/* Least squares on 1 and 0 (Rasmussen and Williams, 6.5) over all designs, thinned evenly beyond n_max. */
static Status fit_success(Surrogate *s, const Archive *a, int tuning, Err *err)
{
    size_t n = 0, n_designs = 0;
    for (size_t i = 0; i < a->n; i++)
        n_designs += a->replicates[i] > 0;
    const size_t kept = MIN_OF(n_designs, s->n_max);
    s->knows_failures = 0;
    if (a->n_failed == 0)
        return STATUS_OK;
    for (size_t i = 0, k = 0; i < a->n; i++) {
        if (a->replicates[i] == 0 || (k++) * kept / n_designs < n || n == kept)
            continue;
        surrogate_coordinates(s->problem, a->X + i * a->n_var, s->U + n * s->n_dim);
        s->F[n++] = a->usable[i] || (a->kind[i] == KIND_SCREENED && a->ok[i]); /* which may have been dropped */
    }
    TRY((tuning ? rbf_tune : rbf_fit)(s->success, n, s->U, s->F, NULL, err));
    s->knows_failures = rbf_explained(s->success, 0) > 0.0;
    return STATUS_OK;
}

Status surrogate_fit(Surrogate *s, const Archive *a, Infill *near, Err *err)
{
    s->fitted = 0;
    if (!s->rbf || a->n_usable < 4 || a->n_usable < s->problem->n_var / 2)
        return STATUS_OK;
    s->n = select_centres(s, a, near);
    if (s->n < 4)
        return STATUS_OK;
    for (size_t i = 0; i < s->n; i++) {
        const size_t row = a->scratch.row[i];
        surrogate_coordinates(s->problem, a->X + row * a->n_var, s->U + i * s->n_dim);
        for (size_t k = 0; k < s->n_out; k++) {
            s->F[i * s->n_out + k] = output_of(a, row, k);
            s->noise[i * s->n_out + k] = 1.0 / (double)a->replicates[row];
        }
    }
    for (size_t k = 0; k < s->n_out; k++) {
        double min = DBL_MAX, max = -DBL_MAX;
        for (size_t i = 0; i < a->n; i++) {
            if (is_centre(a, i)) {
                min = fmin(min, output_of(a, i, k));
                max = fmax(max, output_of(a, i, k));
            }
        }
        s->range[k] = max > min ? max - min : 1.0;
        if (k >= a->n_obj)
            grade(s, k);
    }
    const size_t share = a->n > s->n_max ? RETUNE_SHARE / 2 : RETUNE_SHARE;
    const int tuning = s->n_tuned == 0 || a->n >= s->n_tuned + (s->n_tuned + share - 1) / share;
    TRY((tuning ? rbf_tune : rbf_fit)(s->rbf, s->n, s->U, s->F, a->n_replicates > 0 ? s->noise : NULL, err));
    s->n_tuned = tuning ? a->n : s->n_tuned;
    s->fitted = 1;
    return fit_success(s, a, tuning, err);
}

void surrogate_drop(Surrogate *s)
{
    s->fitted = 0;
}

int surrogate_is_usable(const Surrogate *s)
{
    double explained = 0.0;
    for (size_t k = 0; s->fitted && k < s->problem->n_obj; k++)
        explained += fmax(rbf_explained(s->rbf, k), 0.0) / (double)s->problem->n_obj;
    return s->fitted && explained > R2_MIN;
}

double surrogate_waves(const Surrogate *s)
{
    double n = 0.0;
    for (size_t k = 0; s->fitted && k < s->problem->n_obj; k++)
        n += rbf_is_additive(s->rbf, k);
    return n / (double)s->problem->n_obj;
}

size_t surrogate_left_out(const Surrogate *s)
{
    return s->fitted ? rbf_left_out(s->rbf) : 0;
}

double surrogate_error(const Surrogate *s)
{
    double worst = s->fitted ? 0.0 : NAN;
    for (size_t k = 0; s->fitted && k < s->problem->n_obj; k++) {
        const double *e = rbf_leave_one_out(s->rbf, k);
        for (size_t i = 0; i < s->n; i++)
            s->errors[i] = fabs(e[i]) / s->range[k];
        sort_values(s->n, s->errors);
        worst = fmax(worst, 0.5 * (s->errors[(s->n - 1) / 2] + s->errors[s->n / 2]));
    }
    return worst;
}

void surrogate_predict(Surrogate *s, Population *population, size_t first, int with_uncertainty)
{
    const Problem *p = s->problem;
    const size_t n_dim = s->n_dim;
    size_t n = 0;

    /* 1. Members to be predicted, and their designs in the unit cube. */
    for (size_t i = first; i < population->n && s->fitted; i++)
        if (population->row[i] == PREDICTED) {
            surrogate_coordinates(p, population->X + i * p->n_var, s->u + n * n_dim);
            s->member[n++] = i;
        }

        /* 2. Predictions, a block at a time. */
#pragma omp parallel for schedule(dynamic, 1)
    for (size_t i = 0; i < n; i += RBF_BLOCK) {
        const size_t count = MIN_OF(n - i, RBF_BLOCK);
        rbf_eval(s->rbf, count, s->u + i * n_dim, s->f + i * s->n_out, with_uncertainty ? s->e + i * s->n_out : NULL);
        if (s->knows_failures)
            rbf_eval(s->success, count, s->u + i * n_dim, s->chance + i, NULL);
    }

    /* 3. Limits hold with a probability, normal about the predictions with standard deviation e. A regression of
     * success on 1 and 0 is drawn towards its mean: its square is the nearer one to the probability where little is
     * known. */
    for (size_t j = 0; j < n; j++) {
        const size_t i = s->member[j];
        const double *f = s->f + j * s->n_out, *g = f + p->n_obj, *e = with_uncertainty ? s->e + j * s->n_out : NULL;
        const double success = s->knows_failures ? s->chance[j] : 1.0;
        double chance = 1.0, worst = 0.0;
        for (size_t c = 0; c < p->n_con; c++) {
            const double error = e ? e[p->n_obj + c] : 0.0;
            chance *= error > 0.0 ? 0.5 * erfc(g[c] / (error * M_SQRT2)) : g[c] <= 0.0;
        }
        for (size_t k = 0; e && k < s->n_out; k++)
            worst = fmax(worst, e[k] / s->range[k]);
        copy_values(p->n_obj, f, population->F + i * p->n_obj);
        for (size_t k = 0; k < p->n_obj; k++)
            population->error[i * p->n_obj + k] = e ? e[k] : 0.0;
        population->violation[i] = violation_of(p->n_con, g) + fmax(SUCCESS_MIN - success, 0.0);
        population->uncertainty[i] = worst;
        population->chance[i] = chance * pow(fmin(fmax(success, 0.0), 1.0), SUCCESS_POWER);
    }
}

/* Of a descent: u, f, J, success and its derivatives, which lie together for a block of them, as rbf_slope takes them;
 * best point, gradient, the one before, steps, derivatives by the objectives. */
static size_t descent_length(const Surrogate *s)
{
    const size_t d = s->n_dim;
    return d + s->n_out + s->n_out * d + 1 + d + 4 * d + s->problem->n_obj;
}

/* n <= RBF_BLOCK descents side by side, starting at U, by resilient back-propagation; the best point of each goes
 * there. */
static void descend(const Surrogate *s, size_t n, const Infill *const near[], const size_t vectors[], double *U)
{
    const size_t n_dim = s->n_dim, n_obj = s->problem->n_obj, n_out = s->n_out;
    const double longest = 10.0 * DESCENT_STEP_FIRST;
    double *F = U + RBF_BLOCK * n_dim, *J = F + RBF_BLOCK * n_out, *success = J + RBF_BLOCK * n_out * n_dim,
           *J_success = success + RBF_BLOCK, *rest = J_success + RBF_BLOCK * n_dim;
    double least[RBF_BLOCK], least_violation[RBF_BLOCK];
    for (int step = 0; step < DESCENT_STEPS; step++) {
        rbf_slope(s->rbf, n, U, F, J);
        if (s->knows_failures)
            rbf_slope(s->success, n, U, success, J_success);
        for (size_t p = 0; p < n; p++) {
            const double *f = F + p * n_out, *slopes = J + p * n_out * n_dim;
            double *u = U + p * n_dim, *best = rest + p * (4 * n_dim + n_obj), *g = best + n_dim, *last = g + n_dim,
                   *size = last + n_dim, *slope = size + n_dim;

            /* 1. The criterion's gradient, and what a limit or a predicted failure adds. */
            const double value = infill_slope(near[p], vectors[p], f, slope);
            double violation = s->knows_failures ? fmax(SUCCESS_MIN - success[p], 0.0) : 0.0;
            for (size_t d = 0; d < n_dim; d++) {
                g[d] = 0.0;
                for (size_t k = 0; k < n_obj; k++)
                    g[d] += slope[k] * slopes[k * n_dim + d];
                if (violation > 0.0)
                    g[d] -= PENALTY * J_success[p * n_dim + d];
            }
            for (size_t c = n_obj; c < n_out; c++) {
                if (!(f[c] > 0.0))
                    continue;
                violation += f[c] / s->range[c];
                for (size_t d = 0; d < n_dim; d++)
                    g[d] += PENALTY * slopes[c * n_dim + d] / s->range[c];
            }

            /* 2. The best point so far, and the next one. */
            if (step == 0 || violation < least_violation[p] || (violation == least_violation[p] && value < least[p])) {
                least_violation[p] = violation;
                least[p] = value;
                copy_values(n_dim, u, best);
            }
            for (size_t d = 0; d < n_dim; d++) {
                if (step == 0) {
                    size[d] = DESCENT_STEP_FIRST;
                    last[d] = 0.0;
                }
                const double move = s->is_held[d] ? 0.0 : rprop_move(g[d], &last[d], &size[d]);
                u[d] = fmin(fmax(u[d] + fmin(fmax(move, -longest), longest), 0.0), 1.0);
            }
        }
    }
    for (size_t p = 0; p < n; p++)
        copy_values(n_dim, rest + p * (4 * n_dim + n_obj), U + p * n_dim);
}

void surrogate_descend(Surrogate *s, const Archive *a, Infill *const select[], size_t n_first, size_t n,
                       const size_t vectors[], double X[])
{
    const Problem *p = s->problem;
    const size_t length = descent_length(s);
#pragma omp parallel for schedule(dynamic, 1)
    for (size_t i = 0; i < n; i += RBF_BLOCK) {
        const size_t count = MIN_OF(n - i, RBF_BLOCK);
        const Infill *near[RBF_BLOCK];
        double *U = s->descent + i * length, *x = X + i * p->n_var;
        for (size_t j = 0; j < count; j++) {
            near[j] = select[i + j < n_first ? INFILL_HYPERVOLUME : INFILL_PBI];
            copy_values(p->n_var, a->X + infill_best(near[j], vectors[i + j]) * p->n_var, x + j * p->n_var);
            surrogate_coordinates(p, x + j * p->n_var, U + j * s->n_dim);
        }
        descend(s, count, near, vectors + i, U);
        for (size_t j = 0; j < count; j++) { /* choices stay */
            const double *u = U + j * s->n_dim;
            for (size_t d = 0; d < p->n_var; u += n_coordinates(p, d), d++)
                if (problem_kind(p, d) != VARIABLE_CHOICE)
                    x[j * p->n_var + d] = problem_from_unit(p, d, *u);
        }
    }
}

void surrogate_pack(Surrogate *s, Pack *p)
{
    pack_size(p, &s->n_tuned, UINT32_MAX);
    if (s->rbf)
        rbf_pack(s->rbf, p);
    if (s->success)
        rbf_pack(s->success, p);
}
