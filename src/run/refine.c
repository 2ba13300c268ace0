#include "run/refine.h"

#include <float.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/clock.h"
#include "polish/polish.h"
#include "rbf/rbf.h"
#include "run/subject.h"

enum { CENTRES_MAX = 250, SURFACE_EVALS = 2000 };

/* Part of the box, each way, in which the surface is believed at first; where that shrinks below the least, it is left.
 */
static const double TRUST = 0.1, TRUST_MOST = 0.3, TRUST_LEAST = 0.002;

typedef struct {
    const Saved *run;
    size_t row;
    const RefineConfig *config;
    Subject *subject;
    double f[2 * OBJECTIVES_MAX], spread[2 * OBJECTIVES_MAX], violation[2]; /* of the last answers, natural */
    size_t heard;                                                           /* simulations told so far */
    double slack[OBJECTIVES_MAX];
    double error[OBJECTIVES_MAX]; /* by which the surface was wrong about its last proposal */
} Refine;

/* -- step 1: the surface ---------------------------------------------------------------------------------------------
 */

/* The designs nearest to the start, in the unit cube, and those that were tried since: X (n, n_var), F (n, n_obj)
 * minimised. */
typedef struct {
    const Problem *problem;
    Rbf *rbf;
    size_t n, n_max;
    double *U, *F, *u;            /* u (n_var) scratch */
    double shift[OBJECTIVES_MAX]; /* added to the surface, so that it is right at the best design */
} Surface;

static void to_cube(const Problem *p, const double x[], double u[])
{
    for (size_t d = 0; d < p->n_var; d++)
        u[d] = p->upper[d] > p->lower[d] ? (x[d] - p->lower[d]) / (p->upper[d] - p->lower[d]) : 0.0;
}

static Status predict(size_t n, const double X[], const size_t draws[], double F[], double G[], unsigned char ok[],
                      void *user, Err *err)
{
    const Surface *s = user;
    (void)draws;
    (void)G;
    (void)err;
    for (size_t i = 0; i < n; i++) {
        to_cube(s->problem, X + i * s->problem->n_var, s->u);
        rbf_eval(s->rbf, 1, s->u, F + i * s->problem->n_obj, NULL);
        for (size_t k = 0; k < s->problem->n_obj; k++)
            F[i * s->problem->n_obj + k] += s->shift[k];
        ok[i] = 1;
    }
    return STATUS_OK;
}

typedef struct {
    double distance;
    size_t row;
} Near;

static int by_distance(const void *a, const void *b)
{
    const Near *x = a, *y = b;
    return x->distance != y->distance ? (x->distance > y->distance) - (x->distance < y->distance)
                                      : (x->row > y->row) - (x->row < y->row);
}

/* Rows that simulated well, nearest to the design in the unit cube; returns how many. */
static size_t nearest_rows(const Refine *r, Near near[])
{
    const Saved *h = r->run;
    const Problem *p = subject_problem(r->subject);
    const double *at = h->X + r->row * p->n_var;
    size_t n = 0;
    for (size_t i = 0; i < h->n; i++) {
        if (!h->row[i].ok || h->row[i].kind == KIND_REPEAT)
            continue;
        near[n] = (Near){0.0, i};
        for (size_t d = 0; d < p->n_var; d++) {
            const double range = p->upper[d] - p->lower[d];
            const double step = range > 0.0 ? (h->X[i * p->n_var + d] - at[d]) / range : 0.0;
            near[n].distance += step * step;
        }
        n++;
    }
    qsort(near, n, sizeof *near, by_distance);
    return n < CENTRES_MAX ? n : CENTRES_MAX;
}

static void surface_add(Surface *s, const double x[], const double f[])
{
    to_cube(s->problem, x, s->U + s->n * s->problem->n_var);
    memcpy(s->F + s->n * s->problem->n_obj, f, s->problem->n_obj * sizeof *f);
    s->n++;
}

static void surface_close(Surface *s)
{
    rbf_free(s->rbf);
    free(s->U);
}

