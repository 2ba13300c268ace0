#include "moga/surface.h"

#include <float.h>
#include <math.h>

#include "base/carve.h"
#include "moga/constants.h"
#include "moga/dominance.h"
#include "moga/order.h"

static const double ANSWER_MAX = 1e60;

struct Surface {
    const Problem *problem;
    Rbf *rbf;
    size_t n_out, n_max, n_archive_max, predict_max;
    size_t n, n_tuned; /* centres; archive's size at the last tuning */
    int fitted;
    double *U, *F;     /* (n_max, n_var) (n_max, n_out) centres */
    double *noise;     /* (n_max, n_out) variances of the answers, of each output's nugget */
    double *range;     /* (n_out) of each output in the archive */
    double *errors;    /* (n_max) sorted for the median */
    size_t *member;    /* (predict_max) of a group, that want a prediction */
    double *descent;   /* (predict_max + RBF_BLOCK, descent_length) */
    double *u, *f, *e; /* (predict_max, n_var) (predict_max, n_out) twice */
    void *store;
    size_t *chosen, *spare; /* (n_archive_max) rows in use; they grow with the archive */
    double *distance;       /* (n_archive_max) */
};

static size_t descent_length(const Surface *s);

static void layout(Surface *s, Carve *c)
{
    const size_t n_var = s->problem->n_var;
    s->U = carve(c, s->n_max * n_var, sizeof(double));
    s->F = carve(c, s->n_max * s->n_out, sizeof(double));
    s->noise = carve(c, s->n_max * s->n_out, sizeof(double));
    s->range = carve(c, s->n_out, sizeof(double));
    s->errors = carve(c, s->n_max, sizeof(double));
    s->u = carve(c, s->predict_max * n_var, sizeof(double));
    s->f = carve(c, s->predict_max * s->n_out, sizeof(double));
    s->e = carve(c, s->predict_max * s->n_out, sizeof(double));
    s->member = carve(c, s->predict_max, sizeof(size_t));
    s->descent = carve(c, (s->predict_max + RBF_BLOCK) * descent_length(s), sizeof(double));
}

Status surface_create(Surface **out, const Problem *problem, size_t surrogate_max, size_t predict_max, Err *err)
{
    Surface *s = calloc(1, sizeof *s);
    *out = s;
    if (!s)
        return fail(err, STATUS_NO_MEMORY, "no memory for the response surface");
    s->problem = problem;
    s->n_out = problem->n_obj + problem->n_con;
    s->n_max = surrogate_max;
    s->predict_max = predict_max;
    Status status = STATUS_OK;
    if (problem->n_var <= RBF_DIM_MAX)
        status = rbf_create(&s->rbf, surrogate_max, problem->n_var, s->n_out, err);
    if (status == STATUS_OK) {
        Carve c = {0};
        layout(s, &c);
        s->store = carve_store(&c);
        if (!s->store)
            status = fail(err, STATUS_NO_MEMORY, "no memory for %zu predictions", predict_max);
    }
    if (status != STATUS_OK) {
        surface_free(s);
        *out = NULL;
        return status;
    }
    layout(s, &(Carve){.base = s->store});
    return STATUS_OK;
}

void surface_free(Surface *s)
{
    if (s) {
        rbf_free(s->rbf);
        free(s->store);
        free(s->chosen);
        free(s->spare);
        free(s->distance);
    }
    free(s);
}

static Status grow(Surface *s, size_t n, Err *err)
{
    if (n <= s->n_archive_max)
        return STATUS_OK;
    free(s->chosen);
    free(s->spare);
    free(s->distance);
    s->n_archive_max = 2 * n;
    s->chosen = calloc(2 * n, sizeof *s->chosen);
    s->spare = calloc(2 * n, sizeof *s->spare);
    s->distance = calloc(2 * n, sizeof *s->distance);
    if (!s->chosen || !s->spare || !s->distance) {
        s->n_archive_max = 0;
        return fail(err, STATUS_NO_MEMORY, "no memory for the choice among %zu designs", n);
    }
    return STATUS_OK;
}

