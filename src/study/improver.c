#include "study/improver.h"

#include "analysis/estimate.h"
#include "base/carve.h"
#include "base/clock.h"
#include "base/stat.h"
#include "settings/options.h"

/* A descent ends below this share of its first step. */
static const double SIZE_MIN = 2e-3;

/* -- the simulator ------------------------------------------------------------------------------------------------- */

static void close_simulator(Improver *m)
{
    queue_close(m->queue);
    adapter_close(m->adapter);
    m->queue = NULL;
    m->adapter = NULL;
}

Status improver_open(Improver *m, const SimOptions *sim, Err *err)
{
    Settings settings = *m->run->settings;
    close_simulator(m);
    settings.sim = *sim;
    m->replicates = sim->replicates;
    TRY(adapter_open(&m->adapter, &settings, err));
    adapter_observe(m->adapter, &(Observer){.go_on = m->config->go_on, .user = m->config->user});
    m->problem = adapter_problem(m->adapter);
    return queue_open(&m->queue, m->problem, err);
}

static void layout(void *improver, Carve *c)
{
    Improver *m = improver;
    const Problem *p = m->problem;
    const size_t n = MAX_OF(2 * p->n_var, (size_t)PATH_MAX_DESIGNS);
    CARVE(c, m->x, p->n_var);
    CARVE(c, m->u, p->n_var);
    CARVE(c, m->at, p->n_var);
    CARVE(c, m->X, n * p->n_var);
    CARVE(c, m->F, n * p->n_obj);
    CARVE(c, m->G, n * p->n_con);
    CARVE(c, m->ok, n);
}

Status improver_reserve(Improver *m, Err *err)
{
    m->store = carve_all(layout, m);
    return m->store ? STATUS_OK : fail_memory(err, 2 * m->problem->n_var, "designs");
}

static void count(const Improver *m, size_t n, size_t n_failed)
{
    m->out->cost.n_evaluated += n;
    m->out->cost.n_failed += n_failed;
    m->out->cost.n_simulated += n * m->replicates;
}

/* -- the path ------------------------------------------------------------------------------------------------------ */

Status improver_note(Improver *m, size_t n, const double *const x[], size_t repeat, Err *err)
{
    Finished done;
    for (size_t i = 0; i < n; i++)
        TRY(queue_ask(m->queue, &(Asked){.x = x[i], .repeat = repeat}, err));
    for (size_t i = 0; i < n; i++) {
        TRY(queue_next(m->queue, &done, err));
        count(m, 1, done.evaluation->outcome != OUTCOME_OK);
        TRY(evaluation_table_append(&m->out->designs, done.evaluation, err));
    }
    return STATUS_OK;
}

Status improver_check(const Improver *m, Err *err)
{
    const EvaluationTable *path = &m->out->designs;
    const Evaluation *last = &path->row[path->n - 1];
    if (last->outcome == OUTCOME_OK)
        return STATUS_OK;
    return bad_data(err,
                    "the design fails when it is simulated again, %ld times (%s%s%s): choose another one, or as many "
                    "replicates as the run made",
                    m->replicates, outcome_word(last->outcome), *last->reason ? ": " : "", last->reason);
}

double improver_path(const Improver *m, size_t i, size_t k)
{
    return schema_objective(&m->run->schema, k)->sense * m->out->designs.row[i].f[k];
}

int improver_finer(const Settings *s, SimOptions *finer)
{
    return s->problem.kind == PROBLEM_TOWER && estimate_options(&s->sim, finer);
}

Status improver_errors(Improver *m, size_t from, const SimOptions *finer, size_t repeat, Err *err)
{
    const EvaluationTable *path = &m->out->designs;
    const size_t n = path->n - from, n_obj = m->problem->n_obj;
    TRY(improver_open(m, finer, err));
    TRY(queue_evaluate(m->queue, n, path->row[from].x, repeat, m->F, m->G, m->ok, err));
    for (size_t i = 0; i < n; i++) {
        count(m, 1, !m->ok[i]);
        for (size_t k = 0; k < n_obj && m->ok[i]; k++)
            m->out->error[from + i][k] = fabs(m->F[i * n_obj + k] - improver_path(m, from + i, k));
    }
    return STATUS_OK;
}

/* -- the descent --------------------------------------------------------------------------------------------------- */

