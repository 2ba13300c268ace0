#include "study/named.h"

#include "analysis/estimate.h"
#include "base/stat.h"
#include "evaluate/cluster.h"
#include "study/run_simulator.h"

/* Times that the steps are doubled; copies of a design, first and where those disagree; designs looked at together,
 * before the front is formed again; how often, so that names which move again and again come to an end. */
enum { LEVELS = 4, COPIES_FIRST = 2, COPIES = 6, TOGETHER = 4, ROUNDS = 32 };

/* What sim.accuracy = standard promises of a measure, relative (docs/promise.md); shares below SHARE_MIN as of that. */
static const double PROMISE[N_MEASURES] = {[MEASURE_J1] = 1e-3,  [MEASURE_J2] = 3e-3,     [MEASURE_J3] = 1e-2,
                                           [MEASURE_ED1] = 1e-2, [MEASURE_ED5_10] = 1e-2, [MEASURE_EDCS] = 1e-2};
static const double SHARE_MIN = 0.1; /* [%] */

/* Shares of the promise: runs that differ by less end the doubling of the steps; no likely error is below, for two runs
 * agree by chance too. */
static const double AGREED = 1.0 / 3.0, LEAST = 1.0 / 15.0;

/* Three times so many deviations of a design and its first copies, or of a design and its others: one run in a hundred
 * differs more from another, by Student's distribution, sqrt(2) t / 3. docs/measured/named.csv has what this covers. */
static const double STUDENT_FIRST = 4.68, STUDENT = 1.75;

/* Values in the order of the schema: objectives, then the others. */
typedef struct {
    size_t row; /* of the run */
    double as_set[N_MEASURES], value[N_MEASURES], error[N_MEASURES], sd[N_MEASURES];
    double violation, seconds;
    double student; /* sd times that is an error */
    size_t level;   /* at which it was simulated last */
    int is_known;
} Named;

typedef struct {
    RunStore *store;
    const Settings *used;
    int (*go_on)(void *user);
    void *user;
    int is_first; /* round: something comes of every session, however short */
    Run run;
    SimOptions sim[LEVELS + 1];         /* of each level; 0: as the run is set */
    RunSimulator simulator[LEVELS + 1]; /* open where its level was wanted, so that records are not read again */
    size_t n;
    Named named[TOGETHER], *asked[TOGETHER]; /* asked: whose designs are in X */
    double *X;                               /* (COPIES n, n_var) */
    EvaluationTable answers;
} Work;

int named_are_known(const Settings *s)
{
    SimOptions unused;
    return s->problem.kind == PROBLEM_TOWER && s->sim.replicates <= 1 && !schema_is_noisy(s) &&
           estimate_options(&s->sim, &unused);
}

/* -- which --------------------------------------------------------------------------------------------------------- */

static void add(Work *w, size_t row)
{
    for (size_t i = 0; i < w->n; i++)
        if (w->named[i].row == row)
            return;
    if (!w->run.table.row[row].err && w->n < TOGETHER)
        w->named[w->n++] = (Named){.row = row};
}

/* The first ones whose error is not known yet. */
static void find(Work *w)
{
    const Run *run = &w->run;
    size_t rows[NAMED_SPREAD];
    w->n = 0;
    if (run->n_front == 0)
        return;
    add(w, run_knee(run));
    for (size_t k = 0; k < run->schema.n_obj; k++)
        add(w, run_best(run, k));
    const size_t n = run_spread_out(run, NAMED_SPREAD, 1, rows);
    for (size_t i = 0; i < n; i++)
        add(w, rows[i]);
}

/* -- simulations --------------------------------------------------------------------------------------------------- */

static Status ask_all(Work *w, Queue *q, size_t n, Err *err)
{
    Finished done;
    for (size_t i = 0; i < n; i++)
        TRY(queue_ask(q, &(Asked){.x = w->X + i * w->run.schema.n_var}, err));
    for (w->answers.n = 0; w->answers.n < n;) {
        TRY(queue_next(q, &done, err));
        TRY(evaluation_table_append(&w->answers, done.evaluation, err));
    }
    return STATUS_OK;
}

static int may_go_on(void *work)
{
    Work *w = work;
    return w->is_first || !w->go_on || w->go_on(w->user);
}