/* Filled with what the run has near the design; room for n_more. */
static Status surface_open(Surface *s, const Refine *r, size_t n_more, Err *err)
{
    const Saved *h = r->run;
    const Problem *p = subject_problem(r->subject);
    Near *near = calloc(h->n + 1, sizeof *near);
    double f[OBJECTIVES_MAX], unused[OBJECTIVES_MAX];
    if (!near)
        return fail(err, STATUS_NO_MEMORY, "no memory for %zu designs", h->n);
    const size_t n = nearest_rows(r, near);
    *s = (Surface){
        .problem = p, .n_max = n + n_more, .U = calloc((n + n_more + 1) * (p->n_var + p->n_obj), sizeof(double))};
    s->F = s->U + s->n_max * p->n_var;
    s->u = s->F + s->n_max * p->n_obj;
    for (size_t i = 0; s->U && i < n; i++) {
        subject_judge(r->subject, 1, h->F + near[i].row * p->n_obj, f, unused);
        surface_add(s, h->X + near[i].row * p->n_var, f);
    }
    free(near);
    return s->U ? rbf_create(&s->rbf, s->n_max, p->n_var, p->n_obj, err)
                : fail(err, STATUS_NO_MEMORY, "no memory for a surface on %zu designs", n);
}

/* The best that the surface knows within `trust` of x with the objectives at; kept objectives stay below `bound` by
 * half of what the surface was wrong last time. */
static Status descend_surface(const Refine *r, Surface *s, const double x[], const double at[], const double bound[],
                              double trust, double guess[], Err *err)
{
    const Problem *p = s->problem;
    double f[OBJECTIVES_MAX], f_start[OBJECTIVES_MAX], slack[OBJECTIVES_MAX], *box = calloc(2 * p->n_var, sizeof *box);
    if (!box)
        return fail(err, STATUS_NO_MEMORY, "no memory for a design");
    for (size_t d = 0; d < p->n_var; d++) {
        const double reach = trust * (p->upper[d] - p->lower[d]);
        box[d] = fmax(p->lower[d], x[d] - reach);
        box[p->n_var + d] = fmin(p->upper[d], x[d] + reach);
    }
    to_cube(p, x, s->u);
    rbf_eval(s->rbf, 1, s->u, f, NULL);
    for (size_t k = 0; k < p->n_obj; k++) {
        s->shift[k] = at[k] - f[k];
        slack[k] = bound[k] - at[k] - 0.5 * r->error[k];
    }
    const Problem model = {
        .n_var = p->n_var, .n_obj = p->n_obj, .lower = box, .upper = box + p->n_var, .evaluate = predict, .user = s};
    const PolishConfig config = {.algorithm = "cobyla",
                                 .improve = r->config->improve,
                                 .keep = r->config->keep,
                                 .slack = slack,
                                 .max_evals = SURFACE_EVALS};
    PolishResult result = {.x = guess, .f = f, .f_start = f_start};
    const Status status = polish_run(&model, &config, x, &result, err);
    if (status == STATUS_OK && p->repair)
        p->repair(guess, p->user);
    free(box);
    return status;
}

static int holds(const Refine *r, const double f[], const double bound[], const double g[], size_t n_con)
{
    for (size_t k = 0; k < r->run->schema.n_obj; k++)
        if (r->config->keep[k] && k != r->config->improve && f[k] > bound[k])
            return 0;
    for (size_t c = 0; c < n_con; c++)
        if (g[c] > 0.0)
            return 0;
    return 1;
}

/* One more design from the surface, simulated; x, f become it where it is allowed and better. Trust grows with success
 * and shrinks with failure. */
