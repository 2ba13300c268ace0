#include "study/simplify.h"

#include "base/clock.h"
#include "settings/options.h"
#include "study/run_simulator.h"

enum { ROUNDS = 50 };

typedef struct {
    const Run *run;
    const SimplifyConfig *config;
    Simplified *out;
    RunSimulator simulator;
    const DesignSpace *space;
    size_t n_var, n_obj;
    double first[OBJECTIVES_MAX]; /* minimised objectives of the start */
    double violation;             /* ... of the limits */
    double *x;                    /* (n_var) so far */
    double *X, *F, *G;            /* (2 n_var, n_var) (2 n_var, n_obj) (2 n_var, n_con) designs of a round */
    unsigned char *ok;            /* (2 n_var) */
    size_t n;                     /* of them */
} Simplify;

/* -- designs of a round -------------------------------------------------------------------------------------------- */

/* The place of the word none of choice j; -1: it has none, or is no choice. */
static int none_of(const Simplify *s, size_t j)
{
    int w = 0;
    for (const char *word; (word = design_word(s->space, (int)j, w)); w++)
        if (strcmp(word, "none") == 0)
            return w;
    return -1;
}

/* Variable j is a gap of the present design that is narrower than an open one. */
static int is_stop(const Simplify *s, size_t j)
{
    return (int)j < s->space->n_gaps && s->x[j] < DESIGN_OPEN_M;
}

/* Variable j stands for a device that may go: a choice where the space has any, whose last variable is one then. */
static int is_device(const Simplify *s, size_t j)
{
    return none_of(s, s->n_var - 1) < 0 ? is_stop(s, j) : none_of(s, j) >= 0 && s->x[j] != none_of(s, j);
}

static size_t n_left(const Simplify *s)
{
    size_t n = 0;
    for (size_t j = 0; j < s->n_var; j++)
        n += is_device(s, j);
    return n;
}

/* Variable k moves with variable j. */
static int moves_with(const Simplify *s, size_t j, size_t k)
{
    return k == j || (s->config->zones > 0 && design_share_zone(s->space, (int)j, (int)k, s->config->zones));
}

/* The first variable of those that move together. */
static int leads(const Simplify *s, size_t j)
{
    for (size_t k = 0; k < j; k++)
        if (moves_with(s, j, k))
            return 0;
    return 1;
}

/* The present design with variable j, and what moves with it, at `value`. */
static void add(Simplify *s, size_t j, double value)
{
    double *x = s->X + s->n++ * s->n_var;
    memcpy(x, s->x, s->n_var * sizeof *x);
    for (size_t k = 0; k < s->n_var; k++)
        if (moves_with(s, j, k))
            x[k] = value;
}

/* Of variable j where its device has gone. */
static double gone(const Simplify *s, size_t j)
{
    return none_of(s, j) >= 0 ? none_of(s, j) : DESIGN_OPEN_M;
}

/* Above 1 where limits are violated by more than at the start. */
static double loss_of(const Simplify *s, const double f[], const double g[])
{
    const double more = violation_of(adapter_problem(s->simulator.adapter)->n_con, g) - s->violation;
    double loss = more > 0.0 ? 1.0 + more : -INFINITY;
    for (size_t k = 0; k < s->n_obj; k++)
        if (isfinite(s->config->slack[k]))
            loss = fmax(loss, (f[k] - s->first[k]) / fmax(s->config->slack[k] * fabs(s->first[k]), 1e-300));
    return loss;
}

static Status simulate_round(Simplify *s, Err *err)
{
    const Problem *p = adapter_problem(s->simulator.adapter);
    for (size_t i = 0; i < s->n; i++) /* the steps of a search have no gap without a stop */
        p->repair(s->X + i * s->n_var, p->self);
    s->out->n_evaluated += s->n;
    return queue_evaluate(s->simulator.queue, s->n, s->X, NULL, s->F, s->G, s->ok, err);
}

/* The design of a simulated round with the least loss; s->n: none succeeds. */
static size_t find_least(const Simplify *s, double *loss)
{
    const size_t n_con = adapter_problem(s->simulator.adapter)->n_con;
    size_t least = s->n;
    *loss = INFINITY;
    for (size_t i = 0; i < s->n; i++) {
        const double now = loss_of(s, s->F + i * s->n_obj, s->G + i * n_con);
        if (s->ok[i] && now < *loss) {
            least = i;
            *loss = now;
        }
    }
    return least;
}

