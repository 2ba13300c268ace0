#include "study/polish.h"

#include <math.h>
#include <nlopt.h>
#include <stdlib.h>
#include <string.h>

#include "base/carve.h"
#include "base/clock.h"
#include "base/stat.h"

typedef struct {
    const char *name;
    nlopt_algorithm algorithm;
    int takes_constraints;
} Method;

static const Method METHODS[] = {
    {"cobyla", NLOPT_LN_COBYLA, 1},
    {"bobyqa", NLOPT_LN_BOBYQA, 0},
    {"sbplx", NLOPT_LN_SBPLX, 0},
    {"isres", NLOPT_GN_ISRES, 1},
};
enum { N_METHODS = sizeof METHODS / sizeof METHODS[0] };

/* Values are changes of the goal in its unit, excesses those of a constraint in units of its scale. */
static const double WALL = 1e3;        /* of a design that fails: finite, since models of it are fitted */
static const double PENALTY = 1e2;     /* weight of a squared excess: 0.1 of it costs a unit */
static const double MARGIN = 5e-3;     /* of every constraint, by which a square gives way at an optimum */
static const double FIRST_STEP = 0.02; /* in the unit cube: a design that is polished lies on a front */

typedef struct {
    Queue *queue;
    const Problem *problem;
    const PolishConfig *config;
    PolishResult *result;
    nlopt_opt opt;
    double start;       /* [s] of the clock */
    double value, unit; /* goal at the start, and in what it is counted */
    double *x, *f, *g;  /* of the last evaluation; x (n_var) in its own units */
    double *scale;      /* (n_obj) */
    double *each;       /* (n_obj + n_con) scratch */
    double *u, *at;     /* (n_var) the last evaluated point in the unit cube; NLopt's own */
    double excess;      /* worst of the constraints there, in units of their scale */
    double least;       /* best allowed value so far */
    int known, ok;      /* u has been evaluated; it did not fail */
    Status status;
    Err *err;
    void *store;
} Polish;

static void layout(void *polish, Carve *c)
{
    Polish *p = polish;
    const size_t n = p->problem->n_var, m = p->problem->n_obj, n_con = p->problem->n_con, real = sizeof(double);
    p->x = carve(c, n, real);
    p->u = carve(c, n, real);
    p->at = carve(c, n, real);
    p->f = carve(c, m, real);
    p->g = carve(c, n_con, real);
    p->scale = carve(c, m, real);
    p->each = carve(c, m + n_con, real);
}

/* Every constraint of the last evaluation, in units of its scale; returns how many. */
static size_t excesses(const Polish *p, double excess[])
{
    size_t n = 0;
    for (size_t k = 0; k < p->problem->n_obj; k++)
        if (isfinite(p->config->goal.bound[k]))
            excess[n++] = (p->f[k] - p->config->goal.bound[k]) / p->scale[k];
    for (size_t c = 0; c < p->problem->n_con; c++)
        excess[n++] = p->g[c];
    return n;
}

static double excess_of(const Polish *p)
{
    const size_t n = excesses(p, p->each);
    double worst = -INFINITY;
    for (size_t i = 0; i < n; i++)
        worst = fmax(worst, p->each[i]);
    return worst;
}

static void keep_if_best(Polish *p)
{
    const double value = goal_value(&p->config->goal, p->problem->n_obj, p->f);
    if (!p->ok || p->excess > 0.0 || !(value < p->least))
        return;
    p->least = value;
    memcpy(p->result->x, p->x, p->problem->n_var * sizeof *p->x);
    memcpy(p->result->f, p->f, p->problem->n_obj * sizeof *p->f);
}

/* The start is evaluated whatever the clock says. */
static int spent(const Polish *p)
{
    if (p->result->n_evaluated == 0 && p->status == STATUS_OK)
        return 0;
    return p->status != STATUS_OK || p->result->n_evaluated >= p->config->max_evals ||
           (p->config->max_seconds > 0.0 && clock_seconds() - p->start >= p->config->max_seconds);
}

/* NLopt asks objective and constraint apart: the same point is evaluated once. */
static void evaluate(Polish *p, const double u[])
{
    const Problem *q = p->problem;
    unsigned char ok = 0;
    if (p->known && memcmp(u, p->u, q->n_var * sizeof *u) == 0)
        return;
    if (spent(p)) {
        nlopt_force_stop(p->opt);
        return;
    }
    memcpy(p->u, u, q->n_var * sizeof *u);
    problem_from_cube(q, u, p->x);
    problem_repair(q, p->x);
    p->status = queue_evaluate(p->queue, 1, p->x, NULL, p->f, p->g, &ok, p->err);
    p->known = 1;
    p->ok = p->status == STATUS_OK && ok && all_finite(q->n_obj, p->f);
    p->result->n_evaluated++;
    p->result->n_failed += !p->ok;
    p->excess = p->ok ? excess_of(p) : WALL;
    keep_if_best(p);
}