static Status try_surface(Refine *r, Surface *s, const double bound[], double x[], double f[], double *trust,
                          double guess[], Refined *out, Err *err)
{
    const Problem *p = s->problem;
    double answer[OBJECTIVES_MAX], g[OBJECTIVES_MAX], foreseen[OBJECTIVES_MAX];
    unsigned char ok = 0;
    TRY(rbf_fit(s->rbf, s->n, s->U, s->F, NULL, err));
    if (out->n_tried % 8 == 0)
        TRY(rbf_tune(s->rbf, err));
    TRY(descend_surface(r, s, x, f, bound, *trust, guess, err));
    out->n_tried++;
    if (memcmp(guess, x, p->n_var * sizeof *x) == 0) { /* it knows nothing better so near */
        *trust *= 0.7;
        for (size_t k = 0; k < p->n_obj; k++)
            r->error[k] *= 0.5;
        return STATUS_OK;
    }
    TRY(p->evaluate(1, guess, NULL, answer, g, &ok, p->user, err));
    out->n_evaluated++;
    out->n_failed += !ok;
    if (ok)
        surface_add(s, guess, answer);
    const size_t k = r->config->improve;
    const int better = ok && answer[k] < f[k] && holds(r, answer, bound, g, p->n_con);
    const double change = better ? 1.5 : 0.7;
    *trust = fmin(change * *trust, TRUST_MOST);
    to_cube(p, guess, s->u);
    rbf_eval(s->rbf, 1, s->u, foreseen, NULL);
    for (size_t j = 0; j < p->n_obj; j++)
        r->error[j] = ok ? change * fabs(answer[j] - foreseen[j] - s->shift[j]) : change * r->error[j];
    if (better) {
        memcpy(x, guess, p->n_var * sizeof *x);
        memcpy(f, answer, p->n_obj * sizeof *f);
    }
    return STATUS_OK;
}

/* Surface and simulator in turn, from the design with the objectives f; the best is left in x. */
static Status follow_surface(Refine *r, double x[], double f[], size_t n_max, Refined *out, Err *err)
{
    const Problem *p = subject_problem(r->subject);
    Surface s = {0};
    double bound[OBJECTIVES_MAX], trust = TRUST, *guess = calloc(p->n_var, sizeof *guess);
    Status status = guess ? STATUS_OK : fail(err, STATUS_NO_MEMORY, "no memory for a design");
    for (size_t k = 0; k < p->n_obj; k++)
        bound[k] = f[k] + r->slack[k];
    if (status == STATUS_OK && p->n_var <= RBF_DIM_MAX)
        status = surface_open(&s, r, n_max, err);
    while (status == STATUS_OK && s.n > p->n_var && out->n_tried < n_max && trust > TRUST_LEAST)
        status = try_surface(r, &s, bound, x, f, &trust, guess, out, err);
    surface_close(&s);
    free(guess);
    return status;
}

/* -- steps 2 and 3: the simulator -------------------------------------------------------------------------------------
 */

/* The first two answers since `heard` was set to 0 are kept. */
static Status hear(const Simulation *simulation, void *user, Err *err)
{
    Refine *r = user;
    const size_t m = r->run->schema.n_obj, i = simulation->number > 1 ? 1 : 0;
    (void)err;
    r->heard++;
    memcpy(r->f + i * m, simulation->f, m * sizeof *r->f);
    memcpy(r->spread + i * m, simulation->spread, m * sizeof *r->spread);
    r->violation[i] = simulation->violation;
    return STATUS_OK;
}

static int may_go_on(void *user)
{
    const RefineConfig *c = ((const Refine *)user)->config;
    return !c->go_on || c->go_on(c->user);
}

static Status open_subject(Refine *r, long seed_shift, Err *err)
{
    Settings s = r->run->settings;
    s.sim.ensemble = r->config->members;
    s.search.seed = (s.search.seed + seed_shift) % 4294967296L;
    subject_close(r->subject);
    r->subject = NULL;
    TRY(subject_open(&r->subject, &s, err));
    r->heard = 0;
    subject_observe(r->subject, &(Observer){.go_on = may_go_on, .done = hear, .user = r}, 0);
    return STATUS_OK;
}

