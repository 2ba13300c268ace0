#include "study/polish.h"

#include <nlopt.h>

#include "base/carve.h"
#include "base/stat.h"
#include "evaluate/tasks.h"

/* In the unit cube: a design that is polished lies on a front, so that the first step is short. */
static const double STEP = 0.05, STEP_MIN = 1e-4;

/* Descents in a row that gain no more than is worth it, each with half the step of the one before: then it ends. */
enum { IDLE_MAX = 2 };

/* Of a design that fails, and the largest excess: finite, since NLopt fits models to them. */
static const double WALL = 1e3;

typedef struct {
    Queue *queue;
    const Problem *problem;
    const PolishGoal *goal;
    Polished *best;
    nlopt_opt opt;
    double *u, *x, *f, *g; /* (n_var) the last design, in the unit cube and not, its answers */
    double *at;            /* (n_var) NLopt's own */
    double first, least;   /* value of the start, of the best */
    int is_known, ok;      /* u has been evaluated; it did not fail */
    Status status;
    Err *err;
    void *store;
} Polish;

static void layout(void *polish, Carve *c)
{
    Polish *p = polish;
    const size_t n_var = p->problem->n_var;
    CARVE(c, p->u, n_var);
    CARVE(c, p->x, n_var);
    CARVE(c, p->at, n_var);
    CARVE(c, p->f, p->problem->n_obj);
    CARVE(c, p->g, p->problem->n_con);
}

static double value_of(const Polish *p, const double f[])
{
    double value = 0.0;
    for (size_t k = 0; k < p->problem->n_obj; k++)
        value += p->goal->weight[k] * f[k] / p->goal->scale[k];
    return value;
}

/* What is bounded at the last design, <= 0 where it holds; returns how many. excess NULL: only counted. */
static unsigned excesses(const Polish *p, double excess[])
{
    unsigned n = 0;
    for (size_t i = 0; i < p->problem->n_obj + p->problem->n_con; i++) {
        const int is_objective = i < p->problem->n_obj;
        if (is_objective && !isfinite(p->goal->bound[i]))
            continue;
        const double over =
            is_objective ? (p->f[i] - p->goal->bound[i]) / p->goal->scale[i] : p->g[i - p->problem->n_obj];
        if (excess)
            excess[n] = p->ok ? fmin(fmax(over, -WALL), WALL) : WALL;
        n++;
    }
    return n;
}

static int is_allowed(const Polish *p)
{
    int allowed = p->ok;
    for (size_t k = 0; k < p->problem->n_obj; k++)
        allowed = allowed && p->f[k] <= p->goal->bound[k];
    for (size_t c = 0; c < p->problem->n_con; c++)
        allowed = allowed && p->g[c] <= 0.0;
    return allowed;
}

static void keep_if_best(Polish *p)
{
    const double value = value_of(p, p->f);
    if (!is_allowed(p) || !(value < p->least))
        return;
    p->least = value;
    memcpy(p->best->x, p->x, p->problem->n_var * sizeof *p->x);
    memcpy(p->best->f, p->f, p->problem->n_obj * sizeof *p->f);
}

static int is_spent(const Polish *p)
{
    return p->status != STATUS_OK || p->best->n_evaluated >= p->goal->max_evals;
}

/* NLopt asks for objective and bounds apart: the same point is simulated once. */
static void evaluate(Polish *p, const double u[])
{
    const Problem *q = p->problem;
    unsigned char ok = 0;
    if (p->is_known && memcmp(u, p->u, q->n_var * sizeof *u) == 0)
        return;
    if (is_spent(p)) {
        nlopt_force_stop(p->opt);
        return;
    }
    memcpy(p->u, u, q->n_var * sizeof *u);
    problem_from_cube(q, u, p->x);
    problem_repair(q, p->x);
    p->status = queue_evaluate(p->queue, 1, p->x, NULL, p->f, p->g, &ok, p->err);
    p->is_known = 1;
    p->ok = p->status == STATUS_OK && ok && all_finite(q->n_obj, p->f);
    p->best->n_evaluated++;
    p->best->n_failed += !p->ok;
    keep_if_best(p);
}

static double objective(unsigned n, const double u[], double gradient[], void *user)
{
    (void)n;
    (void)gradient;
    Polish *p = user;
    evaluate(p, u);
    return p->ok ? fmin(value_of(p, p->f) - p->first, WALL) : WALL;
}

/* One by one: a plane fits no kink of the greatest of all. */
static void bounds(unsigned n_each, double each[], unsigned n, const double u[], double gradient[], void *user)
{
    (void)n_each;
    (void)n;
    (void)gradient;
    evaluate(user, u);
    excesses(user, each);
}

/* From the best design so far, until NLopt has converged or all is spent. */
static Status descend(Polish *p, double step)
{
    const unsigned n_var = (unsigned)p->problem->n_var, n_bounds = excesses(p, NULL);
    double unused;
    p->opt = nlopt_create(n_bounds > 0 || n_var < 2 ? NLOPT_LN_COBYLA : NLOPT_LN_BOBYQA, n_var);
    if (!p->opt)
        return fail(p->err, STATUS_NO_MEMORY, "no memory for polishing");
    problem_to_cube(p->problem, p->best->x, p->at);
    nlopt_set_lower_bounds1(p->opt, 0.0);
    nlopt_set_upper_bounds1(p->opt, 1.0);
    for (unsigned d = 0; d < n_var; d++) /* whole numbers and choices stay */
        if (problem_is_discrete(p->problem, d)) {
            nlopt_set_lower_bound(p->opt, d, p->at[d]);
            nlopt_set_upper_bound(p->opt, d, p->at[d]);
        }
    nlopt_set_initial_step1(p->opt, step);
    nlopt_set_xtol_rel(p->opt, 1e-6);
    nlopt_set_ftol_abs(p->opt, 0.1 * p->goal->gain_min); /* of one step, of which a descent has many */
    nlopt_set_maxeval(p->opt, (int)fmin((double)p->goal->max_evals, 1e9));
    nlopt_set_min_objective(p->opt, objective, p);
    if (n_bounds > 0)
        nlopt_add_inequality_mconstraint(p->opt, n_bounds, bounds, p, NULL);
    nlopt_optimize(p->opt, p->at, &unused); /* whatever it says: the best was kept on the way */
    nlopt_destroy(p->opt);
    return p->status;
}

Status polish_run(Queue *queue, const PolishGoal *goal, Polished *best, Err *err)
{
    Polish p = {.queue = queue, .problem = queue_problem(queue), .goal = goal, .best = best, .err = err};
    best->n_evaluated = best->n_failed = 0;
    p.first = p.least = value_of(&p, best->f);
    p.store = carve_all(layout, &p);
    Status status = p.store ? STATUS_OK : fail_memory(err, 1, "polishing");
    double step = STEP;
    int idle = 0;
    while (status == STATUS_OK && !is_spent(&p) && step > STEP_MIN && IDLE_MAX > idle) {
        const double before = p.least;
        status = descend(&p, step);
        idle = before - p.least > goal->gain_min ? 0 : idle + 1;
        step *= idle > 0 ? 0.5 : 1.0;
    }
    free(p.store);
    return status;
}
