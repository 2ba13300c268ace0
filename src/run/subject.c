#include "run/subject.h"

#include <ctype.h>
#include <math.h>
#include <omp.h>
#include <stdlib.h>
#include <string.h>

#include "base/random.h"
#include "problem/external.h"
#include "problem/textbook.h"
#include "run/measures.h"

enum { LIMITS_MAX = 32 };

typedef struct {
    size_t objective;
    double sign, bound; /* sign (value - bound) <= 0 */
} Limit;

struct Subject {
    Settings settings;
    Schema schema;
    Problem problem;
    double *lower, *upper; /* (n_var) */
    int threads;

    World world; /* of a tower */
    Crew *crew;
    External *external;
    size_t n_noisy; /* textbook answers given: the name of the next one's noise */

    size_t n_limits;
    Limit limit[LIMITS_MAX];

    Verdict *verdict;
    size_t n_verdicts, verdicts_max;
};

const Problem *subject_problem(const Subject *subject)
{
    return &subject->problem;
}

const Schema *subject_schema(const Subject *subject)
{
    return &subject->schema;
}

const World *subject_world(const Subject *subject)
{
    return subject->crew ? &subject->world : NULL;
}

Crew *subject_crew(const Subject *subject)
{
    return subject->crew;
}

int subject_threads(const Subject *subject)
{
    return subject->threads;
}

const Verdict *subject_verdicts(const Subject *subject, size_t *n)
{
    *n = subject->n_verdicts;
    return subject->verdict;
}

void subject_forget(Subject *subject)
{
    subject->n_verdicts = 0;
}

static Status room_for(Subject *s, size_t more, Err *err)
{
    const size_t need = s->n_verdicts + more;
    if (need <= s->verdicts_max)
        return STATUS_OK;
    Verdict *wider = realloc(s->verdict, 2 * need * sizeof *wider);
    if (!wider)
        return fail(err, STATUS_NO_MEMORY, "no memory for %zu verdicts", 2 * need);
    s->verdict = wider;
    s->verdicts_max = 2 * need;
    return STATUS_OK;
}

/* -- the three kinds of simulation: natural values into F -----------------------------------------------------------
 */

static void judge_tower(const SimResult *r, double f[], unsigned char *ok, Verdict *v)
{
    *ok = (unsigned char)measure_objectives(r, f);
    const int lost = r->outcome == RUN_OK && !*ok;
    verdict_set(v, outcome_word(lost ? RUN_NOT_FINITE : r->outcome), lost ? "an objective is not finite" : r->reason);
    for (int k = 0; k < N_OBJECTIVES; k++)
        f[k] = measure_value(r, k);
    for (int k = N_OBJECTIVES; k < N_MEASURES; k++)
        v->extra[k - N_OBJECTIVES] = measure_value(r, k);
}

static Status run_tower(Subject *s, size_t n, const double X[], double F[], unsigned char ok[], Err *err)
{
    SimTask *tasks = calloc(n, sizeof *tasks);
    SimResult *results = calloc(n, sizeof *results);
    Status status = tasks && results ? STATUS_OK : fail(err, STATUS_NO_MEMORY, "no memory for %zu simulations", n);
    for (size_t i = 0; status == STATUS_OK && i < n; i++)
        tasks[i] = (SimTask){SCENE_IMPACT, &X[i * s->schema.n_var]};
    if (status == STATUS_OK)
        status = crew_run(s->crew, n, tasks, results, err);
    for (size_t i = 0; status == STATUS_OK && i < n; i++)
        judge_tower(&results[i], &F[i * N_OBJECTIVES], &ok[i], &s->verdict[s->n_verdicts + i]);
    free(tasks);
    free(results);
    return status;
}

static Status run_external(Subject *s, size_t n, const double X[], double F[], unsigned char ok[], Err *err)
{
    Answer *answers = calloc(n, sizeof *answers);
    if (!answers)
        return fail(err, STATUS_NO_MEMORY, "no memory for %zu answers", n);
    const Status status = external_run(s->external, n, X, F, answers, err);
    for (size_t i = 0; status == STATUS_OK && i < n; i++) {
        ok[i] = answers[i].outcome == ANSWER_OK;
        verdict_set(&s->verdict[s->n_verdicts + i], answer_word(answers[i].outcome), answers[i].reason);
        for (size_t k = 0; !ok[i] && k < s->schema.n_obj; k++)
            F[i * s->schema.n_obj + k] = NAN;
    }
    free(answers);
    return status;
}

void subject_exact(const Subject *s, const double x[], double f[])
{
    const size_t n_var = s->schema.n_var, m = s->schema.n_obj;
    if (s->settings.problem.kind == PROBLEM_DTLZ2)
        textbook_dtlz2(n_var, m, x, f);
    else
        textbook_wfg4(n_var, m, textbook_wfg4_position(n_var, m), x, f);
}

