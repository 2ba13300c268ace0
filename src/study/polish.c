#include "study/polish.h"

#include <nlopt.h>

#include "settings/options.h"

/* In the unit cube: a design that is polished lies on a front, so that the first step is short. */
static const double STEP = 0.05;

/* Where the standard deviation of every objective is below this share of its value one simulation tells all. */
static const double PREDICTABLE = 1e-3;

/* Of a design that fails, and the largest excess: finite, since NLopt fits models to them. */
static const double WALL = 1e3;

/* What NLopt's functions share. */
typedef struct {
    Improver *m;
    nlopt_opt opt;
    int is_known; /* the first design of m->X, m->u in the cube, has been simulated */
    Status status;
    Err *err;
} Descent;

/* -- the descent --------------------------------------------------------------------------------------------------- */

/* NLopt asks for objective and bounds apart: the same point is simulated once. Returns whether it succeeded. */
static int simulate(Descent *d, const double u[])
{
    Improver *m = d->m;
    const size_t size = m->problem->n_var * sizeof *u;
    if (d->is_known && memcmp(u, m->u, size) == 0)
        return m->ok[0];
    if (d->status == STATUS_OK && m->budget > 0) {
        memcpy(m->u, u, size);
        for (size_t j = 0; j < m->problem->n_var; j++)
            m->X[j] = problem_from_unit(m->problem, j, u[j]);
        problem_repair(m->problem, m->X);
        m->n = d->is_known = 1;
        d->status = improver_try(m, d->err);
    } else {
        nlopt_force_stop(d->opt);
    }
    return d->is_known && d->status == STATUS_OK && m->ok[0];
}

static double objective(unsigned, const double u[], double[], void *user)
{
    const Improver *m = ((Descent *)user)->m;
    return simulate(user, u) ? fmin(improver_sum(m, m->F) - improver_sum(m, m->first), WALL) : WALL;
}

/* Limits are passed singly: COBYLA's linear model cannot follow the kink of their maximum. */
static void bounds(unsigned n_each, double each[], unsigned, const double u[], double[], void *user)
{
    const Improver *m = ((Descent *)user)->m;
    const int ok = simulate(user, u);
    size_t i = 0;
    for (size_t k = 0; k < m->problem->n_obj; k++)
        if (isfinite(m->slack[k]))
            each[i++] = (m->F[k] - (m->first[k] + m->slack[k])) / m->scale[k];
    for (size_t c = 0; c < m->problem->n_con; c++)
        each[i++] = m->G[c];
    for (i = 0; i < n_each; i++)
        each[i] = ok ? fmin(fmax(each[i], -WALL), WALL) : WALL;
}

/* From the best design so far, until NLopt has converged or all is spent. */
static Status run_nlopt(Improver *m, double size, Err *err)
{
    const Problem *p = m->problem;
    const unsigned n_var = (unsigned)p->n_var;
    unsigned n_bounds = (unsigned)p->n_con;
    double unused;
    for (size_t k = 0; k < p->n_obj; k++)
        n_bounds += isfinite(m->slack[k]) != 0;
    Descent d = {
        .m = m, .err = err, .opt = nlopt_create(n_bounds > 0 || n_var < 2 ? NLOPT_LN_COBYLA : NLOPT_LN_BOBYQA, n_var)};
    if (!d.opt)
        return fail(err, STATUS_NO_MEMORY, "no memory for polishing");
    nlopt_set_lower_bounds1(d.opt, 0.0);
    nlopt_set_upper_bounds1(d.opt, 1.0);
    problem_to_cube(p, m->x, m->at);
    for (unsigned j = 0; j < n_var; j++)
        if (problem_is_discrete(p, j)) {
            nlopt_set_lower_bound(d.opt, j, m->at[j]);
            nlopt_set_upper_bound(d.opt, j, m->at[j]);
        }
    nlopt_set_initial_step1(d.opt, size * STEP);
    nlopt_set_xtol_rel(d.opt, 1e-6);
    nlopt_set_ftol_abs(d.opt, 0.1 * m->gain_min); /* of one step, of which a descent has many */
    nlopt_set_min_objective(d.opt, objective, &d);
    if (n_bounds > 0)
        nlopt_add_inequality_mconstraint(d.opt, n_bounds, bounds, &d, NULL);
    nlopt_optimize(d.opt, m->at, &unused); /* whatever it says: the best was kept on the way */
    nlopt_destroy(d.opt);
    return d.status;
}

Status polish_descend(Improver *m, Err *err)
{
    m->idle_max = 2;
    return improver_descend(m, run_nlopt, err);
}

/* -- before and after ---------------------------------------------------------------------------------------------- */

