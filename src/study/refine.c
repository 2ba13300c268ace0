#include "study/refine.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/clock.h"
#include "study/local.h"
#include "study/polish.h"
#include "evaluate/adapter.h"
#include "analysis/estimate.h"
#include "settings/options.h"

/* Designs of the run nearest to the one that is polished, and designs tried on the surrogate: a fit costs their cube. */
enum { CENTRES_MAX = 150, LOCAL_MAX = 600 };

/* Where the standard deviation of every objective is below this share of its value one simulation tells all. */
static const double PREDICTABLE = 1e-3;

typedef struct {
    const Run *run;
    const RefineConfig *config;
    const double *x; /* (n_var) of the design */
    Adapter *adapter;
    Queue *queue;                                                           /* to its simulator */
    double f[2 * OBJECTIVES_MAX], spread[2 * OBJECTIVES_MAX], violation[2]; /* of its first and last answer, natural */
    double extra[2 * N_MEASURES];                                           /* the further measures of both */
    double weight[OBJECTIVES_MAX], slack[OBJECTIVES_MAX], bound[OBJECTIVES_MAX]; /* of minimised objectives */
    char reason[REASON_MAX];                                                     /* why an evaluation failed */
    long replicates;                                                             /* of a design that is tried */
    double start;                                                                /* [s] of the clock */
} Refine;

/* -- the simulator ------------------------------------------------------------------------------------------------- */

static void close_simulator(Refine *r)
{
    queue_close(r->queue);
    adapter_close(r->adapter);
    r->queue = NULL;
    r->adapter = NULL;
}

static Status open_simulator(Refine *r, const SimOptions *sim, long replicates, Err *err)
{
    Settings s = *r->run->settings;
    s.sim = *sim;
    s.sim.replicates = replicates;
    close_simulator(r);
    TRY(adapter_open(&r->adapter, &s, err));
    adapter_observe(r->adapter, &(Observer){.go_on = r->config->go_on, .user = r->config->user});
    return queue_open(&r->queue, adapter_problem(r->adapter), QUEUE_AS_ASKED, 0, 0, err);
}

/* Both designs, or the first alone: natural results into r, minimised objectives into F (n, n_obj). */
static Status evaluate(Refine *r, size_t n, const double *const designs[], size_t repeat, double F[],
                       unsigned char ok[], Err *err)
{
    const size_t m = r->run->schema.n_obj, n_extra = r->run->schema.n_extra;
    Finished done;
    for (size_t i = 0; i < n; i++)
        TRY(queue_ask(r->queue, &(Asked){.x = designs[i], .repeat = repeat}, err));
    for (size_t i = 0; i < n; i++) {
        TRY(queue_next(r->queue, &done, err));
        ok[i] = done.evaluation->outcome == OUTCOME_OK;
        if (!ok[i])
            snprintf(r->reason, sizeof r->reason, "%s%s%s", outcome_word(done.evaluation->outcome),
                     done.evaluation->reason[0] ? ": " : "", done.evaluation->reason);
        r->violation[i] = done.evaluation->violation;
        memcpy(r->f + i * m, done.evaluation->f, m * sizeof *r->f);
        memcpy(r->spread + i * m, done.evaluation->sd, m * sizeof *r->spread);
        memcpy(F + i * m, done.f, m * sizeof *F);
        for (size_t k = 0; k < n_extra; k++)
            r->extra[i * n_extra + k] = done.evaluation->extra[k];
    }
    return STATUS_OK;
}

static void count(size_t n_evaluated, size_t n_failed, long replicates, Refined *out)
{
    out->n_evaluated += n_evaluated;
    out->n_failed += n_failed;
    out->n_simulated += n_evaluated * (size_t)replicates;
}