static Status run_textbook(Subject *s, size_t n, const double X[], double F[], unsigned char ok[])
{
    const size_t m = s->schema.n_obj;
    for (size_t i = 0; i < n; i++) {
        double *f = F + i * m;
        Random noise = random_stream((uint32_t)s->settings.search.seed, RANDOM_NOISE, 0, (uint32_t)s->n_noisy++);
        subject_exact(s, X + i * s->schema.n_var, f);
        for (size_t k = 0; s->settings.problem.noise > 0.0 && k < m; k++)
            f[k] *= 1.0 + s->settings.problem.noise * random_normal(&noise);
        ok[i] = 1;
        verdict_set(&s->verdict[s->n_verdicts + i], "ok", "");
    }
    return STATUS_OK;
}

static void apply_limits(const Subject *s, const double natural[], double g[])
{
    for (size_t c = 0; c < s->n_limits; c++) {
        const Limit *l = &s->limit[c];
        g[c] = l->sign * (natural[l->objective] - l->bound) / (l->bound != 0.0 ? fabs(l->bound) : 1.0);
    }
}

static Status evaluate(size_t n, const double X[], double F[], double G[], unsigned char ok[], void *user, Err *err)
{
    Subject *s = user;
    const size_t m = s->schema.n_obj;
    TRY(room_for(s, n, err));
    if (s->crew)
        TRY(run_tower(s, n, X, F, ok, err));
    else if (s->external)
        TRY(run_external(s, n, X, F, ok, err));
    else
        TRY(run_textbook(s, n, X, F, ok));
    s->n_verdicts += n;
    for (size_t i = 0; i < n; i++) {
        apply_limits(s, F + i * m, G + i * s->n_limits);
        for (size_t k = 0; k < m; k++)
            F[i * m + k] *= schema_objective(&s->schema, k)->sense;
    }
    return STATUS_OK;
}

/* Swapping keeps both thicknesses in the box and the sample spread out; clipping would pile designs up on
 * t_top = t_base. */
static void swap_if_top_heavy(double x[], void *user)
{
    const Subject *s = user;
    double *t_base = &x[s->schema.n_var - 2], *t_top = t_base + 1;
    if (*t_top > *t_base) {
        const double thicker = *t_top;
        *t_top = *t_base;
        *t_base = thicker;
    }
}

/* -- opening --------------------------------------------------------------------------------------------------------
 */

static Status open_tower(Subject *s, Err *err)
{
    const Settings *t = &s->settings;
    TRY(world_open(&s->world, t, err));
    TRY(crew_create(&s->crew, s->world.scene, s->threads, err));
    return schema_of(&s->schema, t, scene_n_floors(s->world.scene), err);
}

static Status open_external(Subject *s, Err *err)
{
    TRY(schema_of(&s->schema, &s->settings, 0, err));
    return external_open(&s->external, s->settings.problem.command, (size_t)s->threads, s->settings.problem.timeout_s,
                         s->schema.n_var, s->schema.n_obj, err);
}

static Status open_textbook(Subject *s, Err *err)
{
    const long n_var = s->settings.problem.variables, m = s->settings.problem.objectives;
    if (n_var > TEXTBOOK_VAR_MAX || m > TEXTBOOK_OBJ_MAX)
        return fail(err, STATUS_BAD_DATA, "problem.variables: a textbook problem has at most %d, and %d objectives",
                    TEXTBOOK_VAR_MAX, TEXTBOOK_OBJ_MAX);
    if (m < 2 || n_var < m)
        return fail(err, STATUS_BAD_DATA,
                    "problem.objectives: a textbook problem wants 2 at least and no more than %ld", n_var);
    return schema_of(&s->schema, &s->settings, 0, err);
}

/* Number of each of n variables: one for all, or a list. */
static Status take_bounds(const char *key, const char *list, size_t n, double bounds[], Err *err)
{
    const size_t count = list_count(list);
    char word[64], *end;
    if (count != 1 && count != n)
        return fail(err, STATUS_BAD_DATA, "%s: %zu numbers for %zu variables", key, count, n);
    for (size_t j = 0; j < n; j++) {
        if (!list_item(list, count == 1 ? 0 : j, word, sizeof word))
            return fail(err, STATUS_BAD_DATA, "%s: number %zu is missing", key, j + 1);
        bounds[j] = strtod(word, &end);
        if (end == word || *end || !isfinite(bounds[j]))
            return fail(err, STATUS_BAD_DATA, "%s: '%s' is not a number", key, word);
    }
    return STATUS_OK;
}

