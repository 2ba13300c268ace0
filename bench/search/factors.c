#include "bench/search/factors.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/stat.h"
#include "bench/search/families.h"
#include "bench/search/reference.h"
#include "base/dominance.h"
#include "base/hypervolume.h"
#include "study/search_loop.h"
#include "api/search_config.h"

static const double FACTOR_MAX = 20.0;
enum { BUDGETS_MAX = 4, SEEDS_MAX = 16, PROBLEMS_MAX = 32 };

typedef enum { OURS, PLAIN, SEARCHES } Which;
typedef enum { IGD, VOLUME, SCORES } Score;

/* Scores of a course after each evaluation. */
typedef struct {
    Course course;
    double *score[SCORES]; /* (n) */
} Curve;

typedef struct {
    const FactorPlan *plan;
    size_t n_problems;
    const char *name[PROBLEMS_MAX];
    double factor[PROBLEMS_MAX][BUDGETS_MAX][SCORES]; /* medians over the seeds */
    double total_s;                                   /* [s] processor time of all searches */
    double distinct;                                  /* share of this program's evaluations, least of all searches */
} Tables;

static size_t n_budgets(const FactorPlan *plan)
{
    size_t n = 0;
    while (n < BUDGETS_MAX && plan->budgets[n] > 0)
        n++;
    return n;
}

/* -- courses ------------------------------------------------------------------------------------------------------- */

static int note(const SearchView *v, const SearchTime *time, void *user)
{
    Course *c = user;
    const Archive *a = v->all;
    (void)time;
    for (size_t i = c->n; i < a->n && c->n < c->n_max; i++)
        course_add(c, a->Y + i * c->n_obj, a->ok[i] && violation_of(a->n_con, a->H + i * a->n_con) == 0.0);
    return 0;
}

Status search_course(const Settings *settings, const Problem *p, SurrogateUse surrogate, Course *c, Err *err)
{
    Settings s = *settings;
    StopReason reason;
    s.search.max_evals = (long)c->n_max;
    s.search.surrogate = surrogate;
    const SearchConfig config = search_config_of(&s);
    return search_run(p, &config, NULL, note, c, &reason, err);
}

