#include "study/named.h"

#include "analysis/estimate.h"
#include "base/stat.h"

/* Times that the steps are doubled, the last ones at once; copies of a design, first and where those disagree; designs
 * looked at together, before the front is formed again; how many in all, so that names which move again and again come
 * to an end, the same one after a kill. */
enum { LEVELS = TOWER_LEVELS, ONE_BY_ONE = 2, COPIES_FIRST = 2, COPIES = 6, TOGETHER = 16, NAMED_MAX = 64 };

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
    size_t tried;   /* so many levels */
    int is_known, has_all_copies;
    size_t levels_asked, copies_asked, copies_level; /* of the wave of simulations that is under way */
} Named;

typedef struct {
    RunStore *store;
    Problem problem;
    Queue *queue;
    int (*go_on)(void *user);
    void *user;
    int is_first; /* round: something comes of every session, however short */
    Run run;
    size_t n;
    Named named[TOGETHER];
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

/* -- simulations --------------------------------------------------------------------------------------------------- */

static int may_go_on(void *work)
{
    Work *w = work;
    return w->is_first || !w->go_on || w->go_on(w->user);
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
static void compare(const Schema *s, Named *d, const Evaluation *finer)
{
    d->tried++;
    if (d->is_known || finer->outcome != OUTCOME_OK)
        return;
    for (size_t k = 0; k < s->n_obj + s->n_extra; k++) {
        d->error[k] = fabs(answer(finer, s, k) - d->value[k]);
        d->value[k] = answer(finer, s, k);
    }
    d->violation = finer->violation;
    d->level = d->tried;
    d->is_known = is_within(s, AGREED, d->value, d->error);
}

/* Asks for a design, or for a copy, by whose pattern its gaps change: signs as in the columns of a Hadamard matrix, so
 * that no two copies move them alike. NULL: itself. */
static Status ask(const Work *w, const Named *d, size_t level, const size_t *copy, Err *err)
{
    const Schema *s = &w->run.schema;
    double x[DESIGN_VARIABLES_MAX];
    memcpy(x, run_x(&w->run, d->row), s->n_var * sizeof *x);
    for (size_t j = 0; copy && j < (size_t)s->design.n_gaps; j++)
        x[j] = fmax(0.0, x[j] + (__builtin_popcountl((j + 1) & (*copy + 1)) % 2 ? ESTIMATE_GAP_M : -ESTIMATE_GAP_M));
    return queue_ask(
        w->queue, &(Asked){.x = x, .variant = tower_variant(tower_of(&w->problem), &(SimTask){.level = level})}, err);
}

/* With the steps doubled until two runs agree, and two copies at once; then, where the steps or the copies disagree,
 * more copies, by the steps that the design needs; where no steps agree, by few. */
static Status ask_next(const Work *w, Named *d, Err *err)
{
    const int is_told = d->is_known && is_within(&w->run.schema, AGREED / STUDENT_FIRST, d->value, d->sd);
    d->levels_asked = d->copies_asked = 0;
    if (!d->is_known && d->tried < LEVELS) {
        d->levels_asked = d->tried < ONE_BY_ONE ? 1 : LEVELS - d->tried;
        d->copies_asked = d->tried == 0 ? COPIES_FIRST : 0;
    } else if (!d->has_all_copies && !is_told) {
        d->has_all_copies = 1;
        d->copies_asked = COPIES;
    }
    d->copies_level = d->is_known ? d->level : 0;
    for (size_t i = 1; i <= d->levels_asked; i++)
        TRY(ask(w, d, d->tried + i, NULL, err));
    for (size_t c = 0; c < d->copies_asked; c++)
        TRY(ask(w, d, d->copies_level, &(size_t){d->has_all_copies ? COPIES_FIRST + c : c}, err));
    return STATUS_OK;
}

/* The deviation is of the design's own value and those of its copies. */
static Status take(const Work *w, Named *d, Err *err)
{
    const Schema *s = &w->run.schema;
    double v[N_MEASURES][1 + COPIES], mean;
    Finished done;
    for (size_t i = 0; i < d->levels_asked; i++) {
        TRY(queue_next(w->queue, &done, err));
        d->seconds += done.evaluation->seconds;
        compare(s, d, done.evaluation);
    }
    for (size_t c = 0; c < d->copies_asked; c++) {
        TRY(queue_next(w->queue, &done, err));
        d->seconds += done.evaluation->seconds;
        for (size_t k = 0; k < s->n_obj + s->n_extra; k++)
            v[k][1 + c] = answer(done.evaluation, s, k);
    }
    for (size_t k = 0; k < s->n_obj + s->n_extra && d->copies_asked > 0; k++) {
        v[k][0] = d->copies_level == 0 ? d->as_set[k] : d->value[k];
        mean_and_sd_of(1 + d->copies_asked, v[k], &mean, &d->sd[k]);
    }
    d->student = d->has_all_copies ? STUDENT : STUDENT_FIRST;
    return STATUS_OK;
}

/* -- all of it ----------------------------------------------------------------------------------------------------- */

/* The designs of a round, side by side, wave by wave. */
static Status know(Work *w, Err *err)
{
    const Schema *s = &w->run.schema;
    const size_t n_values = s->n_obj + s->n_extra;
    Evaluation better[TOGETHER];
    for (size_t i = 0; i < w->n; i++) {
        const Evaluation *e = &w->run.table.row[w->named[i].row];
        w->named[i].violation = e->violation;
        for (size_t k = 0; k < n_values; k++) {
            w->named[i].as_set[k] = w->named[i].value[k] = answer(e, s, k);
            w->named[i].error[k] = NAN;
        }
    }
    do {
        for (size_t i = 0; i < w->n; i++)
            TRY(take(w, &w->named[i], err)); /* nothing at first */
        for (size_t i = 0; i < w->n; i++)
            TRY(ask_next(w, &w->named[i], err));
    } while (queue_pending(w->queue) > 0);
    for (size_t i = 0; i < w->n; i++) {
        Named *d = &w->named[i];
        const int is_predictable = d->is_known && is_within(s, 1.0, d->value, d->sd);
        for (size_t k = 0; k < n_values; k++) {
            const double apart = d->student * d->sd[k], least = LEAST * promised(s, k, d->value[k]);
            d->error[k] = isnan(d->error[k]) || isnan(apart) ? fmax(d->error[k], apart) : hypot(d->error[k], apart);
            if (d->error[k] < least)
                d->error[k] = least;
        }
        better[i] = (Evaluation){.id = w->run.table.row[d->row].id,
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
    return store_finer(w->store, w->n, better, err);
}

Status named_simulate(RunStore *store, const Settings *used, const Problem *problem, int (*go_on)(void *), void *user,
                      Err *err)
{
    if (!named_are_known(used))
        return STATUS_OK;
    Work *w;
    TRY_ROOM(w, 1, "the designs that the study names", err);
    *w = (Work){.store = store, .problem = *problem, .go_on = go_on, .user = user, .is_first = 1, .n = 1};
    w->problem.observer = (Observer){.go_on = may_go_on, .user = w};
    w->problem.order = NULL;
    Status status = queue_open(&w->queue, &w->problem, err);
    while (status == STATUS_OK && w->n > 0) {
        status = store_read(w->store, RUN_FRONT, &w->run, err);
        if (status != STATUS_OK)
            break;

        /* The first designs whose error is not known yet. */
        size_t rows[NAMED_SPREAD];
        const Run *run = &w->run;
        const int has_more = run->n_front > 0 && run->finer.n < NAMED_MAX;
        const size_t n_spread = has_more ? run_spread_out(run, NAMED_SPREAD, 1, rows) : 0;
        w->n = 0;
        if (has_more)
            add(w, run_knee(run));
        for (size_t k = 0; has_more && k < run->schema.n_obj; k++)
            add(w, run_best(run, k));
        for (size_t i = 0; i < n_spread; i++)
            add(w, rows[i]);
        status = w->n > 0 ? know(w, err) : STATUS_OK;
        run_free(&w->run);
        w->is_first = 0;
    }
    queue_close(w->queue);
    free(w);
    return status;
}