/* Weights in ranges of the front, and from the design's own objectives f what the kept ones may come to. */
static void set_goal(Refine *r, const double f[])
{
    const Schema *schema = &r->run->schema;
    const FrontBox box = run_box(r->run);
    for (size_t k = 0; k < schema->n_obj; k++) {
        const double spread = isfinite(r->spread[k]) ? r->spread[k] : 0.0;
        r->weight[k] = r->config->weight[k] / box.span[k];
        r->slack[k] = r->config->slack >= 0.0 ? r->config->slack * fabs(f[k]) : spread;
        r->bound[k] = r->config->keep[k] ? f[k] + r->slack[k] : INFINITY;
        if (spread > PREDICTABLE * fabs(f[k]))
            r->replicates = r->config->replicates;
    }
}

/* The design's own objectives f; what is wanted follows from them. */
static Status begin(Refine *r, double f[], Refined *out, Err *err)
{
    unsigned char ok = 0;
    TRY(open_simulator(r, &r->run->settings->sim, r->config->replicates, err));
    TRY(evaluate(r, 1, &r->x, 0, f, &ok, err));
    count(1, 0, r->config->replicates, out);
    if (!ok)
        return fail(
            err, STATUS_BAD_DATA,
            "the design to be polished fails when it is simulated again, %ld times (%s): choose another one, or "
            "give --replicates as many as the run made",
            r->config->replicates, r->reason);
    r->replicates = 1;
    set_goal(r, f);
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
    return (size_t)(each * (has_finer(s) ? 6 : 4));
}

/* Designs that may still be tried, so that both can be compared at the end. */
static size_t evals_left(const Refine *r, const Refined *out)
{
    const long finer = has_finer(r->run->settings) ? r->replicates : 0;
    const size_t spent = out->n_simulated + 2 * (size_t)(r->config->replicates + finer);
    return r->config->max_evals > spent ? (r->config->max_evals - spent) / (size_t)r->replicates : 0;
}

/* 0: there is no limit; else what is left of it, a little at least. */
static double seconds_left(const Refine *r)
{
    const double spent = clock_seconds() - r->start;
    return r->config->max_seconds > 0.0 ? fmax(r->config->max_seconds - spent, 1e-9) : 0.0;
}

/* -- surrogate and simulator in turn ------------------------------------------------------------------------------- */

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
    const Run *h = r->run;
    const Problem *p = adapter_problem(r->adapter);
    size_t n = 0;
    for (size_t i = 0; i < h->table.n; i++) {
        if (!h->place[i].ok || h->table.row[i].kind == KIND_REPEAT || h->table.row[i].kind == KIND_SCREENED)
            continue;
        near[n] = (Near){0.0, i};
        for (size_t d = 0; d < p->n_var; d++) {
            const double range = p->upper[d] - p->lower[d];
            const double step = range > 0.0 ? (h->table.x[i * p->n_var + d] - r->x[d]) / range : 0.0;
            near[n].distance += step * step;
        }
        n++;
    }
    qsort(near, n, sizeof *near, by_distance);
    return n < CENTRES_MAX ? n : CENTRES_MAX;
}

/* What the run knows near the design. */
static Status gather_known(const Refine *r, Known *known, Err *err)
{
    const Run *h = r->run;
    const Problem *p = adapter_problem(r->adapter);
    Near *near = calloc(h->table.n + 1, sizeof *near);
    double unused[OBJECTIVES_MAX];
    known->X = calloc(CENTRES_MAX * (p->n_var + p->n_obj + 1), sizeof *known->X);
    if (near && known->X) {
        known->F = known->X + CENTRES_MAX * p->n_var;
        known->noise = known->F + CENTRES_MAX * p->n_obj;
        known->n = nearest_rows(r, near);
    }
    for (size_t i = 0; i < known->n; i++) {
        const size_t row = near[i].row;
        memcpy(known->X + i * p->n_var, h->table.x + row * p->n_var, p->n_var * sizeof *known->X);
        problem_judge(p, &(Evaluation){.f = h->F + row * p->n_obj, .extra = h->table.row[row].extra},
                      known->F + i * p->n_obj, unused);
        known->noise[i] = 1.0 / (double)(h->table.row[row].replicates > 0 ? h->table.row[row].replicates : 1);
    }
    const int is_there = near && known->X;
    free(near);
    return is_there ? STATUS_OK : fail(err, STATUS_NO_MEMORY, "no memory for %zu designs", h->table.n);
}

