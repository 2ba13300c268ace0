#include "bench/search/factors.h"

#include <limits.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

#include "base/stat.h"
#include "bench/search/families.h"
#include "bench/search/methods.h"
#include "bench/search/reference.h"
#include "moga/dominance.h"
#include "moga/hypervolume.h"
#include "moga/igd.h"
#include "store/output.h"

static const double FACTOR_MAX = 20.0, LEVELS_FACTOR_MAX = 4.0;
enum { BUDGETS_MAX = 4, SEEDS_MAX = 16, METHODS_MAX = 8, PROBLEMS_MAX = 32, COSTS = 4, TIMES = 40 };
enum { WITH_LEVELS = METHODS_MAX };                          /* behind the methods: this program with a cheap level */
enum { OURS, OTHER };                                        /* the curves that a factor is made of */
static const double COST_S[COSTS] = {1e-3, 1e-2, 1.0, 60.0}; /* [s] of one simulation */

typedef enum { IGD, VOLUME, SCORES } Score;

/* Scores of a course after each evaluation. */
typedef struct {
    Course course;
    double *score[SCORES]; /* (n) */
} Curve;

typedef struct {
    const FactorPlan *plan;
    size_t methods[METHODS_MAX], n_methods; /* the first is compared with the second */
    double tau[PROBLEMS_MAX];               /* between the levels */
    size_t n_problems;
    const char *name[PROBLEMS_MAX];
    double factor[PROBLEMS_MAX][BUDGETS_MAX][SCORES];             /* medians over the seeds */
    double ratio[METHODS_MAX][BUDGETS_MAX][SCORES][PROBLEMS_MAX]; /* likewise */
    double cpu_s[METHODS_MAX][PROBLEMS_MAX];   /* [s] of the search per evaluation, at the last budget */
    double volume[COSTS][METHODS_MAX][TIMES];  /* sums of hypervolumes at times */
    size_t running[COSTS][METHODS_MAX][TIMES]; /* searches that are not at their end by then */
    size_t n_volumes;
    double total_s; /* [s] processor time of all searches */
} Tables;

static size_t n_budgets(const FactorPlan *plan)
{
    size_t n = 0;
    while (n < BUDGETS_MAX && plan->budgets[n] > 0)
        n++;
    return n;
}

static int has_levels(const FactorPlan *plan)
{
    return plan->levels.cost > 0.0;
}

/* -- courses ------------------------------------------------------------------------------------------------------- */

static Status make_course(const FactorPlan *plan, const Problem *p, size_t which, long seed, size_t n, Course *c,
                          Err *err)
{
    Settings s = *plan->settings;
    s.search.seed = seed;
    TRY(course_create(c, n, p->n_obj, err));
    return which == WITH_LEVELS ? run_levels(&s, p, &plan->levels, c, err) : method(which)->run(&s, p, c, err);
}

/* Evaluations of a search: of the one that is compared with as many as the largest factor takes. */
static size_t n_evals(const FactorPlan *plan, size_t which)
{
    const long last = plan->budgets[n_budgets(plan) - 1];
    const double most = has_levels(plan) ? LEVELS_FACTOR_MAX : FACTOR_MAX;
    return (size_t)(which == (has_levels(plan) ? METHOD_IMTET : METHOD_PLAIN) ? (long)most * last : last);
}

/* From the folder where it is there. */
static Status get_course(const FactorPlan *plan, const Problem *p, const Family *a, size_t which, long seed, Course *c,
                         Err *err)
{
    const size_t n = n_evals(plan, which);
    char path[PATH_MAX];
    int found = 0;
    if (!plan->keep || which == WITH_LEVELS)
        return make_course(plan, p, which, seed, n, c, err);
    snprintf(path, sizeof path, "%s/%s-%s-%zu-%ld.course", plan->keep, a->name, method(which)->name, n, seed);
    TRY(course_load(c, path, n, p->n_obj, &found, err));
    if (found)
        return STATUS_OK;
    TRY(make_course(plan, p, which, seed, n, c, err));
    return course_save(c, path, err);
}

/* -- scores -------------------------------------------------------------------------------------------------------- */

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

static void find_box(const Course *a, const Course *b, double lower[], double upper[])
{
    for (size_t k = 0; k < a->n_obj; k++) {
        lower[k] = INFINITY;
        upper[k] = -INFINITY;
    }
    widen_box(a, b, lower, upper);
    widen_box(b, a, lower, upper);
    for (size_t k = 0; k < a->n_obj; k++)
        upper[k] += 0.1 * fmax(upper[k] - lower[k], 1e-12);
}

