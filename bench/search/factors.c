#include "bench/search/factors.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/stat.h"
#include "bench/search/families.h"
#include "moga/hypervolume.h"
#include "moga/search.h"
#include "study/study.h"

static const double FACTOR_MAX = 20.0;
enum { BUDGETS_MAX = 4, SEEDS_MAX = 16 };

/* All evaluations of a search in their order. */
typedef struct {
    size_t n, n_max, n_obj;
    double *F;
    unsigned char *counts;
} Course;

static int note(const SearchView *v, void *user)
{
    Course *c = user;
    for (; c->n < v->n && c->n < c->n_max; c->n++) {
        const size_t i = c->n;
        memcpy(c->F + i * c->n_obj, v->Y + i * c->n_obj, c->n_obj * sizeof *c->F);
        c->counts[i] = v->ok[i] && violation_of(v->n_con, v->H + i * v->n_con) == 0.0;
    }
    return 0;
}

static Status run_search(const Settings *settings, size_t problem, long seed, long n, int plain, Course *c, Err *err)
{
    Problem p;
    Settings s = *settings;
    StopReason reason;
    s.search.seed = seed;
    s.search.max_evals = n;
    s.search.generations = 1000000;
    s.search.surrogate = plain ? SURROGATE_OFF : SURROGATE_ON;
    const SearchConfig config = study_search_config(&s);
    TRY(family_open(&p, problem, err));
    *c = (Course){.n_max = (size_t)n, .n_obj = p.n_obj};
    c->F = calloc(c->n_max * p.n_obj, sizeof *c->F);
    c->counts = calloc(c->n_max, 1);
    const Status status = c->F && c->counts ? search_run(&p, &config, note, c, &reason, err)
                                            : fail(err, STATUS_NO_MEMORY, "no memory for %ld designs", n);
    problem_close(&p);
    return status;
}

static void course_free(Course *c)
{
    free(c->F);
    free(c->counts);
    *c = (Course){0};
}

static int dominates(size_t m, const double a[], const double b[])
{
    int better = 0;
    for (size_t k = 0; k < m; k++) {
        if (a[k] > b[k])
            return 0;
        better |= a[k] < b[k];
    }
    return better;
}

/* The box about the nondominated designs of both. */
static void widen_box(const Course *c, const Course *other, double lower[], double upper[])
{
    const size_t m = c->n_obj;
    for (size_t i = 0; i < c->n; i++) {
        int dominated = !c->counts[i];
        for (size_t j = c->n; j-- > 0 && !dominated;) /* late designs dominate most */
            dominated = c->counts[j] && dominates(m, c->F + j * m, c->F + i * m);
        for (size_t j = other->n; j-- > 0 && !dominated;)
            dominated = other->counts[j] && dominates(m, other->F + j * m, c->F + i * m);
        for (size_t k = 0; k < m && !dominated; k++) {
            lower[k] = fmin(lower[k], c->F[i * m + k]);
            upper[k] = fmax(upper[k], c->F[i * m + k]);
        }
    }
}

/* Adds designs until n, or until the share is `wanted`; returns how many there are then. */
static size_t advance(const Course *c, size_t from, size_t n, double wanted, Hypervolume *v)
{
    size_t i = from;
    for (; i < n && i < c->n && hypervolume_share(v) < wanted; i++)
        if (c->counts[i])
            hypervolume_add(v, c->F + i * c->n_obj);
    return i;
}

static Status compare(const FactorPlan *plan, const Course *assisted, const Course *plain, double factor[BUDGETS_MAX],
                      double share[BUDGETS_MAX], Err *err)
{
    double lower[FAMILY_OBJ_MAX], upper[FAMILY_OBJ_MAX];
    Hypervolume *ours = NULL, *theirs = NULL;
    const size_t m = plain->n_obj;
    for (size_t k = 0; k < m; k++) {
        lower[k] = INFINITY;
        upper[k] = -INFINITY;
    }
    widen_box(assisted, plain, lower, upper);
    widen_box(plain, assisted, lower, upper);
    for (size_t k = 0; k < m; k++)
        upper[k] += 0.1 * fmax(upper[k] - lower[k], 1e-12);
    Status status = hypervolume_create(&ours, m, lower, upper, 1, err);
    if (status == STATUS_OK)
        status = hypervolume_create(&theirs, m, lower, upper, 1, err);
    size_t done = 0, theirs_done = 0;
    for (int b = 0; status == STATUS_OK && b < BUDGETS_MAX && plan->budgets[b] > 0; b++) {
        const double n = (double)plan->budgets[b];
        done = advance(assisted, done, (size_t)plan->budgets[b], INFINITY, ours);
        share[b] = hypervolume_share(ours);
        theirs_done = advance(plain, theirs_done, plain->n, share[b], theirs);
        const int reached = hypervolume_share(theirs) >= share[b];
        factor[b] = share[b] <= 0.0 ? 1.0 : reached ? fmin((double)theirs_done / n, FACTOR_MAX) : FACTOR_MAX;
    }
    hypervolume_free(ours);
    hypervolume_free(theirs);
    return status;
}