/* The first n designs in X. Where other processes simulate, they open one simulator at a time. */
static Status simulate(Work *w, size_t level, size_t n, Err *err)
{
    RunSimulator *r = &w->simulator[level];
    size_t n_ranks;
    const int elsewhere = cluster_executor(&n_ranks) || w->used->run.isolate == SWITCH_ON;
    for (size_t other = 0; other <= LEVELS && elsewhere; other++)
        if (other != level)
            run_simulator_close(&w->simulator[other]);
    if (!r->queue)
        TRY(run_simulator_open(r, w->used, &w->sim[level], may_go_on, w, err));
    return ask_all(w, r->queue, n, err);
}

static double answer(const Evaluation *e, const Schema *s, size_t k)
{
    return e->outcome != OUTCOME_OK ? NAN : k < s->n_obj ? e->f[k] : e->extra[k - s->n_obj];
}

static double promised(const Schema *s, size_t k, double value)
{
    const int id = s->order.of[k];
    const int is_share = id == MEASURE_ED1 || id == MEASURE_ED5_10 || id == MEASURE_EDCS;
    return PROMISE[id] * fmax(fabs(value), is_share ? SHARE_MIN : 0.0);
}

/* Of the promised measures every one is within that part of its promise. What is not known is not promised either. */
static int is_within(const Schema *s, double part, const double value[], const double error[])
{
    int within = 1;
    for (size_t k = 0; k < s->n_obj + s->n_extra; k++)
        within &= PROMISE[s->order.of[k]] == 0.0 || !(error[k] > part * promised(s, k, value[k]));
    return within;
}

/* A run that fails says nothing. */
static void compare(const Schema *s, Named *d, const Evaluation *finer, size_t level)
{
    d->seconds += finer->seconds;
    if (finer->outcome != OUTCOME_OK)
        return;
    for (size_t k = 0; k < s->n_obj + s->n_extra; k++) {
        d->error[k] = fabs(answer(finer, s, k) - d->value[k]);
        d->value[k] = answer(finer, s, k);
    }
    d->violation = finer->violation;
    d->level = level;
    d->is_known = is_within(s, AGREED, d->value, d->error);
}

static Status climb(Work *w, Err *err)
{
    const Schema *s = &w->run.schema;
    for (size_t level = 1; level <= LEVELS; level++) {
        size_t n = 0;
        for (size_t i = 0; i < w->n; i++)
            if (!w->named[i].is_known) {
                memcpy(w->X + n * s->n_var, run_x(&w->run, w->named[i].row), s->n_var * sizeof *w->X);
                w->asked[n++] = &w->named[i];
            }
        if (n == 0)
            break;
        TRY(simulate(w, level, n, err));
        for (size_t i = 0; i < n; i++)
            compare(s, w->asked[i], &w->answers.row[i], level);
    }
    return STATUS_OK;
}

/* -- copies -------------------------------------------------------------------------------------------------------- */

/* Signs as in the columns of a Hadamard matrix, so that no two copies move the gaps alike. */
static void change_gaps(const Schema *s, size_t copy, double x[])
{
    for (size_t j = 0; j < (size_t)s->design.n_gaps; j++)
        x[j] = fmax(0.0, x[j] + (__builtin_popcountl((j + 1) & (copy + 1)) % 2 ? ESTIMATE_GAP_M : -ESTIMATE_GAP_M));
}

/* Of the design's own value and those of n copies. */
static double deviation(size_t n, const Evaluation copies[], double own, const Schema *s, size_t k)
{
    double v[1 + COPIES] = {own}, mean, sd;
    for (size_t c = 0; c < n; c++)
        v[1 + c] = answer(&copies[c], s, k);
    mean_and_sd_of(1 + n, v, &mean, &sd);
    return sd;
}

/* Of the n designs in w->asked, by so many copies at that level, the patterns from `first` on. */
static Status spread(Work *w, size_t level, size_t n, size_t n_copies, size_t first, Err *err)
{
    const Schema *s = &w->run.schema;
    for (size_t i = 0; i < n * n_copies; i++) {
        memcpy(w->X + i * s->n_var, run_x(&w->run, w->asked[i / n_copies]->row), s->n_var * sizeof *w->X);
        change_gaps(s, first + i % n_copies, w->X + i * s->n_var);
    }
    TRY(simulate(w, level, n * n_copies, err));
    for (size_t i = 0; i < n; i++) {
        Named *d = w->asked[i];
        const Evaluation *copies = w->answers.row + i * n_copies;
        d->student = first > 0 ? STUDENT : STUDENT_FIRST;
        for (size_t k = 0; k < s->n_obj + s->n_extra; k++)
            d->sd[k] = deviation(n_copies, copies, level == 0 ? d->as_set[k] : d->value[k], s, k);
        for (size_t c = 0; c < n_copies; c++)
            d->seconds += copies[c].seconds;
    }
    return STATUS_OK;
}