/* Merge sort of rows by distance, equal ones by row. */
static void sort_by_distance(const double distance[], size_t n, size_t rows[], size_t spare[])
{
    if (n < 2)
        return;
    const size_t half = n / 2;
    sort_by_distance(distance, half, rows, spare);
    sort_by_distance(distance, n - half, rows + half, spare);
    memcpy(spare, rows, half * sizeof *rows);
    for (size_t i = 0, j = half, k = 0; i < half; k++)
        rows[k] = j < n && distance[rows[j]] < distance[spare[i]] ? rows[j++] : spare[i++];
}

/* Answers beyond all reason, penalties say, would leave nothing of the others. */
static int is_centre(const Archive *a, size_t i)
{
    int fits = a->usable[i];
    for (size_t k = 0; fits && k < a->n_obj; k++)
        fits = fabs(a->F[i * a->n_obj + k]) < ANSWER_MAX;
    for (size_t k = 0; fits && k < a->n_con; k++)
        fits = fabs(a->G[i * a->n_con + k]) < ANSWER_MAX;
    return fits;
}

/* Rows of the centres, in chosen; returns how many. */
static size_t choose_centres(Surface *s, const Archive *a, Infill *near)
{
    size_t n = 0;
    for (size_t i = 0; i < a->n; i++)
        if (is_centre(a, i))
            s->chosen[n++] = i;
    if (n <= s->n_max)
        return n;
    for (size_t i = 0; i < n; i++)
        s->distance[s->chosen[i]] = infill_distance(near, a->F + s->chosen[i] * a->n_obj);
    sort_by_distance(s->distance, n, s->chosen, s->spare);
    const size_t n_near = s->n_max - s->n_max / SPREAD_CENTRES_SHARE, n_rest = n - n_near, n_spread = s->n_max - n_near;
    for (size_t i = 0; i < a->n; i++) /* the rest in the order of simulation again: as distance of itself */
        s->distance[i] = (double)i;
    sort_by_distance(s->distance, n_rest, s->chosen + n_near, s->spare);
    for (size_t i = 0; i < n_spread; i++)
        s->chosen[n_near + i] = s->chosen[n_near + i * n_rest / n_spread];
    return s->n_max;
}

static void to_unit_cube(const Problem *p, const double x[], double u[])
{
    for (size_t d = 0; d < p->n_var; d++)
        u[d] = p->upper[d] > p->lower[d] ? (x[d] - p->lower[d]) / (p->upper[d] - p->lower[d]) : 0.0;
}

static void measure_ranges(Surface *s, const Archive *a)
{
    for (size_t k = 0; k < s->n_out; k++) {
        double least = DBL_MAX, most = -DBL_MAX;
        for (size_t i = 0; i < a->n; i++) {
            if (!is_centre(a, i))
                continue;
            const double v = k < a->n_obj ? a->F[i * a->n_obj + k] : a->G[i * a->n_con + k - a->n_obj];
            least = fmin(least, v);
            most = fmax(most, v);
        }
        s->range[k] = most > least ? most - least : 1.0;
    }
}

Status surface_fit(Surface *s, const Archive *a, Infill *near, Err *err)
{
    s->fitted = 0;
    if (!s->rbf || a->n_usable < 4 || a->n_usable < s->problem->n_var / 2)
        return STATUS_OK;
    TRY(grow(s, a->n, err));
    s->n = choose_centres(s, a, near);
    if (s->n < 4)
        return STATUS_OK;
    for (size_t i = 0; i < s->n; i++) {
        const size_t row = s->chosen[i];
        to_unit_cube(s->problem, a->X + row * a->n_var, s->U + i * a->n_var);
        memcpy(s->F + i * s->n_out, a->F + row * a->n_obj, a->n_obj * sizeof *s->F);
        memcpy(s->F + i * s->n_out + a->n_obj, a->G + row * a->n_con, a->n_con * sizeof *s->F);
        for (size_t k = 0; k < s->n_out; k++)
            s->noise[i * s->n_out + k] = 1.0 / (double)a->answers[row];
    }
    measure_ranges(s, a);
    TRY(rbf_fit(s->rbf, s->n, s->U, s->F, a->n_repeats > 0 ? s->noise : NULL, err));
    if (s->n_tuned == 0 || a->n >= s->n_tuned + (s->n_tuned + RETUNE_SHARE - 1) / RETUNE_SHARE) {
        TRY(rbf_tune(s->rbf, err));
        s->n_tuned = a->n;
    }
    s->fitted = 1;
    return STATUS_OK;
}

