#include "study/local.h"

#include <math.h>
#include <nlopt.h>
#include <stdlib.h>
#include <string.h>

#include "base/carve.h"
#include "base/clock.h"
#include "base/random.h"
#include "base/stat.h"
#include "study/constants.h"
#include "rbf/rbf.h"

typedef struct {
    Queue *queue;
    const Problem *problem;
    const LocalConfig *config;
    LocalResult *result;
    Rbf *rbf;
    size_t n, n_max, n_tuned;          /* known designs; how many there were when the surrogate was tuned */
    double *U, *F, *N;                 /* (n_max, n_var) in the unit cube, (n_max, n_obj), noise (n_max, n_obj) */
    double *X, *F_new, *G_new;         /* one batch */
    double *u_best, *u, *low, *high;   /* (n_var) the centre; the proposal under way and its box */
    double *f, *J;                     /* (n_obj), (n_obj, n_var) of the surrogate, evaluated last */
    double *error, *error_min, *shift; /* (n_obj) shift: added to the surrogate, which is then exact at the centre */
    double value, trust;               /* of the centre; of the first box */
    Random random;
    void *store;
} Local;

/* -- merit of a design on the surrogate ---------------------------------------------------------------------------- */

/* log P(z' < z) of a standard normal z', and its derivative; its asymptote far below. */
static double log_chance(double z, double *slope)
{
    const double density = exp(-0.5 * z * z) / sqrt(2.0 * M_PI), chance = 0.5 * erfc(-z * M_SQRT1_2);
    *slope = z > -20.0 ? density / chance : -z - 1.0 / z;
    return z > -20.0 ? log(chance) : -0.5 * z * z - log(-z * sqrt(2.0 * M_PI));
}

/* log E max(0, z + z'), and its derivative. */
static double log_gain(double z, double *slope)
{
    const double density = exp(-0.5 * z * z) / sqrt(2.0 * M_PI), chance = 0.5 * erfc(-z * M_SQRT1_2);
    const double gain = density + z * chance;
    *slope = z > -10.0 ? chance / gain : -z - 2.0 / z;
    return z > -10.0 ? log(gain) : -0.5 * z * z - log(z * z * sqrt(2.0 * M_PI));
}

static void add_slope(double factor, const double J[], unsigned n, double gradient[])
{
    for (unsigned d = 0; gradient && d < n; d++)
        gradient[d] += factor * J[d];
}

/* Logarithm of what is looked for, at u. */
static double merit(unsigned n, const double u[], double gradient[], void *user)
{
    Local *l = user;
    const size_t m = l->problem->n_obj;
    const Goal *goal = &l->config->goal;
    double sum, slope, error = 0.0;
    rbf_slope(l->rbf, 1, u, l->f, l->J);
    for (size_t k = 0; k < m; k++) {
        l->f[k] += l->shift[k];
        error = hypot(error, goal->weight[k] * l->error[k]);
    }
    if (gradient)
        memset(gradient, 0, n * sizeof *gradient);
    sum = log_gain((l->value - goal_value(goal, m, l->f)) / error, &slope);
    for (size_t k = 0; k < m; k++)
        add_slope(-slope / error * goal->weight[k], l->J + k * n, n, gradient);
    for (size_t k = 0; k < m; k++) {
        if (!isfinite(goal->bound[k]))
            continue;
        sum += log_chance((goal->bound[k] - l->f[k]) / l->error[k], &slope);
        add_slope(-slope / l->error[k], l->J + k * n, n, gradient);
    }
    return isfinite(sum) ? sum : -1e30;
}

/* -- a round ------------------------------------------------------------------------------------------------------- */

static void add(Local *l, const double x[], const double f[], double noise)
{
    const size_t m = l->problem->n_obj;
    problem_to_cube(l->problem, x, l->U + l->n * l->problem->n_var);
    memcpy(l->F + l->n * m, f, m * sizeof *f);
    for (size_t k = 0; k < m; k++)
        l->N[l->n * m + k] = noise;
    l->n++;
}

static Status fit(Local *l, Err *err)
{
    const int tuning = l->n_tuned == 0 || l->n > l->n_tuned + l->n_tuned / LOCAL_RETUNE_SHARE;
    TRY((tuning ? rbf_tune : rbf_fit)(l->rbf, l->n, l->U, l->F, l->N, err));
    l->n_tuned = tuning ? l->n : l->n_tuned;
    problem_to_cube(l->problem, l->result->x, l->u_best);
    rbf_eval(l->rbf, 1, l->u_best, l->f, l->error);
    for (size_t k = 0; k < l->problem->n_obj; k++) {
        l->shift[k] = l->result->f[k] - l->f[k];
        l->error[k] = fmax(l->error[k], l->error_min[k]);
    }
    return STATUS_OK;
}

/* Some of the variables, `reach` each way about the centre; all of them where chance took none. */
static void draw_box(Local *l, double reach)
{
    const size_t n = l->problem->n_var;
    size_t moved = 0;
    for (size_t d = 0; d < n; d++) {
        l->u[d] = random_uniform(&l->random) < FREE_SHARE ? reach : 0.0;
        moved += l->u[d] > 0.0;
    }
    for (size_t d = 0; d < n; d++) {
        const double by = moved > 0 ? l->u[d] : reach;
        l->low[d] = fmax(0.0, l->u_best[d] - by);
        l->high[d] = fmin(1.0, l->u_best[d] + by);
    }
}