static Status score_course(Curve *v, const Course *reference, const double lower[], const double upper[], Err *err)
{
    const Course *c = &v->course;
    Hypervolume *volume = NULL;
    Igd *igd = NULL;
    size_t rows[REFERENCES];
    for (size_t i = 0; i < reference->n; i++)
        rows[i] = i;
    v->score[IGD] = calloc(2 * c->n, sizeof *v->score[IGD]);
    v->score[VOLUME] = v->score[IGD] ? v->score[IGD] + c->n : NULL;
    Status status = v->score[IGD] ? hypervolume_create(&volume, c->n_obj, lower, upper, 1, err)
                                  : fail(err, STATUS_NO_MEMORY, "no memory for the scores of %zu designs", c->n);
    if (status == STATUS_OK)
        status = igd_create(&igd, c->n_obj, reference->n, rows, reference->F, err);
    for (size_t i = 0; status == STATUS_OK && i < c->n; i++) {
        if (c->counts[i]) {
            hypervolume_add(volume, c->F + i * c->n_obj);
            igd_add(igd, c->F + i * c->n_obj);
        }
        v->score[IGD][i] = igd_value(igd);
        v->score[VOLUME][i] = hypervolume_share(volume);
    }
    hypervolume_free(volume);
    igd_free(igd);
    return status;
}

static void curve_free(Curve *v)
{
    course_free(&v->course);
    free(v->score[IGD]);
    *v = (Curve){0};
}

/* Evaluations of `plain` until its score is as good as `wanted`, as a multiple of n. */
static double factor_of(const Curve *plain, Score score, double wanted, double n)
{
    const double *value = plain->score[score];
    size_t i = 0;
    while (i < plain->course.n && !(score == IGD ? value[i] <= wanted : value[i] >= wanted))
        i++;
    return i < plain->course.n ? fmin((double)(i + 1) / n, FACTOR_MAX) : FACTOR_MAX;
}

/* -- one problem --------------------------------------------------------------------------------------------------- */

/* Of each seed, for the medians. */
typedef struct {
    double factor[BUDGETS_MAX][SCORES][SEEDS_MAX], ratio[METHODS_MAX][BUDGETS_MAX][SCORES][SEEDS_MAX],
        cpu_s[METHODS_MAX][SEEDS_MAX];
} Sample;

/* Hours of which curve i takes the hypervolume: from a tenth of the first budget's simulations on, to 20 times the last. */
static double time_at(const FactorPlan *plan, int cost, int i)
{
    const double first = 0.1 * (double)plan->budgets[0], last = FACTOR_MAX * (double)plan->budgets[n_budgets(plan) - 1];
    return COST_S[cost] * first * pow(last / first, (double)i / (TIMES - 1)) / 3600.0;
}

static void add_volumes(Tables *t, const Curve curve[])
{
    for (int cost = 0; cost < COSTS; cost++)
        for (size_t v = 0; v < t->n_methods; v++)
            for (int i = 0, n = 0; i < TIMES; i++) {
                const Course *c = &curve[v].course;
                while (n < (int)c->n && c->cpu_s[n] + (n + 1) * COST_S[cost] <= 3600.0 * time_at(t->plan, cost, i))
                    n++;
                t->running[cost][v][i] += n < (int)c->n;
                t->volume[cost][v][i] += n > 0 ? curve[v].score[VOLUME][n - 1] : 0.0;
            }
    t->n_volumes++;
}

static void take_seed(Tables *t, const Curve curve[], size_t seed, Sample *s)
{
    for (size_t b = 0; b < n_budgets(t->plan); b++) {
        const size_t n = (size_t)t->plan->budgets[b];
        for (int score = 0; score < SCORES; score++) {
            const double ours = curve[OURS].score[score][n - 1];
            s->factor[b][score][seed] =
                score == VOLUME && ours <= 0.0 ? NAN : factor_of(&curve[OTHER], (Score)score, ours, (double)n);
            for (size_t v = 0; v < t->n_methods; v++) {
                s->ratio[v][b][score][seed] = ours > 0.0 ? curve[v].score[score][n - 1] / ours : NAN;
                s->cpu_s[v][seed] = curve[v].course.cpu_s[n - 1] / (double)n;
            }
        }
    }
    add_volumes(t, curve);
}