/* The plain search has as many evaluations as the largest factor takes. */
static Status make_course(const FactorPlan *plan, const Problem *p, Which which, long seed, Course *c, Err *err)
{
    const double most = which == PLAIN ? FACTOR_MAX : 1.0;
    Settings s = *plan->settings;
    s.search.seed = seed;
    TRY(course_create(c, (size_t)(most * (double)plan->budgets[n_budgets(plan) - 1]), p->n_obj, err));
    return search_course(&s, p, which == OURS ? SURROGATE_ON : SURROGATE_OFF, c, err);
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

/* Squared distance of f from each reference, in what is worse, of the nearest design so far: IGD+ is the mean of the roots
 * (Ishibuchi, Masuda, Tanigaki and Nojima, EMO 2015). */
static double draw_near(const Course *reference, const double width[], const double f[], double square[])
{
    const size_t m = reference->n_obj;
    double sum = 0.0;
    for (size_t i = 0; i < reference->n; i++) {
        double worse = 0.0;
        for (size_t k = 0; f && k < m; k++) {
            const double off = fmax(f[k] - reference->F[i * m + k], 0.0) / width[k];
            worse += off * off;
        }
        square[i] = f ? fmin(square[i], worse) : square[i];
        sum += sqrt(square[i]);
    }
    return sum / (double)reference->n;
}

static void range_of(const Course *c, double width[])
{
    for (size_t k = 0; k < c->n_obj; k++) {
        double min = INFINITY, max = -INFINITY;
        for (size_t i = 0; i < c->n; i++) {
            min = fmin(min, c->F[i * c->n_obj + k]);
            max = fmax(max, c->F[i * c->n_obj + k]);
        }
        width[k] = max > min ? max - min : 1.0;
    }
}

static Status score_course(Curve *v, const Course *reference, const double lower[], const double upper[], Err *err)
{
    const Course *c = &v->course;
    Hypervolume *volume = NULL;
    double width[FAMILY_OBJ_MAX], square[REFERENCES];
    range_of(reference, width);
    for (size_t i = 0; i < reference->n; i++)
        square[i] = INFINITY;
    v->score[IGD] = calloc(2 * c->n, sizeof *v->score[IGD]);
    v->score[VOLUME] = v->score[IGD] ? v->score[IGD] + c->n : NULL;
    if (!v->score[IGD])
        return fail(err, STATUS_NO_MEMORY, "no memory for the scores of %zu designs", c->n);
    TRY(hypervolume_create(&volume, c->n_obj, lower, upper, 1, err));
    for (size_t i = 0; i < c->n; i++) {
        const double *f = c->counts[i] ? c->F + i * c->n_obj : NULL;
        if (f)
            hypervolume_add(volume, f);
        v->score[IGD][i] = draw_near(reference, width, f, square);
        v->score[VOLUME][i] = hypervolume_share(volume);
    }
    hypervolume_free(volume);
    return STATUS_OK;
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
typedef double Sample[BUDGETS_MAX][SCORES][SEEDS_MAX];

/* Share of evaluations whose objectives no other one has. */
static double distinct_share(const Course *c)
{
    size_t n = 0;
    for (size_t i = 0; i < c->n; i++) {
        size_t j = 0;
        while (j < i && memcmp(c->F + j * c->n_obj, c->F + i * c->n_obj, c->n_obj * sizeof *c->F) != 0)
            j++;
        n += j == i;
    }
    return (double)n / (double)c->n;
}

static void take_seed(const Tables *t, const Curve curve[], size_t seed, Sample factor)
{
    for (size_t b = 0; b < n_budgets(t->plan); b++)
        for (int score = 0; score < SCORES; score++) {
            const size_t n = (size_t)t->plan->budgets[b];
            const double ours = curve[OURS].score[score][n - 1];
            factor[b][score][seed] =
                score == VOLUME && ours <= 0.0 ? NAN : factor_of(&curve[PLAIN], (Score)score, ours, (double)n);
        }
}

static Status run_seed(Tables *t, const Problem *p, const Course *reference, size_t seed, Sample factor, Err *err)
{
    Curve curve[SEARCHES] = {0};
    double lower[FAMILY_OBJ_MAX], upper[FAMILY_OBJ_MAX];
    Status status = STATUS_OK;
    for (int v = 0; status == STATUS_OK && v < SEARCHES; v++)
        status = make_course(t->plan, p, (Which)v, t->plan->first_seed + (long)seed, &curve[v].course, err);
    if (status == STATUS_OK)
        find_box(&curve[OURS].course, &curve[PLAIN].course, lower, upper);
    for (int v = 0; status == STATUS_OK && v < SEARCHES; v++)
        status = score_course(&curve[v], reference, lower, upper, err);
    if (status == STATUS_OK) {
        take_seed(t, curve, seed, factor);
        t->distinct = fmin(t->distinct, distinct_share(&curve[OURS].course));
    }
    for (int v = 0; v < SEARCHES; v++) {
        t->total_s += curve[v].course.n > 0 ? curve[v].course.cpu_s[curve[v].course.n - 1] : 0.0;
        curve_free(&curve[v]);
    }
    return status;
}

/* Of those that are known; NAN: none is. */
static double median(size_t n, double x[])
{
    size_t known = 0;
    for (size_t i = 0; i < n; i++)
        if (!isnan(x[i]))
            x[known++] = x[i];
    sort_values(known, x);
    return known > 0 ? 0.5 * (x[(known - 1) / 2] + x[known / 2]) : NAN;
}

static Status run_problem(Tables *t, size_t which, Err *err)
{
    const size_t n = (size_t)t->plan->n_seeds < SEEDS_MAX ? (size_t)t->plan->n_seeds : SEEDS_MAX;
    Sample factor;
    Course reference = {0};
    Problem p;
    Status status = family_open(&p, which, err);
    THEN(status, reference_make(&p, &reference, err));
    for (size_t i = 0; status == STATUS_OK && i < n; i++)
        status = run_seed(t, &p, &reference, i, factor, err);
    for (size_t b = 0; status == STATUS_OK && b < n_budgets(t->plan); b++)
        for (int score = 0; score < SCORES; score++)
            t->factor[t->n_problems][b][score] = median(n, factor[b][score]);
    if (status == STATUS_OK)
        t->name[t->n_problems++] = family(which)->name;
    course_free(&reference);
    problem_close(&p);
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
    fprintf(out, "\n| evaluations with objectives of their own, least share of a search | %.3f |", t->distinct);
    for (size_t b = 0; b < SCORES * n_budgets(t->plan); b++)
        fputs(" |", out);
    fprintf(out, "\n| processor time | %.0f min |", t->total_s / 60.0);
    for (size_t b = 0; b < SCORES * n_budgets(t->plan); b++)
        fputs(" |", out);
    fputc('\n', out);
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

Status factors_run(const FactorPlan *plan, FILE *out, Err *err)
{
    Tables t = {.plan = plan, .distinct = 1.0};
    for (size_t i = 0; i < family_count(); i++) {
        if (!is_wanted(plan, family(i)))
            continue;
        TRY(run_problem(&t, i, err));
        print_factors(&t, t.n_problems - 1, family(i)->what, out);
    }
    if (t.n_problems == 0)
        return fail(err, STATUS_USAGE, "--problem: no such problem");
    print_means(&t, out);
    return STATUS_OK;
}