void surface_estimate(const Surface *s, Archive *a)
{
    for (size_t k = 0; s->fitted && k < a->n_obj; k++)
        spread_estimate(s->n, s->chosen, rbf_leave_one_out(s->rbf, k), a->n_obj, k, a->F, a->error, a->estimate);
}

void surface_drop(Surface *s)
{
    s->fitted = 0;
}

int surface_stands(const Surface *s)
{
    double explained = 0.0;
    for (size_t k = 0; s->fitted && k < s->problem->n_obj; k++)
        explained += fmax(rbf_explained(s->rbf, k), 0.0) / (double)s->problem->n_obj;
    return s->fitted && explained > R2_MIN + R2_CHANCE / sqrt((double)s->n);
}

double surface_error(const Surface *s)
{
    double worst = s->fitted ? 0.0 : NAN;
    for (size_t k = 0; s->fitted && k < s->problem->n_obj; k++) {
        const double *e = rbf_leave_one_out(s->rbf, k);
        for (size_t i = 0; i < s->n; i++)
            s->errors[i] = fabs(e[i]) / s->range[k];
        sort_numbers(s->n, s->errors);
        worst = fmax(worst, 0.5 * (s->errors[(s->n - 1) / 2] + s->errors[s->n / 2]));
    }
    return worst;
}

/* Rows of the group that want a prediction, and their designs in the unit cube; returns how many. */
static size_t gather(Surface *s, const Group *group, size_t first)
{
    size_t n = 0;
    for (size_t i = first; i < group->n; i++)
        if (group->row[i] == PREDICTED) {
            to_unit_cube(s->problem, group->X + i * group->n_var, s->u + n * group->n_var);
            s->member[n++] = i;
        }
    return n;
}

static void fill_member(const Surface *s, Group *group, size_t i, const double f[], const double e[])
{
    const Problem *p = s->problem;
    double worst = 0.0;
    for (size_t k = 0; e && k < s->n_out; k++)
        worst = fmax(worst, e[k] / s->range[k]);
    memcpy(group->F + i * p->n_obj, f, p->n_obj * sizeof *f);
    group->violation[i] = violation_of(p->n_con, f + p->n_obj);
    group->uncertainty[i] = worst;
}

void surface_predict(Surface *s, Group *group, size_t first, int with_uncertainty)
{
    const size_t n_var = s->problem->n_var, n = s->fitted ? gather(s, group, first) : 0;
#pragma omp parallel for schedule(dynamic, 1)
    for (size_t i = 0; i < n; i += RBF_BLOCK)
        rbf_eval(s->rbf, n - i < RBF_BLOCK ? n - i : RBF_BLOCK, s->u + i * n_var, s->f + i * s->n_out,
                 with_uncertainty ? s->e + i * s->n_out : NULL);
    for (size_t i = 0; i < n; i++)
        fill_member(s, group, s->member[i], s->f + i * s->n_out, with_uncertainty ? s->e + i * s->n_out : NULL);
}

/* One descent's own numbers; u, f and J of a block lie together, as the surface takes them. */
typedef struct {
    double *best, *g, *last, *step, *slope;
    double least;
} Descent;

static size_t descent_length(const Surface *s)
{
    const size_t d = s->problem->n_var;
    return d + s->n_out + s->n_out * d + 4 * d + s->problem->n_obj;
}