static Status run_seed(Tables *t, const Problem *p, const Family *a, const Course *reference, size_t seed, Sample *s,
                       Err *err)
{
    Curve curve[METHODS_MAX] = {0};
    double lower[FAMILY_OBJ_MAX], upper[FAMILY_OBJ_MAX];
    Status status = STATUS_OK;
    for (size_t v = 0; status == STATUS_OK && v < t->n_methods; v++)
        status = get_course(t->plan, p, a, t->methods[v], t->plan->first_seed + (long)seed, &curve[v].course, err);
    if (status == STATUS_OK)
        find_box(&curve[OURS].course, &curve[OTHER].course, lower, upper);
    for (size_t v = 0; status == STATUS_OK && v < t->n_methods; v++)
        status = score_course(&curve[v], reference, lower, upper, err);
    if (status == STATUS_OK)
        take_seed(t, curve, seed, s);
    for (size_t v = 0; v < t->n_methods; v++) {
        t->total_s += curve[v].course.n > 0 ? curve[v].course.cpu_s[curve[v].course.n - 1] : 0.0;
        curve_free(&curve[v]);
    }
    return status;
}

/* Those that are known, ascending; returns how many. */
static size_t sort_known(size_t n, double x[])
{
    size_t known = 0;
    for (size_t i = 0; i < n; i++)
        if (!isnan(x[i]))
            x[known++] = x[i];
    sort_values(known, x);
    return known;
}

/* NAN: none is known. */
static double median(size_t n, double x[])
{
    const size_t known = sort_known(n, x);
    return known > 0 ? 0.5 * (x[(known - 1) / 2] + x[known / 2]) : NAN;
}

static void take_medians(Tables *t, size_t n, Sample *s)
{
    const size_t row = t->n_problems;
    for (size_t b = 0; b < n_budgets(t->plan); b++)
        for (int score = 0; score < SCORES; score++) {
            t->factor[row][b][score] = median(n, s->factor[b][score]);
            for (size_t v = 0; v < t->n_methods; v++)
                t->ratio[v][b][score][row] = median(n, s->ratio[v][b][score]);
        }
    for (size_t v = 0; v < t->n_methods; v++)
        t->cpu_s[v][row] = median(n, s->cpu_s[v]);
}

static Status run_problem(Tables *t, size_t which, Err *err)
{
    const Family *a = family(which);
    const size_t n = (size_t)t->plan->n_seeds < SEEDS_MAX ? (size_t)t->plan->n_seeds : SEEDS_MAX;
    Sample *s = calloc(1, sizeof *s);
    Course reference = {0};
    Problem p;
    if (!s)
        return fail(err, STATUS_NO_MEMORY, "no memory for a table");
    Status status = family_open(&p, which, err);
    if (status == STATUS_OK)
        status = reference_make(&p, &reference, err);
    if (status == STATUS_OK && has_levels(t->plan))
        status = levels_agreement(&p, &t->plan->levels, &t->tau[t->n_problems], err);
    for (size_t i = 0; status == STATUS_OK && i < n; i++)
        status = run_seed(t, &p, a, &reference, i, s, err);
    if (status == STATUS_OK) {
        take_medians(t, n, s);
        t->name[t->n_problems++] = a->name;
    }
    course_free(&reference);
    problem_close(&p);
    free(s);
    return status;
}

/* -- tables -------------------------------------------------------------------------------------------------------- */

static void print_factor(double factor, FILE *out)
{
    if (isnan(factor))
        fprintf(out, " - |");
    else
        fprintf(out, " %.1f |", factor);
}

static void print_factors(const Tables *t, size_t row, const char *what, FILE *out)
{
    fprintf(out, "| %s | %s |", t->name[row], what);
    for (int score = 0; score < SCORES; score++)
        for (size_t b = 0; b < n_budgets(t->plan); b++)
            print_factor(t->factor[row][b][score], out);
    fputc('\n', out);
    fflush(out);
}

static void print_means(const Tables *t, FILE *out)
{
    fprintf(out, "| geometric mean | |");
    for (int score = 0; score < SCORES; score++)
        for (size_t b = 0; b < n_budgets(t->plan); b++) {
            double sum = 0.0, n = 0.0;
            for (size_t i = 0; i < t->n_problems; i++)
                if (!isnan(t->factor[i][b][score])) {
                    sum += log(t->factor[i][b][score]);
                    n += 1.0;
                }
            print_factor(exp(sum / n), out);
        }
    fprintf(out, "\n| worst | |");
    for (int score = 0; score < SCORES; score++)
        for (size_t b = 0; b < n_budgets(t->plan); b++) {
            size_t worst = 0;
            for (size_t i = 0; i < t->n_problems; i++)
                worst = t->factor[i][b][score] < t->factor[worst][b][score] ? i : worst;
            fprintf(out, " %s |", t->name[worst]);
        }
    fprintf(out, "\n| processor time | %.0f min |", t->total_s / 60.0);
    for (size_t b = 0; b < SCORES * n_budgets(t->plan); b++)
        fputs(" |", out);
    fputc('\n', out);
}