/* The present design with all its numbers, as the next one of the path. */
static Status note(Simplify *s, Simplification what, Err *err)
{
    Finished done;
    Simplified *out = s->out;
    TRY(queue_ask(s->simulator.queue, &(Asked){.x = s->x}, err));
    TRY(queue_next(s->simulator.queue, &done, err));
    if (done.evaluation->outcome != OUTCOME_OK)
        return bad_data(err, "the design fails when it is simulated again (%s %s): choose another one",
                        outcome_word(done.evaluation->outcome), done.evaluation->reason);
    if (what == SIMPLIFY_START) {
        memcpy(s->first, done.f, s->n_obj * sizeof *done.f);
        s->violation = done.evaluation->violation;
    }
    out->loss[what] = loss_of(s, done.f, done.g);
    out->n_left[what] = n_left(s);
    for (size_t k = 0; k < s->n_obj; k++)
        out->error[what][k] = NAN;
    out->n_evaluated++;
    out->n = (size_t)what + 1;
    return evaluation_table_append(&out->designs, done.evaluation, err);
}

/* -- the path ------------------------------------------------------------------------------------------------------ */

/* The same results, but for what counts devices; beside links a stop that never closes changes their steps. */
static int is_same(const Simplify *s, const double f[])
{
    static const double ALIKE = 1e-6;
    int same = 1;
    for (size_t k = 0; k < s->n_obj; k++) {
        const int id = s->run->schema.order.of[k];
        same &= fabs(f[k] - s->first[k]) <= ALIKE * fabs(s->first[k]) || id == MEASURE_DEVICES || id == MEASURE_COST;
    }
    return same;
}

static Status drop_idle_stops(Simplify *s, Err *err)
{
    s->n = 0;
    for (size_t j = 0; j < s->n_var; j++)
        if (is_device(s, j)) {
            double *x = s->X + s->n++ * s->n_var; /* alone */
            memcpy(x, s->x, s->n_var * sizeof *x);
            x[j] = gone(s, j);
        }
    TRY(simulate_round(s, err));
    for (size_t j = 0, i = 0; j < s->n_var; j++)
        if (is_device(s, j)) { /* design i of the round does not have it */
            if (s->ok[i] && is_same(s, s->F + i * s->n_obj))
                s->x[j] = gone(s, j);
            i++;
        }
    return note(s, SIMPLIFY_CLOSING, err);
}

/* The mean of what moves with variable j, of gaps that are stops; of words the most frequent one, of equals the
 * first. */
static double middle_of(const Simplify *s, size_t j)
{
    double sum = 0.0, word = s->x[j];
    size_t n = 0, most = 0;
    for (size_t k = 0; k < s->n_var; k++) {
        size_t alike = 0;
        if (!moves_with(s, j, k) || ((int)k < s->space->n_gaps && !is_stop(s, k)))
            continue;
        for (size_t i = 0; i < s->n_var; i++)
            alike += moves_with(s, j, i) && s->x[i] == s->x[k];
        if (alike > most) {
            most = alike;
            word = s->x[k];
        }
        sum += s->x[k];
        n++;
    }
    return n == 0 || design_word(s->space, (int)j, 0) ? word : sum / (double)n;
}

static Status merge_zones(Simplify *s, Err *err)
{
    for (size_t j = 0; j < s->n_var && s->config->zones > 0; j++) {
        s->n = 0;
        if (leads(s, j))
            add(s, j, middle_of(s, j));
        if (s->n > 0)
            memcpy(s->x, s->X, s->n_var * sizeof *s->x);
    }
    return note(s, SIMPLIFY_ZONES, err);
}

static size_t nearest_plate(const SimplifyConfig *c, double t)
{
    size_t best = 0;
    for (size_t i = 1; i < c->n_plates; i++)
        if (fabs(c->plate[i] - t) < fabs(c->plate[best] - t))
            best = i;
    return best;
}

static Status put_on_steps(Simplify *s, Err *err)
{
    const SimplifyConfig *c = s->config;
    for (size_t j = 0; j < s->n_var; j++)
        if (design_is_wall(s->space, (int)j) && c->n_plates > 0)
            s->x[j] = c->plate[nearest_plate(c, s->x[j])];
        else if (is_stop(s, j) && c->gap_step > 0.0)
            s->x[j] = fmax(round(s->x[j] / c->gap_step), 1.0) * c->gap_step;
    return note(s, SIMPLIFY_STEPS, err);
}

static void add_neighbours(Simplify *s)
{
    const SimplifyConfig *c = s->config;
    s->n = 0;
    for (size_t j = 0; j < s->n_var; j++) {
        if (!leads(s, j)) {
            continue;
        } else if (design_is_wall(s->space, (int)j) && c->n_plates > 0) {
            const size_t at = nearest_plate(c, s->x[j]);
            for (size_t next = at - 1; next != at + 3; next += 2) /* before the first one it is too large */
                if (next < c->n_plates)
                    add(s, j, c->plate[next]);
        } else if (is_stop(s, j) && c->gap_step > 0.0) {
            const double steps = round(s->x[j] / c->gap_step);
            add(s, j, (steps + 1.0) * c->gap_step);
            if (steps > 1.0)
                add(s, j, (steps - 1.0) * c->gap_step);
        }
    }
}

