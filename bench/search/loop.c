#include "bench/search/loop.h"

#include <float.h>

#include "api/search_config.h"
#include "base/carve.h"
#include "base/dominance.h"
#include "base/hypervolume.h"
#include "evaluate/adapter.h"
#include "moga/population.h"
#include "study/search_loop.h"
#include "moga/selection.h"
#include "moga/variation.h"
#include "rbf/rbf.h"

/* Of the search and of the loop; the index of crossover and mutation. */
enum { INITIAL = 100 };
static const double ETA = 20.0;

/* What is written down of either search. */
typedef struct {
    FILE *out;
    const char *which;
    uint32_t seed;
    size_t n_obj, n;
    Hypervolume *volume;
    double best[OBJECTIVES_MAX]; /* of each minimised objective */
} Curve;

typedef struct {
    const LoopPlan *plan;
    const Problem *problem;
    Queue *queue;
    uint32_t seed;
    size_t size, n, n_max; /* of the population; designs simulated, centres; room */
    double *X, *U, *F;     /* (n_max, n_var) twice, (n_max, n_obj): designs, in the unit cube, minimised objectives */
    double *range;         /* (n_obj) over them */
    Population members;
    Rbf *rbf;
    Directions directions;
    Selection *selection;
    double *u, *e, *error; /* (n_var) (n_obj) (size) share of the range */
    double *new_X, *new_F; /* (size, n_var) (size, n_obj) */
    unsigned char *ok;     /* (size) */
    size_t *member, *kept; /* (size) that is simulated; (members.n_max) */
    size_t *scratch;       /* (4 members.n_max) */
    double *start;         /* (n_var) */
    void *store;
    Curve curve;
} Loop;

static void layout(void *loop, Carve *c)
{
    Loop *l = loop;
    const size_t n_var = l->problem->n_var, n_obj = l->problem->n_obj, size = MAX_OF(l->size, INITIAL);
    CARVE(c, l->X, l->n_max * n_var);
    CARVE(c, l->U, l->n_max * n_var);
    CARVE(c, l->F, l->n_max * n_obj);
    CARVE(c, l->range, n_obj);
    CARVE(c, l->u, n_var);
    CARVE(c, l->e, n_obj);
    CARVE(c, l->error, 2 * size);
    CARVE(c, l->new_X, size * n_var);
    CARVE(c, l->new_F, size * n_obj);
    CARVE(c, l->ok, size);
    CARVE(c, l->member, size);
    CARVE(c, l->kept, 2 * size);
    CARVE(c, l->scratch, 8 * size);
    CARVE(c, l->start, n_var);
}

static double median(size_t n, double x[])
{
    sort_values(n, x);
    return n > 0 ? 0.5 * (x[(n - 1) / 2] + x[n / 2]) : NAN;
}

/* -- curves -------------------------------------------------------------------------------------------------------- */

static void curve_add(Curve *c, const double f[], int ok)
{
    c->n++;
    for (size_t k = 0; ok && k < c->n_obj; k++)
        c->best[k] = fmin(c->best[k], f[k]);
    if (ok)
        hypervolume_add(c->volume, f);
}

static void curve_write(const Curve *c, size_t iteration, double share, double error, double true_error,
                        size_t accepted)
{
    fprintf(c->out, "%u,%s,%zu,%zu,%.6f,%.4f,%.4f,%.4f,%zu", c->seed, c->which, iteration, c->n,
            hypervolume_share(c->volume), share, error, true_error, accepted);
    for (size_t k = 0; k < c->n_obj; k++)
        fprintf(c->out, ",%.6g", fabs(c->best[k]));
    fputc('\n', c->out);
    fflush(c->out);
}

static Status curve_open(Curve *c, const Loop *l, const char *which, Err *err)
{
    double lower[OBJECTIVES_MAX], reference[OBJECTIVES_MAX];
    *c = (Curve){.out = l->curve.out, .which = which, .seed = l->seed, .n_obj = l->problem->n_obj};
    for (size_t k = 0; k < c->n_obj; k++) {
        c->best[k] = lower[k] = INFINITY;
        reference[k] = -INFINITY;
        for (size_t i = 0; i < l->n && i < INITIAL; i++) {
            lower[k] = fmin(lower[k], l->F[i * c->n_obj + k]);
            reference[k] = fmax(reference[k], l->F[i * c->n_obj + k]);
        }
    }
    hypervolume_box(c->n_obj, lower, reference);
    return hypervolume_create(&c->volume, c->n_obj, lower, reference, 1, err);
}