/* The design's own objectives f, and what a kept one may lose: a share of its value, else its spread. */
static Status begin(Refine *r, double f[], Refined *out, Err *err)
{
    const Problem *p = subject_problem(r->subject);
    double G[OBJECTIVES_MAX];
    unsigned char ok = 0;
    TRY(p->evaluate(1, r->run->X + r->row * p->n_var, NULL, f, G, &ok, p->user, err));
    out->n_evaluated++;
    if (!ok)
        return fail(err, STATUS_BAD_DATA, "the design to be polished cannot be evaluated");
    for (size_t k = 0; k < p->n_obj; k++)
        r->slack[k] = r->config->slack >= 0.0  ? r->config->slack * fabs(f[k])
                      : isfinite(r->spread[k]) ? r->spread[k]
                                               : 0.0;
    return STATUS_OK;
}

static Status polish_simulator(Refine *r, const double guess[], Refined *out, Err *err)
{
    const Problem *p = subject_problem(r->subject);
    const double *x = r->run->X + r->row * p->n_var;
    double f[OBJECTIVES_MAX], f_start[OBJECTIVES_MAX];
    const size_t spent = out->n_evaluated + 2,
                 left = r->config->max_evals > spent + 2 ? r->config->max_evals - spent : 2;
    const PolishConfig config = {.algorithm = r->config->algorithm,
                                 .improve = r->config->improve,
                                 .keep = r->config->keep,
                                 .slack = r->slack,
                                 .guess = guess,
                                 .max_evals = left,
                                 .max_seconds = r->config->max_seconds,
                                 .seed = (uint32_t)r->run->settings.search.seed};
    PolishResult result = {.x = out->x, .f = f, .f_start = f_start};
    TRY(polish_run(p, &config, x, &result, err));
    out->n_evaluated += result.n_evaluated;
    out->n_failed += result.n_failed;
    out->has_changed = memcmp(x, out->x, p->n_var * sizeof *x) != 0;
    return STATUS_OK;
}

/* Both designs with members of their own, so that what was picked for its luck is not believed. */
static Status compare(Refine *r, Refined *out, Err *err)
{
    TRY(open_subject(r, 1, err));
    const Problem *p = subject_problem(r->subject);
    const size_t m = p->n_obj, k = r->config->improve;
    double *X = calloc(2 * p->n_var, sizeof *X), F[2 * OBJECTIVES_MAX], G[2 * OBJECTIVES_MAX];
    unsigned char ok[2] = {0};
    if (!X)
        return fail(err, STATUS_NO_MEMORY, "no memory for two designs");
    memcpy(X, r->run->X + r->row * p->n_var, p->n_var * sizeof *X);
    memcpy(X + p->n_var, out->x, p->n_var * sizeof *X);
    const Status status = p->evaluate(2, X, NULL, F, G, ok, p->user, err);
    free(X);
    TRY(status);
    out->n_evaluated += 2;
    memcpy(out->f_start, r->f, m * sizeof *r->f);
    memcpy(out->f, r->f + m, m * sizeof *r->f);
    memcpy(out->spread_start, r->spread, m * sizeof *r->spread);
    memcpy(out->spread, r->spread + m, m * sizeof *r->spread);
    out->violation = r->violation[1];
    out->has_changed = out->has_changed && ok[0] && ok[1];
    out->gain = out->has_changed ? F[k] - F[m + k] : 0.0;
    out->gain_error = hypot(out->spread_start[k], out->spread[k]) / sqrt((double)r->config->members);
    return STATUS_OK;
}

static Status refine(Refine *r, Refined *out, Err *err)
{
    const size_t n_var = r->run->schema.n_var, m = r->run->schema.n_obj;
    double f[OBJECTIVES_MAX], *guess = calloc(n_var, sizeof *guess);
    out->x = calloc(n_var, sizeof *out->x);
    out->f_start = calloc(4 * m, sizeof *out->f_start);
    Status status = guess && out->x && out->f_start ? open_subject(r, 0, err)
                                                    : fail(err, STATUS_NO_MEMORY, "no memory for a design");
    out->f = out->f_start + m;
    out->spread_start = out->f_start + 2 * m;
    out->spread = out->f_start + 3 * m;
    if (status == STATUS_OK) {
        memcpy(guess, r->run->X + r->row * n_var, n_var * sizeof *guess);
        status = begin(r, f, out, err);
    }
    if (status == STATUS_OK)
        status = follow_surface(r, guess, f, r->config->max_evals / 2, out, err);
    if (status == STATUS_OK)
        status = polish_simulator(r, guess, out, err);
    if (status == STATUS_OK)
        status = compare(r, out, err);
    free(guess);
    return status;
}