static Descent descent_on(const Surface *s, double *store)
{
    const size_t d = s->problem->n_var;
    return (Descent){store, store + d, store + 2 * d, store + 3 * d, store + 4 * d, INFINITY};
}

/* One step of resilient back-propagation at u, where the surface is f with the derivatives J. */
static void descent_step(const Surface *s, const Infill *near, size_t direction, Descent *w, double u[],
                         const double f[], const double J[])
{
    const size_t n_var = s->problem->n_var;
    const double value = infill_slope(near, direction, f, w->slope);
    if (value < w->least) {
        w->least = value;
        memcpy(w->best, u, n_var * sizeof *u);
    }
    for (size_t d = 0; d < n_var; d++) {
        w->g[d] = 0.0;
        for (size_t k = 0; k < s->problem->n_obj; k++)
            w->g[d] += w->slope[k] * J[k * n_var + d];
        const double agreed = w->g[d] * w->last[d];
        w->step[d] *= agreed > 0.0 ? DESCENT_GROW : agreed < 0.0 ? DESCENT_SHRINK : 1.0;
        w->last[d] = agreed < 0.0 ? 0.0 : w->g[d];
        if (w->last[d] != 0.0)
            u[d] = fmin(fmax(u[d] - copysign(fmin(w->step[d], DESCENT_STEP_MAX), w->g[d]), 0.0), 1.0);
    }
}

/* n <= RBF_BLOCK descents in step with each other, starting at U; the best of each goes there. */
static void descend(const Surface *s, const Infill *near, size_t n, const size_t directions[], double *store)
{
    const size_t n_var = s->problem->n_var, own = 4 * n_var + s->problem->n_obj;
    double *U = store, *F = U + RBF_BLOCK * n_var, *J = F + RBF_BLOCK * s->n_out,
           *rest = J + RBF_BLOCK * s->n_out * n_var;
    Descent w[RBF_BLOCK];
    for (size_t p = 0; p < n; p++) {
        w[p] = descent_on(s, rest + p * own);
        for (size_t d = 0; d < n_var; d++) {
            w[p].step[d] = DESCENT_STEP_FIRST;
            w[p].last[d] = 0.0;
        }
    }
    for (int step = 0; step < DESCENT_STEPS; step++) {
        rbf_slope(s->rbf, n, U, F, J);
        for (size_t p = 0; p < n; p++)
            descent_step(s, near, directions[p], &w[p], U + p * n_var, F + p * s->n_out, J + p * s->n_out * n_var);
    }
    for (size_t p = 0; p < n; p++)
        memcpy(U + p * n_var, w[p].best, n_var * sizeof *U);
}

static void from_unit_cube(const Problem *p, const double u[], double x[])
{
    for (size_t d = 0; d < p->n_var; d++)
        x[d] = fmin(fmax(p->lower[d] + u[d] * (p->upper[d] - p->lower[d]), p->lower[d]), p->upper[d]);
}

void surface_descend(Surface *s, const Archive *a, const Infill *near, size_t n, const size_t directions[], double X[])
{
    const Problem *p = s->problem;
    const size_t length = descent_length(s);
#pragma omp parallel for schedule(dynamic, 1)
    for (size_t i = 0; i < n; i += RBF_BLOCK) {
        const size_t count = n - i < RBF_BLOCK ? n - i : RBF_BLOCK;
        double *U = s->descent + i * length;
        for (size_t j = 0; j < count; j++)
            to_unit_cube(p, a->X + infill_best(near, directions[i + j]) * p->n_var, U + j * p->n_var);
        descend(s, near, count, directions + i, U);
        for (size_t j = 0; j < count; j++)
            from_unit_cube(p, U + j * p->n_var, X + (i + j) * p->n_var);
    }
}

void surface_pack(Surface *s, Pack *p)
{
    pack_size(p, &s->n_tuned, SIZE_MAX);
    if (s->rbf)
        rbf_pack(s->rbf, p);
}