/* -- the loop ------------------------------------------------------------------------------------------------------ */

/* n designs of new_X: into new_F and ok, and those that succeed among the centres. */
static Status simulate(Loop *l, size_t n, Err *err)
{
    const size_t n_var = l->problem->n_var, n_obj = l->problem->n_obj;
    TRY(queue_evaluate(l->queue, n, l->new_X, 0, l->new_F, NULL, l->ok, err));
    for (size_t i = 0; i < n; i++) {
        const double *x = l->new_X + i * n_var, *f = l->new_F + i * n_obj;
        if (l->curve.volume)
            curve_add(&l->curve, f, l->ok[i]);
        if (!l->ok[i])
            continue;
        copy_values(n_var, x, l->X + l->n * n_var);
        copy_values(n_obj, f, l->F + l->n * n_obj);
        problem_to_cube(l->problem, x, l->U + l->n * n_var);
        l->n++;
    }
    return STATUS_OK;
}

static void join(Loop *l, size_t row)
{
    const size_t n_obj = l->problem->n_obj, i = population_add(&l->members, l->X + row * l->problem->n_var);
    memcpy(l->members.F + i * n_obj, l->F + row * n_obj, n_obj * sizeof *l->F);
    l->members.row[i] = row;
}

static Status first(Loop *l, Err *err)
{
    const Problem *p = l->problem;
    memcpy(l->new_X, l->start, p->n_var * sizeof *l->start);
    latin_hypercube(l->seed, 0, INITIAL - 1, p->n_var, l->new_X + p->n_var, l->scratch);
    for (size_t i = 0; i < INITIAL; i++) {
        double *x = l->new_X + i * p->n_var;
        for (size_t d = 0; i > 0 && d < p->n_var; d++)
            x[d] = problem_spread(p, d, x[d]);
        problem_repair(p, x);
    }
    TRY(simulate(l, INITIAL, err));
    for (size_t row = 0; row < l->n; row++)
        join(l, row);
    TRY(curve_open(&l->curve, l, "loop", err));
    for (size_t i = 0; i < INITIAL; i++) {
        curve_add(&l->curve, l->new_F + i * p->n_obj, l->ok[i]);
        if (i == 0)
            curve_write(&l->curve, 0, NAN, NAN, NAN, 0); /* the start alone */
    }
    return STATUS_OK;
}

static Status fit(Loop *l, Err *err)
{
    const size_t n_obj = l->problem->n_obj;
    for (size_t k = 0; k < n_obj; k++) {
        double least = INFINITY, most = -INFINITY;
        for (size_t i = 0; i < l->n; i++) {
            least = fmin(least, l->F[i * n_obj + k]);
            most = fmax(most, l->F[i * n_obj + k]);
        }
        l->range[k] = fmax(most - least, DBL_MIN);
    }
    free(l->rbf); /* nothing of it outlives a fit; its room grows as the square of the centres */
    TRY(rbf_create(&l->rbf, l->n, l->problem->n_var, n_obj, err));
    return rbf_fit(l->rbf, l->n, l->U, l->F, NULL, err);
}

/* Objectives of member i, and their error: share of the range, of the worst objective. */
static double predict(Loop *l, size_t i)
{
    const size_t n_obj = l->problem->n_obj;
    double worst = 0.0;
    problem_to_cube(l->problem, l->members.X + i * l->problem->n_var, l->u);
    rbf_eval(l->rbf, 1, l->u, l->members.F + i * n_obj, l->e);
    for (size_t k = 0; k < n_obj; k++)
        worst = fmax(worst, l->e[k] / l->range[k]);
    return worst;
}

static const double *tournament(const Population *p, size_t n, Random *random)
{
    const size_t a = random_below(random, n), b = random_below(random, n), m = p->n_obj;
    const int b_wins = dominates_constrained(m, p->F + b * m, p->violation[b], p->F + a * m, p->violation[a]);
    return p->X + (b_wins ? b : a) * p->n_var;
}