/* The design with the most merit in a box; where that is the centre itself any other one. */
static Status propose(Local *l, double reach, double x[], Err *err)
{
    const size_t n = l->problem->n_var;
    nlopt_opt opt = nlopt_create(NLOPT_LD_CCSAQ, (unsigned)n);
    double unused;
    if (!opt)
        return fail(err, STATUS_NO_MEMORY, "no memory for polishing");
    draw_box(l, reach);
    memcpy(l->u, l->u_best, n * sizeof *l->u);
    nlopt_set_lower_bounds(opt, l->low);
    nlopt_set_upper_bounds(opt, l->high);
    nlopt_set_max_objective(opt, merit, l);
    nlopt_set_maxeval(opt, LOCAL_STEPS);
    nlopt_set_xtol_rel(opt, 1e-6);
    nlopt_optimize(opt, l->u, &unused);
    nlopt_destroy(opt);
    for (size_t d = 0; d < n; d++)
        l->u[d] = isfinite(l->u[d]) ? l->u[d] : l->u_best[d];
    if (memcmp(l->u, l->u_best, n * sizeof *l->u) == 0)
        for (size_t d = 0; d < n; d++)
            l->u[d] = l->low[d] + random_uniform(&l->random) * (l->high[d] - l->low[d]);
    problem_from_cube(l->problem, l->u, x);
    problem_repair(l->problem, x);
    return STATUS_OK;
}

/* What came back of a batch; returns the box that the new centre is from, LOCAL_BATCH where nothing is better. */
static size_t take(Local *l, size_t n, const unsigned char ok[])
{
    const Problem *p = l->problem;
    size_t best = LOCAL_BATCH;
    l->result->n_evaluated += n;
    for (size_t i = 0; i < n; i++) {
        const double *f = l->F_new + i * p->n_obj, *x = l->X + i * p->n_var;
        const double value = goal_value(&l->config->goal, p->n_obj, f);
        if (!ok[i] || !all_finite(p->n_obj, f)) {
            l->result->n_failed++;
            continue;
        }
        add(l, x, f, l->config->noise);
        if (!(value < l->value) || !goal_holds(&l->config->goal, p, f, l->G_new + i * p->n_con))
            continue;
        l->value = value;
        memcpy(l->result->x, x, p->n_var * sizeof *x);
        memcpy(l->result->f, f, p->n_obj * sizeof *f);
        best = i;
    }
    return best;
}

static Status do_round(Local *l, Err *err)
{
    const Problem *p = l->problem;
    const size_t left = l->config->max_evals - l->result->n_evaluated, n = left < LOCAL_BATCH ? left : LOCAL_BATCH;
    unsigned char ok[LOCAL_BATCH] = {0};
    TRY(fit(l, err));
    for (size_t i = 0; i < n; i++)
        TRY(propose(l, ldexp(l->trust, -(int)i), l->X + i * p->n_var, err));
    TRY(queue_evaluate(l->queue, n, l->X, NULL, l->F_new, l->G_new, ok, err));
    const size_t found = take(l, n, ok);
    l->trust = found < LOCAL_BATCH ? fmin(ldexp(l->trust, 1 - (int)found), TRUST_MAX) : TRUST_SHRINK * l->trust;
    return STATUS_OK;
}

/* -- in and out ---------------------------------------------------------------------------------------------------- */

static void layout(void *local, Carve *c)
{
    Local *l = local;
    const size_t n = l->problem->n_var, m = l->problem->n_obj, real = sizeof(double);
    l->U = carve(c, l->n_max * n, real);
    l->F = carve(c, l->n_max * m, real);
    l->N = carve(c, l->n_max * m, real);
    l->X = carve(c, LOCAL_BATCH * n, real);
    l->F_new = carve(c, LOCAL_BATCH * m, real);
    l->G_new = carve(c, LOCAL_BATCH * l->problem->n_con, real);
    l->u_best = carve(c, n, real);
    l->u = carve(c, n, real);
    l->low = carve(c, n, real);
    l->high = carve(c, n, real);
    l->f = carve(c, m, real);
    l->error = carve(c, m, real);
    l->error_min = carve(c, m, real);
    l->shift = carve(c, m, real);
    l->J = carve(c, m * n, real);
}

static Status create(Local *l, Err *err)
{
    l->store = carve_all(layout, l);
    return l->store ? rbf_create(&l->rbf, l->n_max, l->problem->n_var, l->problem->n_obj, err)
                    : fail(err, STATUS_NO_MEMORY, "no memory for a surrogate on %zu designs", l->n_max);
}

static void take_known(Local *l)
{
    const size_t n = l->problem->n_var, m = l->problem->n_obj;
    const Known *known = &l->config->known;
    for (size_t i = 0; i < known->n; i++)
        add(l, known->X + i * n, known->F + i * m, known->noise[i]);
    for (size_t k = 0; k < m; k++)
        l->error_min[k] = ERROR_MIN * (l->result->f[k] != 0.0 ? fabs(l->result->f[k]) : 1.0);
    l->value = goal_value(&l->config->goal, m, l->result->f);
}

Status local_run(Queue *queue, const LocalConfig *config, LocalResult *result, Err *err)
{
    const double start = clock_seconds();
    const Problem *problem = queue_problem(queue);
    Local l = {.queue = queue,
               .problem = problem,
               .config = config,
               .result = result,
               .n_max = config->known.n + config->max_evals,
               .trust = TRUST_FIRST,
               .random = random_stream(config->seed, RANDOM_POLISHING, 0, 0)};
    result->n_evaluated = result->n_failed = 0;
    if (problem->n_var > RBF_DIM_MAX || config->known.n <= problem->n_var)
        return STATUS_OK;
    Status status = create(&l, err);
    if (status == STATUS_OK)
        take_known(&l);
    while (status == STATUS_OK && result->n_evaluated < config->max_evals && l.trust > TRUST_MIN &&
           !(config->max_seconds > 0.0 && clock_seconds() - start > config->max_seconds))
        status = do_round(&l, err);
    rbf_free(l.rbf);
    free(l.store);
    return status;
}