static Status descend_on_steps(Simplify *s, Err *err)
{
    double now, loss = s->out->loss[SIMPLIFY_STEPS];
    for (int round = 0; round < ROUNDS && loss > 1.0; round++) {
        add_neighbours(s);
        TRY(simulate_round(s, err));
        const size_t least = find_least(s, &now);
        if (!(now < loss))
            break;
        memcpy(s->x, s->X + least * s->n_var, s->n_var * sizeof *s->x);
        loss = now;
    }
    return note(s, SIMPLIFY_MOVED, err);
}

static Status drop_what_earns_little(Simplify *s, Err *err)
{
    for (double loss;;) {
        s->n = 0;
        for (size_t j = 0; j < s->n_var; j++)
            if (is_device(s, j) && leads(s, j))
                add(s, j, gone(s, j));
        TRY(simulate_round(s, err));
        const size_t least = find_least(s, &loss);
        if (!(loss <= 1.0))
            return note(s, SIMPLIFY_FEWER, err);
        memcpy(s->x, s->X + least * s->n_var, s->n_var * sizeof *s->x);
    }
}

static Status reserve(Simplify *s, const double start[], Err *err)
{
    const size_t n_con = adapter_problem(s->simulator.adapter)->n_con, n = 2 * s->n_var; /* as add_neighbours may add */
    TRY_ROOM(s->x, s->n_var, "variables", err);
    TRY_ROOM(s->X, n * s->n_var, "designs", err);
    TRY_ROOM(s->F, n * s->n_obj, "designs", err);
    TRY_ROOM(s->G, n * n_con + 1, "designs", err);
    TRY_ROOM(s->ok, n, "designs", err);
    memcpy(s->x, start, s->n_var * sizeof *s->x);
    return STATUS_OK;
}

/* What twice the steps change in the designs of the path. */
static Status find_errors(Simplify *s, Err *err)
{
    SimOptions finer;
    const EvaluationTable *path = &s->out->designs;
    if (!estimate_options(&s->run->settings->sim, &finer))
        return STATUS_OK;
    TRY(run_simulator_open(&s->simulator, s->run->settings, &finer, s->config->go_on, s->config->user, err));
    TRY(queue_evaluate(s->simulator.queue, path->n, path->x, NULL, s->F, s->G, s->ok, err));
    for (size_t i = 0; i < path->n; i++)
        for (size_t k = 0; k < s->n_obj && s->ok[i]; k++)
            s->out->error[i][k] =
                fabs(s->F[i * s->n_obj + k] - schema_objective(&s->run->schema, k)->sense * path->row[i].f[k]);
    return STATUS_OK;
}

static Status walk(Simplify *s, const double start[], Err *err)
{
    const Settings *own = s->run->settings;
    TRY(run_simulator_open(&s->simulator, own, &own->sim, s->config->go_on, s->config->user, err));
    TRY(reserve(s, start, err));
    TRY(note(s, SIMPLIFY_START, err));
    TRY(drop_idle_stops(s, err));
    TRY(merge_zones(s, err));
    TRY(put_on_steps(s, err));
    TRY(descend_on_steps(s, err));
    if (s->out->loss[SIMPLIFY_MOVED] <= 1.0)
        TRY(drop_what_earns_little(s, err));
    return find_errors(s, err);
}

Status simplify_design(const Run *run, size_t row, const SimplifyConfig *config, Simplified *out, Err *err)
{
    const Schema *schema = &run->schema;
    const double begun = clock_seconds();
    Simplify s = {.run = run,
                  .config = config,
                  .out = out,
                  .space = &schema->design,
                  .n_var = schema->n_var,
                  .n_obj = schema->n_obj};
    *out = (Simplified){.designs = evaluation_table(schema->n_var, schema->n_obj, schema->n_extra)};
    if (run->settings->problem.kind != PROBLEM_TOWER)
        return bad_data(err, "%s: simplify is for designs of a tower, with gaps and plates", run->folder);
    const Status status = walk(&s, run_x(run, row), err);
    run_simulator_close(&s.simulator);
    free(s.x);
    free(s.X);
    free(s.F);
    free(s.G);
    free(s.ok);
    out->seconds = clock_seconds() - begun;
    return status;
}

void simplified_free(Simplified *s)
{
    evaluation_table_free(&s->designs);
    *s = (Simplified){0};
}