/* As many children as the population has members, behind them. */
static void breed(Loop *l, uint32_t iteration)
{
    const Problem *p = l->problem;
    const size_t n_parents = l->members.n, n = p->n_var;
    for (uint32_t j = 0; 2 * j < l->size; j++) {
        Random choice = random_stream(l->seed, RANDOM_PARENTS, iteration, j),
               change = random_stream(l->seed, RANDOM_VARIATION, iteration, j);
        const double *mother = tournament(&l->members, n_parents, &choice),
                     *father = tournament(&l->members, n_parents, &choice);
        crossover_sbx(&change, n, p->lower, p->upper, ETA, mother, father, l->new_X, l->new_X + n);
        for (size_t i = 0; i < 2 && 2 * j + i < l->size; i++) {
            mutate_polynomial(&change, n, p->lower, p->upper, 1.0 / (double)n, ETA, l->new_X + i * n);
            problem_repair(p, l->new_X + i * n);
            population_add(&l->members, l->new_X + i * n);
        }
    }
}

/* The n members listed in `member`: their predictions make way for what is simulated; returns the median difference, as
 * errors are counted. One that fails comes behind all others. */
static Status verify(Loop *l, size_t n, double *error, Err *err)
{
    const size_t n_var = l->problem->n_var, n_obj = l->problem->n_obj;
    size_t row = l->n, n_ok = 0;
    for (size_t i = 0; i < n; i++)
        memcpy(l->new_X + i * n_var, l->members.X + l->member[i] * n_var, n_var * sizeof *l->X);
    TRY(simulate(l, n, err));
    for (size_t i = 0; i < n; i++) {
        double *f = l->members.F + l->member[i] * n_obj, worst = 0.0;
        l->members.violation[l->member[i]] = !l->ok[i];
        l->members.row[l->member[i]] = row;
        if (!l->ok[i])
            continue;
        for (size_t k = 0; k < n_obj; k++)
            worst = fmax(worst, fabs(f[k] - l->new_F[i * n_obj + k]) / l->range[k]);
        memcpy(f, l->F + row++ * n_obj, n_obj * sizeof *f);
        l->error[n_ok++] = worst;
    }
    *error = median(n_ok, l->error);
    return STATUS_OK;
}

/* The next population, of this one and its children; returns the share of it that is nondominated. */
static double survive(Loop *l, uint32_t iteration)
{
    Population *p = &l->members;
    Random random = random_stream(l->seed, RANDOM_NICHING, iteration, 0);
    const size_t n = selection_select(l->selection, p->n, p->F, p->violation, l->size, &random, l->kept);
    size_t *rank = l->scratch, n_first = 0;
    population_keep(p, n, l->kept);
    nondominated_sort(n, p->n_obj, p->F, p->violation, rank, rank + n);
    for (size_t i = 0; i < n; i++)
        n_first += rank[i] == 0;
    return (double)n_first / (double)n;
}

static Status iterate(Loop *l, uint32_t iteration, Err *err)
{
    const size_t n_parents = l->members.n;
    size_t n = 0;
    double true_error;
    TRY(fit(l, err));
    for (size_t i = 0; i < n_parents; i++)
        if (l->members.row[i] == PREDICTED)
            predict(l, i);
    breed(l, iteration);
    for (size_t i = n_parents; i < l->members.n; i++) {
        l->error[i - n_parents] = predict(l, i);
        if (l->error[i - n_parents] > l->plan->error_max)
            l->member[n++] = i;
    }
    const double error = median(l->size, l->error);
    TRY(verify(l, n, &true_error, err));
    curve_write(&l->curve, iteration, survive(l, iteration), error, true_error, l->size - n);
    return STATUS_OK;
}

/* What of the last population is predicted is simulated. */
static Status finish(Loop *l, Err *err)
{
    size_t n = 0;
    double true_error;
    for (size_t i = 0; i < l->members.n; i++)
        if (l->members.row[i] == PREDICTED)
            l->member[n++] = i;
    TRY(verify(l, n, &true_error, err));
    curve_write(&l->curve, (size_t)l->plan->iterations + 1, NAN, NAN, true_error, n);
    return STATUS_OK;
}