/* A search with each budget is another search; the plain one is one, of the largest. */
static Status run_seed(const FactorPlan *plan, size_t problem, long seed, double factor[], double share[], Err *err)
{
    Course assisted = {0}, plain = {0};
    long last = 0;
    for (int b = 0; b < BUDGETS_MAX && plan->budgets[b] > 0; b++)
        last = plan->budgets[b];
    Status status = run_search(plan->settings, problem, seed, (long)FACTOR_MAX * last, 1, &plain, err);
    for (int b = 0; status == STATUS_OK && b < BUDGETS_MAX && plan->budgets[b] > 0; b++) {
        const FactorPlan one = {.budgets = {plan->budgets[b]}};
        status = run_search(plan->settings, problem, seed, plan->budgets[b], 0, &assisted, err);
        if (status == STATUS_OK)
            status = compare(&one, &assisted, &plain, factor + b, share + b, err);
        course_free(&assisted);
    }
    course_free(&plain);
    return status;
}

static int is_wanted(const FactorPlan *plan, const Family *a)
{
    const size_t n = strlen(a->name);
    if (!plan->problems)
        return a->is_aside == plan->aside;
    for (const char *p = strstr(plan->problems, a->name); p; p = strstr(p + 1, a->name))
        if ((p == plan->problems || p[-1] == ',') && (p[n] == 0 || p[n] == ','))
            return 1;
    return 0;
}

static double median(size_t n, double x[])
{
    sort_values(n, x);
    return 0.5 * (x[(n - 1) / 2] + x[n / 2]);
}

typedef struct {
    double log_sum[BUDGETS_MAX];
    size_t n;
} Mean;

static Status run_problem(const FactorPlan *plan, size_t problem, Mean *mean, FILE *out, Err *err)
{
    const Family *a = family(problem);
    double factor[SEEDS_MAX][BUDGETS_MAX], share[SEEDS_MAX][BUDGETS_MAX], of[SEEDS_MAX];
    const size_t n = (size_t)plan->n_seeds < SEEDS_MAX ? (size_t)plan->n_seeds : SEEDS_MAX;
    for (size_t i = 0; i < n; i++)
        TRY(run_seed(plan, problem, plan->first_seed + (long)i, factor[i], share[i], err));
    fprintf(out, "| %s | %s |", a->name, a->what);
    for (int b = 0; b < BUDGETS_MAX && plan->budgets[b] > 0; b++) {
        for (size_t i = 0; i < n; i++)
            of[i] = factor[i][b];
        const double middle = median(n, of);
        mean->log_sum[b] += log(middle);
        for (size_t i = 0; i < n; i++)
            of[i] = share[i][b];
        fprintf(out, " %.1f (%.3f) |", middle, median(n, of));
    }
    fputc('\n', out);
    fflush(out);
    mean->n++;
    return STATUS_OK;
}

Status factors_run(const FactorPlan *plan, FILE *out, Err *err)
{
    Mean mean = {0};
    for (size_t i = 0; i < family_count(); i++)
        if (is_wanted(plan, family(i)))
            TRY(run_problem(plan, i, &mean, out, err));
    if (mean.n == 0)
        return fail(err, STATUS_USAGE, "--problem: no such problem");
    fprintf(out, "| geometric mean | |");
    for (int b = 0; b < BUDGETS_MAX && plan->budgets[b] > 0; b++)
        fprintf(out, " %.1f |", exp(mean.log_sum[b] / (double)mean.n));
    fputc('\n', out);
    return STATUS_OK;
}