/* Of F (2, n_obj), start and end, minimised. */
static double gain_of(const Improver *m, const double F[])
{
    const size_t n_obj = m->problem->n_obj;
    return improver_sum(m, F) - improver_sum(m, F + n_obj);
}

/* Start and end with replicates that no step has used, for the selection of the best of noisy values would bias them;
 * then at finer steps, `sim` having the replicates of a design that is tried. */
static Status confirm(Improver *m, long replicates, SimOptions *sim, Err *err)
{
    const size_t n_obj = m->problem->n_obj;
    Improved *out = m->out;
    SimOptions all = *sim;
    all.replicates = replicates;
    TRY(improver_open(m, &all, err));
    TRY(improver_note(m, 2, (const double *[]){m->start, m->x}, 1, err));
    const Evaluation *before = &out->designs.row[POLISH_BEFORE], *end = &out->designs.row[POLISH_END];
    out->has_changed = before->outcome == OUTCOME_OK && end->outcome == OUTCOME_OK &&
                       memcmp(m->start, m->x, m->problem->n_var * sizeof *m->x) != 0;
    out->keeps = 1;
    for (size_t k = 0; k < n_obj; k++) {
        const double error = hypot(before->sd[k], end->sd[k]) / sqrt((double)replicates);
        const double was = m->F[k] = improver_path(m, POLISH_BEFORE, k);
        const double is = m->F[n_obj + k] = improver_path(m, POLISH_END, k);
        if (m->weight[k] > 0.0)
            out->gain_error += m->weight[k] * error / m->scale[k];
        if (is - was > m->slack[k] + (isfinite(error) ? 2.0 * error : 0.0))
            out->keeps = 0;
    }
    out->gain = gain_of(m, m->F);
    if (!improver_finer(m->run->settings, &all))
        return STATUS_OK;

    /* The same gain must be there at twice the steps, or at those by which the run knows the design. */
    if (m->run->table.row[m->row].level > 0)
        run_steps(m->run, m->row, sim);
    else
        estimate_options(sim, sim);
    TRY(improver_errors(m, POLISH_BEFORE, sim, 1, err));
    const int is_known = m->ok[0] && m->ok[1];
    out->gain_finer = is_known ? gain_of(m, m->F) : -INFINITY;
    for (size_t k = 0; k < n_obj; k++) /* of both designs the larger one */
        out->error[POLISH_BEFORE][k] = out->error[POLISH_END][k] =
            is_known ? fmax(out->error[POLISH_BEFORE][k], out->error[POLISH_END][k]) : NAN;
    return STATUS_OK;
}

Status polish_design(Improver *m, Err *err)
{
    const FrontBox box = run_box(m->run);
    const double *sd = m->out->designs.row[POLISH_START].sd;
    const long replicates = m->replicates;
    SimOptions sim = m->run->settings->sim, unused;
    sim.replicates = 1;
    for (size_t k = 0; k < m->problem->n_obj; k++) {
        m->weight[k] = m->config->weight[k];
        m->scale[k] = box.span[k];
        if (sd && sd[k] > PREDICTABLE * fabs(m->first[k]))
            sim.replicates = replicates;
    }
    if (sim.replicates != replicates)
        TRY(improver_open(m, &sim, err));
    const long finer = improver_finer(m->run->settings, &unused) ? sim.replicates : 0;
    const size_t kept = m->out->cost.n_simulated + 2 * (replicates + finer);
    m->budget = m->config->max_evals > kept ? (m->config->max_evals - kept) / sim.replicates : 0;
    m->value = improver_sum(m, m->first);
    m->gain_min = POLISH_GAIN_MIN;
    TRY(polish_descend(m, err));
    return confirm(m, replicates, &sim, err);
}

Status polish_allows(const Settings *s, Err *err)
{
    if (s->problem.kind == PROBLEM_TOWER || !schema_is_noisy(s))
        return STATUS_OK;
    return bad_data(
        err, "the answers of this run are noisy, and polishing simulates a design once: a gain could not be told "
             "from noise; continue the search instead (search.max_evals, search.replicate_share)");
}

size_t polish_evals_min(const Settings *s, long replicates)
{
    SimOptions unused;
    return (s->problem.kind == PROBLEM_TOWER ? replicates : 1) * (improver_finer(s, &unused) ? 6 : 4);
}

int polish_counts(const Improved *r)
{
    const double least = fmax(POLISH_GAIN_MIN, isfinite(r->gain_error) ? 2.0 * r->gain_error : 0.0);
    return r->has_changed && r->keeps && r->gain > least && !(r->gain_finer <= least);
}