static double value_at(Polish *p)
{
    const double value = p->ok ? goal_value(&p->config->goal, p->problem->n_obj, p->f) : INFINITY;
    return fmin((value - p->value) / p->unit, WALL);
}

static double objective(unsigned n, const double u[], double gradient[], void *user)
{
    (void)n;
    (void)gradient;
    Polish *p = user;
    evaluate(p, u);
    return value_at(p);
}

static double penalised(unsigned n, const double u[], double gradient[], void *user)
{
    (void)n;
    (void)gradient;
    Polish *p = user;
    evaluate(p, u);
    const double over =
        fmax(p->excess + MARGIN, 0.0); /* square: bobyqa's parabola fits no kink; it gives way a little */
    return fmin(value_at(p) + PENALTY * over * over, WALL);
}

/* One by one: a method that fits a plane to each of them is lost on the kinks of the greatest of all. */
static void constraints(unsigned n_each, double each[], unsigned n, const double u[], double gradient[], void *user)
{
    (void)n;
    (void)gradient;
    Polish *p = user;
    evaluate(p, u);
    if (p->ok)
        excesses(p, each);
    for (unsigned i = 0; i < n_each; i++)
        each[i] = p->ok ? fmin(fmax(each[i], -WALL), WALL) : WALL;
}

static Status find_method(const char *name, const Method **found, Err *err)
{
    for (size_t i = 0; i < N_METHODS; i++)
        if (strcmp(METHODS[i].name, name) == 0) {
            *found = &METHODS[i];
            return STATUS_OK;
        }
    return fail(err, STATUS_USAGE, "no algorithm is called '%.40s'; there are cobyla, bobyqa, sbplx, isres", name);
}

Status polish_knows(const char *algorithm, Err *err)
{
    const Method *unused;
    return find_method(algorithm, &unused, err);
}

static Status evaluate_start(Polish *p, const double start[])
{
    const Problem *q = p->problem;
    problem_to_cube(q, start, p->at);
    evaluate(p, p->at);
    if (p->status != STATUS_OK)
        return p->status;
    if (!p->ok)
        return fail(p->err, STATUS_BAD_DATA, "the design to be polished cannot be evaluated");
    memcpy(p->result->f, p->f, q->n_obj * sizeof *p->f);
    memcpy(p->result->x, p->x, q->n_var * sizeof *p->x);
    for (size_t k = 0; k < q->n_obj; k++) {
        p->scale[k] = p->f[k] != 0.0 ? fabs(p->f[k]) : 1.0;
        p->unit += fabs(p->config->goal.weight[k]) * p->scale[k];
    }
    p->unit = p->unit > 0.0 ? p->unit : 1.0;
    p->least = p->value = goal_value(&p->config->goal, q->n_obj, p->f);
    p->excess = excess_of(p);
    return STATUS_OK;
}

static void run_method(Polish *p, const Method *m)
{
    double unused;
    nlopt_set_lower_bounds1(p->opt, 0.0);
    nlopt_set_upper_bounds1(p->opt, 1.0);
    nlopt_set_initial_step1(p->opt, FIRST_STEP);
    nlopt_set_xtol_rel(p->opt, 1e-6);
    nlopt_set_maxeval(p->opt, (int)fmin(2.0 * (double)p->config->max_evals + 100.0, 1e9)); /* a second belt */
    nlopt_set_min_objective(p->opt, m->takes_constraints ? objective : penalised, p);
    const size_t n_each = excesses(p, p->each);
    if (m->takes_constraints && n_each > 0)
        nlopt_add_inequality_mconstraint(p->opt, (unsigned)n_each, constraints, p, NULL);
    nlopt_srand(p->config->seed);
    nlopt_optimize(p->opt, p->at, &unused); /* whatever it says: the best was kept on the way */
}

Status polish_run(Queue *queue, const PolishConfig *config, const double start[], PolishResult *result, Err *err)
{
    const Method *method = NULL;
    const Problem *problem = queue_problem(queue);
    TRY(find_method(config->algorithm, &method, err));
    Polish p = {.queue = queue,
                .problem = problem,
                .config = config,
                .result = result,
                .least = -INFINITY,
                .status = STATUS_OK,
                .start = clock_seconds(),
                .err = err};
    result->n_evaluated = result->n_failed = 0;
    p.store = carve_all(layout, &p);
    p.opt = nlopt_create(method->algorithm, (unsigned)problem->n_var);
    Status status = p.store && p.opt ? STATUS_OK : fail(err, STATUS_NO_MEMORY, "no memory for polishing");
    if (status == STATUS_OK)
        status = evaluate_start(&p, start);
    if (status == STATUS_OK) {
        run_method(&p, method);
        status = p.status;
    }
    nlopt_destroy(p.opt);
    free(p.store);
    return status;
}