/* From out->x with the objectives f; the best is left there. */
static Status improve_on_surrogate(Refine *r, double f[], Refined *out, Err *err)
{
    const size_t left = evals_left(r, out), wanted = r->config->algorithm ? left / 2 : left;
    LocalConfig config = {.goal = {r->weight, r->bound},
                          .noise = 1.0 / (double)r->replicates,
                          .max_evals = wanted < LOCAL_MAX ? wanted : LOCAL_MAX,
                          .max_seconds = seconds_left(r),
                          .seed = (uint32_t)r->run->settings->search.seed};
    LocalResult result = {.x = out->x, .f = f};
    Status status = gather_known(r, &config.known, err);
    if (status == STATUS_OK)
        status = local_run(r->queue, &config, &result, err);
    free(config.known.X);
    count(result.n_evaluated, result.n_failed, r->replicates, out);
    return status;
}

/* From out->x; the best is left there. */
static Status polish_simulator(Refine *r, Refined *out, Err *err)
{
    double f[OBJECTIVES_MAX];
    const PolishConfig config = {.algorithm = r->config->algorithm ? r->config->algorithm : "cobyla",
                                 .goal = {r->weight, r->bound},
                                 .max_evals = evals_left(r, out),
                                 .max_seconds = seconds_left(r),
                                 .seed = (uint32_t)r->run->settings->search.seed};
    PolishResult result = {.x = out->x, .f = f};
    if (config.max_evals < 2)
        return STATUS_OK;
    double *start = malloc(r->run->schema.n_var * sizeof *start);
    if (!start)
        return fail(err, STATUS_NO_MEMORY, "no memory for a design");
    memcpy(start, out->x, r->run->schema.n_var * sizeof *start);
    const Status status = polish_run(r->queue, &config, start, &result, err);
    free(start);
    count(result.n_evaluated, result.n_failed, r->replicates, out);
    return status;
}

/* Minimised objectives F (2, n_obj) of start and end, with their spreads in out. */
static void judge_gain(const Refine *r, const double F[], Refined *out)
{
    const size_t m = r->run->schema.n_obj;
    out->gain = out->gain_error = 0.0;
    out->keeps = 1;
    for (size_t k = 0; k < m; k++) {
        const double error = hypot(out->spread_start[k], out->spread[k]) / sqrt((double)r->config->replicates);
        const double loss = F[m + k] - F[k], margin = isfinite(error) ? 2.0 * error : 0.0;
        if (r->weight[k] > 0.0) {
            out->gain -= r->weight[k] * loss;
            out->gain_error += r->weight[k] * error;
        }
        if (r->config->keep[k] && loss > r->slack[k] + margin)
            out->keeps = 0;
    }
}

/* Both designs at twice the steps; F (2, n_obj) as in judge_gain. */
static Status compare_finer(Refine *r, const double F[], Refined *out, Err *err)
{
    const size_t m = r->run->schema.n_obj;
    double G[2 * OBJECTIVES_MAX];
    unsigned char ok[2] = {0};
    SimOptions finer;
    estimate_options(&r->run->settings->sim, &finer);
    TRY(open_simulator(r, &finer, r->replicates, err));
    TRY(evaluate(r, 2, (const double *const[]){r->x, out->x}, 1, G, ok, err));
    count(2, 0, r->replicates, out);
    out->gain_finer = ok[0] && ok[1] ? 0.0 : -INFINITY;
    for (size_t k = 0; k < m && ok[0] && ok[1]; k++) {
        out->gain_finer += r->weight[k] * (G[k] - G[m + k]);
        out->error[k] = ESTIMATE_FACTOR * fmax(fabs(G[k] - F[k]), fabs(G[m + k] - F[m + k]));
    }
    return STATUS_OK;
}