static Status run_loop(Loop *l, Err *err)
{
    TRY(first(l, err));
    curve_write(&l->curve, 0, survive(l, 0), NAN, NAN, 0);
    for (uint32_t i = 1; i <= (uint32_t)l->plan->iterations; i++)
        TRY(iterate(l, i, err));
    return finish(l, err);
}

/* -- the search beside it ------------------------------------------------------------------------------------------ */

static int note(const SearchView *v, const SearchTime *time, void *user)
{
    Curve *c = user;
    const Archive *a = v->all;
    (void)time;
    for (size_t i = c->n; i < a->n; i++) {
        curve_add(c, a->Y + i * a->n_obj, a->ok[i]);
        if (c->n == INITIAL)
            curve_write(c, 0, NAN, NAN, NAN, 0); /* the sample, as in the loop */
    }
    curve_write(c, v->generation, NAN, v->surrogate_error, NAN, 0);
    return 0;
}

static Status run_search(const Loop *l, Err *err)
{
    SearchConfig config = search_config_of(l->plan->settings);
    StopReason reason;
    Curve c;
    config.seed = l->seed;
    config.initial = INITIAL;
    config.given = l->start;
    config.n_given = 1;
    config.max_evals = l->curve.n;
    TRY(curve_open(&c, l, "search", err));
    const Status status = search_run(l->problem, &config, NULL, note, &c, &reason, err);
    hypervolume_free(c.volume);
    return status;
}

/* -- both ---------------------------------------------------------------------------------------------------------- */

/* The start: gaps that grow by 8 mm a floor, walls of 12 to 6.4 mm. */
static void set_start(const Problem *p, double x[])
{
    for (size_t d = 0; d < p->n_var; d++) {
        const double gap = 0.008 * (double)(d + 1), wall = d + 1 < p->n_var ? 0.012 : 0.0064;
        x[d] = fmin(fmax(d + 2 < p->n_var ? gap : wall, p->lower[d]), p->upper[d]);
    }
}

static Status loop_open(Loop *l, Err *err)
{
    const Problem *p = l->problem;
    size_t outer, inner;
    l->size = (size_t)l->plan->settings->search.population;
    l->n_max = INITIAL + l->size * (size_t)(l->plan->iterations + 1);
    l->store = carve_all(layout, l);
    if (!l->store)
        return fail(err, STATUS_NO_MEMORY, "no memory for %zu designs", l->n_max);
    set_start(p, l->start);
    TRY(queue_open(&l->queue, p, err));
    TRY(population_create(&l->members, 2 * MAX_OF(l->size, INITIAL), p->n_var, p->n_obj, err));
    directions_choose(p->n_obj, l->size, &outer, &inner);
    TRY(directions_create(&l->directions, p->n_obj, outer, inner, err));
    return selection_create(&l->selection, l->members.n_max, &l->directions, NULL, err);
}

static void loop_close(Loop *l)
{
    queue_close(l->queue);
    population_free(&l->members);
    directions_free(&l->directions);
    hypervolume_free(l->curve.volume);
    free(l->rbf);
    free(l->selection);
    free(l->store);
}

static Status run_seed(const LoopPlan *plan, const Problem *p, uint32_t seed, FILE *out, Err *err)
{
    Loop l = {.plan = plan, .problem = p, .seed = seed, .curve.out = out};
    Status status = loop_open(&l, err);
    THEN(status, run_loop(&l, err));
    queue_close(l.queue);
    l.queue = NULL;
    THEN(status, run_search(&l, err));
    loop_close(&l);
    return status;
}

Status loop_run(const LoopPlan *plan, FILE *out, Err *err)
{
    Adapter *a;
    TRY(adapter_open(&a, plan->settings, err));
    const Schema *schema = adapter_schema(a);
    fputs("seed,search,iteration,simulations,hypervolume,nondominated,error,true_error,accepted", out);
    for (size_t k = 0; k < schema->n_obj; k++)
        fprintf(out, ",%s", schema_objective(schema, k)->name);
    fputc('\n', out);
    Status status = STATUS_OK;
    for (long i = 0; status == STATUS_OK && i < plan->n_seeds; i++)
        status = run_seed(plan, adapter_problem(a), (uint32_t)(plan->settings->search.seed + i), out, err);
    adapter_close(a);
    return status;
}