Status refine_design(const Saved *h, size_t row, const RefineConfig *config, Refined *out, Err *err)
{
    RefineConfig used = *config;
    if (h->settings.problem.kind != PROBLEM_TOWER)
        used.members = 1;
    *out = (Refined){0};
    Refine r = {.run = h, .row = row, .config = &used};
    const double start = clock_seconds();
    const Status status = refine(&r, out, err);
    out->seconds = clock_seconds() - start;
    subject_close(r.subject);
    return status;
}

void refined_free(Refined *r)
{
    free(r->x);
    free(r->f_start);
    *r = (Refined){0};
}

int refined_counts(const Refined *r)
{
    return r->has_changed && (isfinite(r->gain_error) ? r->gain > 2.0 * r->gain_error : r->gain > 0.0);
}

StoredDesign refined_design(const Refined *r)
{
    StoredDesign d = {.x = r->x, .f = r->f, .spread = r->spread, .violation = r->violation};
    verdict_set(&d.verdict, "ok", "");
    d.verdict.seconds = r->seconds;
    return d;
}

Status refined_store(const char *folder, const Refined *r, long *id, Err *err)
{
    const StoredDesign d = refined_design(r);
    return store_add_evaluations(folder, 1, &d, id, err);
}

/* -- which designs ----------------------------------------------------------------------------------------------------
 */

/* Objective k of row i scaled to 0 (best of the front) .. 1 (worst). */
static double scaled(const Saved *h, size_t i, size_t k, const double best[], const double worst[])
{
    const double range = worst[k] - best[k];
    return range != 0.0 ? (h->F[i * h->schema.n_obj + k] - best[k]) / range : 0.0;
}

static void measure_box(const Saved *h, double best[], double worst[])
{
    for (size_t k = 0; k < h->schema.n_obj; k++) {
        const double sense = schema_objective(&h->schema, k)->sense;
        double least = DBL_MAX, most = -DBL_MAX;
        for (size_t i = 0; i < h->n; i++)
            if (h->row[i].on_front) {
                least = fmin(least, sense * h->F[i * h->schema.n_obj + k]);
                most = fmax(most, sense * h->F[i * h->schema.n_obj + k]);
            }
        best[k] = sense * least;
        worst[k] = sense * most;
    }
}

size_t refine_choose(const Saved *h, size_t n, size_t rows[], size_t improve[])
{
    const size_t m = h->schema.n_obj;
    double best[OBJECTIVES_MAX], worst[OBJECTIVES_MAX];
    size_t chosen = 0;
    measure_box(h, best, worst);
    for (; chosen < n; chosen++) {
        size_t found = h->n;
        double most = -DBL_MAX;
        for (size_t i = 0; i < h->n; i++) {
            double merit = chosen == 0 ? 0.0 : DBL_MAX;
            if (!h->row[i].on_front || (improve && h->row[i].id >= POLISHED_FIRST))
                continue;
            for (size_t k = 0; chosen == 0 && k < m; k++) /* the knee: nearest to the best of everything */
                merit -= pow(scaled(h, i, k, best, worst), 2.0);
            for (size_t c = 0; c < chosen; c++) { /* then the farthest from those chosen */
                double apart = 0.0;
                for (size_t k = 0; k < m; k++)
                    apart += pow(scaled(h, i, k, best, worst) - scaled(h, rows[c], k, best, worst), 2.0);
                merit = fmin(merit, apart);
            }
            if (merit > most && (chosen == 0 || merit > 0.0)) {
                most = merit;
                found = i;
            }
        }
        if (found == h->n)
            break;
        rows[chosen] = found;
        if (!improve)
            continue;
        improve[chosen] = 0;
        for (size_t k = 1; k < m; k++)
            if (scaled(h, found, k, best, worst) < scaled(h, found, improve[chosen], best, worst))
                improve[chosen] = k;
    }
    return chosen;
}