/* More copies of those whose first ones disagree, by the steps that the design needs; where no steps agree, by few. */
static Status spread_all(Work *w, Err *err)
{
    for (size_t i = 0; i < w->n; i++)
        w->asked[i] = &w->named[i];
    TRY(spread(w, 0, w->n, COPIES_FIRST, 0, err));
    for (size_t level = 0; level <= LEVELS; level++) {
        size_t n = 0;
        for (size_t i = 0; i < w->n; i++) {
            Named *d = &w->named[i];
            const int is_told = is_within(&w->run.schema, AGREED / STUDENT_FIRST, d->value, d->sd);
            if (d->is_known ? d->level == level && !is_told : level == 0)
                w->asked[n++] = d;
        }
        if (n > 0)
            TRY(spread(w, level, n, COPIES, COPIES_FIRST, err));
    }
    return STATUS_OK;
}

/* -- all of it ----------------------------------------------------------------------------------------------------- */

static Evaluation record_of(const Work *w, Named *d)
{
    const Schema *s = &w->run.schema;
    const int is_predictable = d->is_known && is_within(s, 1.0, d->value, d->sd);
    for (size_t k = 0; k < s->n_obj + s->n_extra; k++) {
        const double apart = d->student * d->sd[k];
        d->error[k] = isnan(d->error[k]) || isnan(apart) ? fmax(d->error[k], apart) : hypot(d->error[k], apart);
        if (d->error[k] < LEAST * promised(s, k, d->value[k]))
            d->error[k] = LEAST * promised(s, k, d->value[k]);
    }
    return (Evaluation){.id = w->run.table.row[d->row].id,
                        .kind = KIND_UNFINISHED,
                        .level = d->level,
                        .reason = is_predictable ? "" : "unpredictable",
                        .seconds = d->seconds,
                        .violation = d->violation,
                        .f = d->value,
                        .sd = d->sd,
                        .extra = d->value + s->n_obj,
                        .err = d->error};
}

static Status know(Work *w, Err *err)
{
    const Schema *s = &w->run.schema;
    w->answers = evaluation_table(s->n_var, s->n_obj, s->n_extra);
    TRY_ROOM(w->X, COPIES * w->n * s->n_var, "designs", err);
    for (size_t i = 0; i < w->n; i++) {
        const Evaluation *e = &w->run.table.row[w->named[i].row];
        w->named[i].violation = e->violation;
        for (size_t k = 0; k < s->n_obj + s->n_extra; k++) {
            w->named[i].as_set[k] = w->named[i].value[k] = answer(e, s, k);
            w->named[i].error[k] = NAN;
        }
    }
    TRY(climb(w, err));
    TRY(spread_all(w, err));
    Evaluation better[TOGETHER];
    for (size_t i = 0; i < w->n; i++)
        better[i] = record_of(w, &w->named[i]);
    return store_finer(w->store, w->n, better, err);
}

static Status round_of_names(Work *w, Err *err)
{
    TRY(store_read(w->store, &w->run, err));
    find(w);
    const Status status = w->n > 0 ? know(w, err) : STATUS_OK;
    evaluation_table_free(&w->answers);
    free(w->X);
    w->X = NULL;
    run_free(&w->run);
    return status;
}

Status named_simulate(RunStore *store, const Settings *used, int (*go_on)(void *), void *user, Err *err)
{
    if (!named_are_known(used))
        return STATUS_OK;
    Work *w;
    TRY_ROOM(w, 1, "the designs that the study names", err);
    *w = (Work){.store = store, .used = used, .go_on = go_on, .user = user, .is_first = 1, .n = 1};
    w->sim[0] = used->sim;
    for (size_t level = 0; level < LEVELS; level++)
        estimate_options(&w->sim[level], &w->sim[level + 1]);
    Status status = STATUS_OK;
    for (int round = 0; round < ROUNDS && status == STATUS_OK && w->n > 0; round++) {
        status = round_of_names(w, err);
        w->is_first = 0;
    }
    for (size_t level = 0; level <= LEVELS; level++)
        run_simulator_close(&w->simulator[level]);
    free(w);
    return status;
}