double improver_loss(const Improver *m, const double f[], double violation)
{
    double loss = violation > m->violation ? 1.0 + violation - m->violation : -INFINITY;
    for (size_t k = 0; k < m->problem->n_obj; k++)
        if (isfinite(m->slack[k]))
            loss = fmax(loss, (f[k] - m->first[k]) / fmax(m->slack[k], 1e-300));
    return loss;
}

double improver_sum(const Improver *m, const double f[])
{
    double sum = 0.0;
    for (size_t k = 0; k < m->problem->n_obj; k++)
        if (m->weight[k] > 0.0)
            sum += m->weight[k] * f[k] / m->scale[k];
    return sum;
}

Status improver_try(Improver *m, Err *err)
{
    const Problem *p = m->problem;
    int is_weighted = 0;
    for (size_t k = 0; k < p->n_obj; k++)
        is_weighted |= m->weight[k] > 0.0;
    TRY(queue_evaluate(m->queue, m->n, m->X, 0, m->F, m->G, m->ok, err));
    m->budget -= MIN_OF(m->n, m->budget);
    for (size_t i = 0; i < m->n; i++) {
        const double *f = m->F + i * p->n_obj;
        m->ok[i] = m->ok[i] && all_finite(p->n_obj, f);
        count(m, 1, !m->ok[i]);
        const double loss = improver_loss(m, f, violation_of(p->n_con, m->G + i * p->n_con));
        const double value = !is_weighted ? loss : loss <= 1.0 ? improver_sum(m, f) : INFINITY;
        if (m->ok[i] && value < m->value) {
            m->value = value;
            memcpy(m->x, m->X + i * p->n_var, p->n_var * sizeof *m->x);
        }
    }
    return STATUS_OK;
}

Status improver_descend(Improver *m, ImproveStep step, Err *err)
{
    int idle = 0;
    for (double size = 1.0; m->budget > 0 && m->value > m->enough && idle < m->idle_max && size > SIZE_MIN;) {
        const double before = m->value;
        TRY(step(m, size, err));
        idle = before - m->value > m->gain_min ? 0 : idle + 1;
        size *= idle > 0 ? 0.5 : 1.0;
    }
    return STATUS_OK;
}

/* -- all of it ----------------------------------------------------------------------------------------------------- */

/* Simulates the start, from which everything is counted, and hands over to the method. */
static Status work(Improver *m, ImproveMethod method, Err *err)
{
    SimOptions sim = m->run->settings->sim;
    if (m->run->settings->problem.kind != PROBLEM_TOWER)
        sim.replicates = 1;
    else if (m->config->replicates > 0)
        sim.replicates = m->config->replicates;
    TRY(improver_open(m, &sim, err));
    TRY(improver_reserve(m, err));
    memcpy(m->x, m->start, m->problem->n_var * sizeof *m->x);
    TRY(improver_note(m, 1, &m->start, 0, err));
    TRY(improver_check(m, err));
    const double *sd = m->out->designs.row[0].sd;
    for (size_t k = 0; k < m->problem->n_obj; k++) {
        const double share = m->config->slack[k];
        m->first[k] = improver_path(m, 0, k);
        m->slack[k] = share < 0.0       ? (sd && isfinite(sd[k]) ? sd[k] : 0.0)
                      : isfinite(share) ? share * fabs(m->first[k])
                                        : INFINITY;
    }
    return method(m, err);
}

Status improve_design(const Run *run, size_t row, const ImproveConfig *config, ImproveMethod method, Improved *out,
                      Err *err)
{
    const Schema *s = &run->schema;
    const double begun = clock_seconds();
    Improver m = {.run = run, .row = row, .start = run_x(run, row), .config = config, .out = out, .enough = -INFINITY};
    *out = (Improved){.designs = evaluation_table(s->n_var, s->n_obj, s->n_extra), .gain_finer = NAN};
    for (size_t i = 0; i < PATH_MAX_DESIGNS; i++)
        for (size_t k = 0; k < OBJECTIVES_MAX; k++)
            out->error[i][k] = NAN;
    const Status status = work(&m, method, err);
    close_simulator(&m);
    free(m.store);
    out->cost.seconds = clock_seconds() - begun;
    if (status == STATUS_OK)
        out->designs.row[out->designs.n - 1].seconds = out->cost.seconds;
    return status;
}

void improved_free(Improved *r)
{
    evaluation_table_free(&r->designs);
    *r = (Improved){0};
}
