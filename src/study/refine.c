#include "study/refine.h"

#include "base/clock.h"
#include "settings/options.h"
#include "study/polish.h"
#include "study/run_simulator.h"

/* Where the standard deviation of every objective is below this share of its value one simulation tells all. */
static const double PREDICTABLE = 1e-3;

typedef struct {
    const Run *run;
    size_t row; /* of the run: the design itself */
    const RefineConfig *config;
    Refined *out;
    RunSimulator simulator;
    double *x;                                                                   /* (n_var) of the best design so far */
    double weight[OBJECTIVES_MAX], slack[OBJECTIVES_MAX], bound[OBJECTIVES_MAX]; /* of minimised objectives */
    FrontBox box;
    long replicates; /* of a design that is tried */
} Refine;

/* -- the simulator ------------------------------------------------------------------------------------------------- */

static Status open_simulator(Refine *r, const SimOptions *sim, long replicates, Err *err)
{
    SimOptions options = *sim;
    options.replicates = replicates;
    return run_simulator_open(&r->simulator, r->run->settings, &options, r->config->go_on, r->config->user, err);
}

static void count(Refine *r, size_t n_evaluated, size_t n_failed, long replicates)
{
    r->out->n_evaluated += n_evaluated;
    r->out->n_failed += n_failed;
    r->out->n_simulated += n_evaluated * replicates;
}

/* A design by all replicates: its record into the table, its minimised objectives into f. */
static Status simulate(Refine *r, const double x[], size_t repeat, EvaluationTable *table, double f[], Err *err)
{
    Finished done;
    TRY(queue_ask(r->simulator.queue, &(Asked){.x = x, .repeat = repeat}, err));
    TRY(queue_next(r->simulator.queue, &done, err));
    memcpy(f, done.f, r->run->schema.n_obj * sizeof *f);
    count(r, 1, 0, r->config->replicates);
    return evaluation_table_append(table, done.evaluation, err);
}

/* -- before and after ---------------------------------------------------------------------------------------------- */

/* From the design itself, f its minimised objectives, what the kept ones may come to. */
static void set_goal(Refine *r, const Evaluation *start, const double f[])
{
    r->box = run_box(r->run);
    r->replicates = 1;
    for (size_t k = 0; k < r->run->schema.n_obj; k++) {
        const double sd = start->sd && isfinite(start->sd[k]) ? start->sd[k] : 0.0;
        r->slack[k] = r->config->slack[k] < 0.0       ? sd
                      : isfinite(r->config->slack[k]) ? r->config->slack[k] * fabs(f[k])
                                                      : INFINITY;
        r->bound[k] = f[k] + r->slack[k];
        if (sd > PREDICTABLE * fabs(f[k]))
            r->replicates = r->config->replicates;
    }
}

/* The design's own minimised objectives f; what is wanted follows from them. */
static Status begin(Refine *r, double f[], Err *err)
{
    const Schema *schema = &r->run->schema;
    EvaluationTable table = evaluation_table(schema->n_var, schema->n_obj, schema->n_extra);
    TRY(open_simulator(r, &r->run->settings->sim, r->config->replicates, err));
    Status status = simulate(r, r->x, 0, &table, f, err);
    const Evaluation *start = table.row;
    if (status == STATUS_OK && start->outcome != OUTCOME_OK)
        status =
            bad_data(err,
                     "the design to be polished fails when it is simulated again, %ld times (%s%s%s): choose another "
                     "one, or give --replicates as many as the run made",
                     r->config->replicates, outcome_word(start->outcome), start->reason[0] ? ": " : "", start->reason);
    if (status == STATUS_OK)
        set_goal(r, start, f);
    evaluation_table_free(&table);
    TRY(status);
    return r->replicates == r->config->replicates ? STATUS_OK
                                                  : open_simulator(r, &r->run->settings->sim, r->replicates, err);
}

static int has_finer(const Settings *s)
{
    SimOptions unused;
    return s->problem.kind == PROBLEM_TOWER && estimate_options(&s->sim, &unused);
}

size_t refine_evals_min(const Settings *s, long replicates)
{
    const long each = s->problem.kind == PROBLEM_TOWER ? replicates : 1;
    return each * (has_finer(s) ? 6 : 4);
}

/* From the design itself, whose minimised objectives are f; the best is left in r->x. */
static Status improve(Refine *r, double f[], Err *err)
{
    const long finer = has_finer(r->run->settings) ? r->replicates : 0;
    const size_t kept = r->out->n_simulated + 2 * (r->config->replicates + finer);
    Polished best = {.x = r->x, .f = f};
    if (r->config->max_evals <= kept)
        return STATUS_OK;
    const size_t n = (r->config->max_evals - kept) / r->replicates;
    const Status status = polish_run(
        r->simulator.queue, &(PolishGoal){r->config->weight, r->box.span, r->bound, n, REFINE_GAIN_MIN}, &best, err);
    count(r, best.n_evaluated, best.n_failed, r->replicates);
    return status;
}