static void print_quartiles(size_t n, double x[], FILE *out)
{
    const size_t known = sort_known(n, x);
    if (known == 0)
        fprintf(out, " - |");
    else
        fprintf(out, " %.2f (%.2f .. %.2f) |", median(known, x), x[known / 4], x[known - 1 - known / 4]);
}

static void print_methods(Tables *t, FILE *out)
{
    fprintf(out, "\n| method |");
    for (int score = 0; score < SCORES; score++)
        for (size_t b = 0; b < n_budgets(t->plan); b++)
            fprintf(out, " %s, %ld |", score == IGD ? "IGD+" : "hypervolume", t->plan->budgets[b]);
    fprintf(out, " ms per evaluation |\n|---|");
    for (size_t b = 0; b < SCORES * n_budgets(t->plan); b++)
        fprintf(out, "---|");
    fprintf(out, "---|\n");
    for (size_t v = 0; v < t->n_methods; v++) {
        fprintf(out, "| %s |", method(t->methods[v])->name);
        for (int score = 0; score < SCORES; score++)
            for (size_t b = 0; b < n_budgets(t->plan); b++)
                print_quartiles(t->n_problems, t->ratio[v][b][score], out);
        fprintf(out, " %.3g |\n", 1e3 * median(t->n_problems, t->cpu_s[v]));
    }
}

static Status write_curves(const Tables *t, Err *err)
{
    Output o;
    TRY(output_open(&o, t->plan->curves, err));
    fprintf(o.stream, "simulation_s,method,hours,hypervolume\n");
    for (int cost = 0; cost < COSTS; cost++)
        for (size_t v = 0; v < t->n_methods; v++)
            for (int i = 0; i < TIMES && (i == 0 || t->running[cost][v][i - 1] > 0); i++)
                fprintf(o.stream, "%g,%s,%g,%.4f\n", COST_S[cost], method(t->methods[v])->name,
                        time_at(t->plan, cost, i), t->volume[cost][v][i] / (double)t->n_volumes);
    return output_close(&o, err);
}

/* -- which --------------------------------------------------------------------------------------------------------- */

static int is_listed(const char *list, const char *name)
{
    const size_t n = strlen(name);
    for (const char *p = strstr(list, name); p; p = strstr(p + 1, name))
        if ((p == list || p[-1] == ',') && (p[n] == 0 || p[n] == ','))
            return 1;
    return 0;
}

static int is_wanted(const FactorPlan *plan, const Family *a)
{
    return plan->problems ? is_listed(plan->problems, a->name) : a->is_aside == plan->aside;
}

static void choose_methods(Tables *t)
{
    const FactorPlan *plan = t->plan;
    if (has_levels(plan))
        t->methods[t->n_methods++] = WITH_LEVELS;
    for (size_t i = 0; i < method_count(); i++)
        if (i <= (has_levels(plan) ? METHOD_IMTET : METHOD_PLAIN) || plan->with_methods)
            t->methods[t->n_methods++] = i;
}

static Status fill(Tables *t, FILE *out, Err *err)
{
    const FactorPlan *plan = t->plan;
    char tau[16];
    choose_methods(t);
    if (plan->keep)
        mkdir(plan->keep, 0777);
    for (size_t i = 0; i < family_count(); i++) {
        if (!is_wanted(plan, family(i)))
            continue;
        TRY(run_problem(t, i, err));
        snprintf(tau, sizeof tau, "tau %.2f", t->tau[t->n_problems - 1]);
        print_factors(t, t->n_problems - 1, has_levels(plan) ? tau : family(i)->what, out);
    }
    return t->n_problems > 0 ? STATUS_OK : fail(err, STATUS_USAGE, "--problem: no such problem");
}

Status factors_run(const FactorPlan *plan, FILE *out, Err *err)
{
    Tables *t = calloc(1, sizeof *t);
    if (!t)
        return fail(err, STATUS_NO_MEMORY, "no memory for the tables");
    t->plan = plan;
    Status status = fill(t, out, err);
    if (status == STATUS_OK)
        print_means(t, out);
    if (status == STATUS_OK && plan->with_methods)
        print_methods(t, out);
    if (status == STATUS_OK && plan->curves)
        status = write_curves(t, err);
    free(t);
    return status;
}