static Status set_bounds(Subject *s, Err *err)
{
    const Settings *t = &s->settings;
    const size_t n = s->schema.n_var;
    for (size_t j = 0; j < n; j++) {
        s->lower[j] = !s->crew ? 0.0 : j + 2 < n ? t->design.gap_min_m : t->design.thickness_min_m;
        s->upper[j] = t->problem.kind == PROBLEM_WFG4 ? 2.0 * (double)(j + 1)
                      : !s->crew                      ? 1.0
                      : j + 2 < n                     ? t->design.gap_max_m
                                                      : t->design.thickness_max_m;
    }
    if (!s->external)
        return STATUS_OK;
    TRY(take_bounds("problem.lower", t->problem.lower, n, s->lower, err));
    TRY(take_bounds("problem.upper", t->problem.upper, n, s->upper, err));
    for (size_t j = 0; j < n; j++)
        if (s->lower[j] > s->upper[j])
            return fail(err, STATUS_BAD_DATA, "problem.lower: %g is above problem.upper = %g (variable %zu)",
                        s->lower[j], s->upper[j], j + 1);
    return STATUS_OK;
}

static Status take_limit(Subject *s, const char *text, Err *err)
{
    char name[TABLE_NAME_MAX], *end;
    const char *relation = strpbrk(text, "<>");
    if (!relation || relation[1] != '=' || relation - text >= TABLE_NAME_MAX)
        return fail(err, STATUS_BAD_DATA, "search.limits: '%.60s' is not NAME<=NUMBER or NAME>=NUMBER", text);
    snprintf(name, sizeof name, "%.*s", (int)(relation - text), text);
    for (char *last = name + strlen(name); last > name && isspace((unsigned char)last[-1]);)
        *--last = 0;
    Limit *l = &s->limit[s->n_limits++];
    TRY(schema_pick_objective(&s->schema, "search.limits", name, STATUS_BAD_DATA, &l->objective, err));
    l->sign = *relation == '<' ? 1.0 : -1.0;
    l->bound = strtod(relation + 2, &end);
    if (end == relation + 2 || *end || !isfinite(l->bound))
        return fail(err, STATUS_BAD_DATA, "search.limits: '%.60s': no number behind %c=", text, *relation);
    return STATUS_OK;
}

static Status take_limits(Subject *s, Err *err)
{
    const char *list = s->settings.search.limits;
    char text[128];
    if (strcmp(list, "none") == 0)
        return STATUS_OK;
    if (list_count(list) > LIMITS_MAX)
        return fail(err, STATUS_BAD_DATA, "search.limits: more than %d", LIMITS_MAX);
    for (size_t i = 0; i < list_count(list); i++) {
        if (!list_item(list, i, text, sizeof text))
            return fail(err, STATUS_BAD_DATA, "search.limits: item %zu is empty or too long", i + 1);
        TRY(take_limit(s, text, err));
    }
    return STATUS_OK;
}

static Status open_kind(Subject *s, Err *err)
{
    switch (s->settings.problem.kind) {
    case PROBLEM_TOWER:
        return open_tower(s, err);
    case PROBLEM_EXTERNAL:
        return open_external(s, err);
    default:
        return open_textbook(s, err);
    }
}

static Status open(Subject *s, Err *err)
{
    TRY(open_kind(s, err));
    s->lower = calloc(2 * s->schema.n_var, sizeof *s->lower);
    if (!s->lower)
        return fail(err, STATUS_NO_MEMORY, "no memory for %zu variables", s->schema.n_var);
    s->upper = s->lower + s->schema.n_var;
    TRY(set_bounds(s, err));
    TRY(take_limits(s, err));
    s->problem = (Problem){
        .n_var = s->schema.n_var,
        .n_obj = s->schema.n_obj,
        .n_con = s->n_limits,
        .lower = s->lower,
        .upper = s->upper,
        .evaluate = evaluate,
        .repair = s->crew ? swap_if_top_heavy : NULL,
        .user = s,
    };
    return STATUS_OK;
}

Status subject_open(Subject **out, const Settings *settings, Err *err)
{
    Subject *s = calloc(1, sizeof *s);
    *out = NULL;
    if (!s)
        return fail(err, STATUS_NO_MEMORY, "no memory for a study");
    s->settings = *settings;
    s->threads = settings->search.threads > 0 ? (int)settings->search.threads : omp_get_num_procs();
    const Status status = open(s, err);
    if (status == STATUS_OK)
        *out = s;
    else
        subject_close(s);
    return status;
}

void subject_close(Subject *s)
{
    if (!s)
        return;
    external_close(s->external);
    crew_free(s->crew);
    world_close(&s->world);
    schema_free(&s->schema);
    free(s->lower);
    free(s->verdict);
    free(s);
}