/* Minimised objectives F (2, n_obj) of start and end. */
static double gain_of(const Refine *r, const double F[])
{
    const size_t m = r->run->schema.n_obj;
    double gain = 0.0;
    for (size_t k = 0; k < m; k++)
        gain += r->config->weight[k] * (F[k] - F[m + k]) / r->box.span[k];
    return gain;
}

static void judge_gain(const Refine *r, const double F[])
{
    const size_t m = r->run->schema.n_obj;
    const double *sd = r->out->designs.sd;
    r->out->gain = gain_of(r, F);
    r->out->keeps = 1;
    for (size_t k = 0; k < m; k++) {
        const double error = hypot(sd[k], sd[m + k]) / sqrt((double)r->config->replicates);
        if (r->config->weight[k] > 0.0)
            r->out->gain_error += r->config->weight[k] * error / r->box.span[k];
        if (F[m + k] - F[k] > r->slack[k] + (isfinite(error) ? 2.0 * error : 0.0))
            r->out->keeps = 0;
    }
}

/* Both designs at twice the steps, or at those by which the run knows the first; F (2, n_obj) as above. */
static Status compare_finer(Refine *r, const double F[], Err *err)
{
    const size_t m = r->run->schema.n_obj;
    double G[2 * OBJECTIVES_MAX], unused[2 * OBJECTIVES_MAX];
    unsigned char ok[2] = {0};
    SimOptions finer = r->run->settings->sim;
    if (r->run->table.row[r->row].level > 0)
        run_steps(r->run, r->row, &finer);
    else
        estimate_options(&finer, &finer);
    TRY(open_simulator(r, &finer, r->replicates, err));
    TRY(queue_evaluate(r->simulator.queue, 2, r->out->designs.x, (const size_t[]){1, 1}, G, unused, ok, err));
    count(r, 2, 0, r->replicates);
    const int is_known = ok[0] && ok[1];
    r->out->gain_finer = is_known ? gain_of(r, G) : -INFINITY;
    for (size_t k = 0; k < m && is_known; k++)
        r->out->error[k] = fmax(fabs(G[k] - F[k]), fabs(G[m + k] - F[m + k]));
    return STATUS_OK;
}

/* Both designs with replicates that no step has used: the selection of the best of noisy values would bias them. */
static Status compare(Refine *r, const double start[], Err *err)
{
    const size_t n_var = r->run->schema.n_var, m = r->run->schema.n_obj;
    EvaluationTable *both = &r->out->designs;
    double F[2 * OBJECTIVES_MAX];
    TRY(open_simulator(r, &r->run->settings->sim, r->config->replicates, err));
    TRY(simulate(r, start, 1, both, F, err));
    TRY(simulate(r, r->x, 1, both, F + m, err));
    r->out->has_changed = both->row[0].outcome == OUTCOME_OK && both->row[1].outcome == OUTCOME_OK &&
                          memcmp(start, r->x, n_var * sizeof *start) != 0;
    judge_gain(r, F);
    return has_finer(r->run->settings) ? compare_finer(r, F, err) : STATUS_OK;
}

static Status refine(Refine *r, const double start[], Err *err)
{
    double f[OBJECTIVES_MAX];
    TRY_ROOM(r->x, r->run->schema.n_var, "variables", err);
    memcpy(r->x, start, r->run->schema.n_var * sizeof *r->x);
    TRY(begin(r, f, err));
    TRY(improve(r, f, err));
    return compare(r, start, err);
}

Status refine_allows(const Settings *s, Err *err)
{
    if (s->problem.kind == PROBLEM_TOWER || !schema_is_noisy(s))
        return STATUS_OK;
    return bad_data(
        err, "the answers of this run are noisy, and polishing simulates a design once: a gain could not be told "
             "from noise; continue the search instead (search.max_evals, search.replicate_share)");
}

Status refine_design(const Run *h, size_t row, const RefineConfig *config, Refined *out, Err *err)
{
    const double start = clock_seconds();
    RefineConfig used = *config;
    *out =
        (Refined){.designs = evaluation_table(h->schema.n_var, h->schema.n_obj, h->schema.n_extra), .gain_finer = NAN};
    for (size_t k = 0; k < OBJECTIVES_MAX; k++)
        out->error[k] = NAN;
    TRY(refine_allows(h->settings, err));
    if (h->settings->problem.kind != PROBLEM_TOWER)
        used.replicates = 1;
    Refine r = {.run = h, .row = row, .config = &used, .out = out};
    const Status status = refine(&r, run_x(h, row), err);
    out->seconds = clock_seconds() - start;
    if (status == STATUS_OK)
        out->designs.row[1].seconds = out->seconds;
    run_simulator_close(&r.simulator);
    free(r.x);
    return status;
}

void refined_free(Refined *r)
{
    evaluation_table_free(&r->designs);
    *r = (Refined){0};
}

int refined_counts(const Refined *r)
{
    const double least = fmax(REFINE_GAIN_MIN, isfinite(r->gain_error) ? 2.0 * r->gain_error : 0.0);
    return r->has_changed && r->keeps && r->gain > least && !(r->gain_finer <= least);
}