/* Both designs with replicates that no step has used: the selection of the best of noisy values would bias them. */
static Status compare(Refine *r, Refined *out, Err *err)
{
    const size_t n_var = r->run->schema.n_var, m = r->run->schema.n_obj, n_extra = r->run->schema.n_extra;
    double F[2 * OBJECTIVES_MAX];
    unsigned char ok[2] = {0};
    TRY(open_simulator(r, &r->run->settings->sim, r->config->replicates, err));
    TRY(evaluate(r, 2, (const double *const[]){r->x, out->x}, 1, F, ok, err));
    count(2, 0, r->config->replicates, out);
    memcpy(out->f_start, r->f, m * sizeof *r->f);
    memcpy(out->f, r->f + m, m * sizeof *r->f);
    memcpy(out->spread_start, r->spread, m * sizeof *r->spread);
    memcpy(out->spread, r->spread + m, m * sizeof *r->spread);
    for (size_t k = 0; k < n_extra; k++)
        out->extra[k] = r->extra[n_extra + k];
    out->violation = r->violation[1];
    out->has_changed = ok[0] && ok[1] && memcmp(r->x, out->x, n_var * sizeof *r->x) != 0;
    if (!out->has_changed)
        return STATUS_OK;
    judge_gain(r, F, out);
    return has_finer(r->run->settings) ? compare_finer(r, F, out, err) : STATUS_OK;
}

static Status refine(Refine *r, Refined *out, Err *err)
{
    const size_t n_var = r->run->schema.n_var, m = r->run->schema.n_obj;
    double f[OBJECTIVES_MAX];
    out->x = calloc(n_var, sizeof *out->x);
    out->f_start = calloc(5 * m + r->run->schema.n_extra, sizeof *out->f_start);
    if (!out->x || !out->f_start)
        return fail(err, STATUS_NO_MEMORY, "no memory for a design");
    out->f = out->f_start + m;
    out->spread_start = out->f_start + 2 * m;
    out->spread = out->f_start + 3 * m;
    out->error = out->f_start + 4 * m;
    out->extra = out->f_start + 5 * m;
    for (size_t k = 0; k < m; k++)
        out->error[k] = NAN;
    memcpy(out->x, r->x, n_var * sizeof *out->x);
    TRY(begin(r, f, out, err));
    TRY(improve_on_surrogate(r, f, out, err));
    TRY(polish_simulator(r, out, err));
    return compare(r, out, err);
}

Status refine_allows(const Settings *s, Err *err)
{
    if (s->problem.kind == PROBLEM_TOWER || !schema_is_noisy(s))
        return STATUS_OK;
    return fail(err, STATUS_BAD_DATA,
                "the answers of this run are noisy, and polishing simulates a design once: a gain could not be told "
                "from noise; continue the search instead (search.max_evals, search.replicate_share)");
}

Status refine_design(const Run *h, size_t row, const RefineConfig *config, Refined *out, Err *err)
{
    RefineConfig used = *config;
    *out = (Refined){.gain_min = config->gain_min, .gain_finer = NAN};
    TRY(refine_allows(h->settings, err));
    if (h->settings->problem.kind != PROBLEM_TOWER)
        used.replicates = 1;
    if (used.algorithm)
        TRY(polish_knows(used.algorithm, err));
    Refine r = {.run = h, .config = &used, .x = h->table.x + row * h->schema.n_var, .start = clock_seconds()};
    const Status status = refine(&r, out, err);
    out->seconds = clock_seconds() - r.start;
    close_simulator(&r);
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
    const double least = fmax(r->gain_min, isfinite(r->gain_error) ? 2.0 * r->gain_error : 0.0);
    return r->has_changed && r->keeps && r->gain > least && !(r->gain_finer <= least);
}

Evaluation refined_evaluation(const Refined *r)
{
    return (Evaluation){.x = r->x,
                        .f = r->f,
                        .sd = r->spread,
                        .extra = r->extra,
                        .violation = r->violation,
                        .seconds = r->seconds,
                        .outcome = OUTCOME_OK};
}
