#include "simulator/subject.h"

#include <ctype.h>
#include <math.h>
#include <omp.h>
#include <stdlib.h>
#include <string.h>

#include "base/carve.h"
#include "base/random.h"
#include "moga/constants.h"
#include "moga/dominance.h"
#include "moga/search.h"
#include "simulator/external.h"
#include "simulator/textbook.h"
#include "simulator/measures.h"
#include "settings/settings.h"

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

    Trials *trials; /* of a tower */
    Crew *crew;     /* its own */
    External *external;
    size_t n_done; /* simulations asked for: the number of the next design is one more */
    long n_asked;  /* of a stream: requests; n_done are then the designs that are done */
    Observer observer;

    size_t n_limits;
    Limit limit[LIMITS_MAX];
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
    return subject->trials ? trials_world(subject->trials) : NULL;
}

size_t subject_n_records(const Subject *subject)
{
    return subject->trials ? trials_n_records(subject->trials) : 0;
}

const World *subject_record(const Subject *subject, size_t i)
{
    return trials_record(subject->trials, i);
}

Crew *subject_crew(const Subject *subject)
{
    return subject->crew;
}

int subject_threads(const Subject *subject)
{
    return subject->threads;
}

void subject_observe(Subject *subject, const Observer *observer, size_t n_done)
{
    subject->observer = *observer;
    subject->n_done = n_done;
    subject->n_asked = (long)n_done;
}

/* What is to be simulated of one batch, close together. */
typedef struct {
    Subject *subject;
    size_t n;
    size_t *place;    /* (n) in the batch of the search */
    long *number;     /* (n) of the designs */
    size_t *draws;    /* (n) answers that there are already */
    double *X, *F;    /* (n, n_var) (n, n_obj) natural */
    double *spread;   /* (n, n_obj) NAN where not known */
    Verdict *verdict; /* (n) */
    const void *raw;  /* (n) what the simulator gave: Trial or Answer */
    void *store;
} Work;

static void layout(Work *w, size_t n, Carve *c)
{
    w->place = carve(c, n, sizeof *w->place);
    w->number = carve(c, n, sizeof *w->number);
    w->draws = carve(c, n, sizeof *w->draws);
    w->X = carve(c, n * w->subject->schema.n_var, sizeof *w->X);
    w->F = carve(c, n * w->subject->schema.n_obj, sizeof *w->F);
    w->spread = carve(c, n * w->subject->schema.n_obj, sizeof *w->spread);
    w->verdict = carve(c, n, sizeof *w->verdict);
}

static Status work_create(Work *w, Subject *s, size_t n, Err *err)
{
    Carve c = {0};
    *w = (Work){.subject = s};
    layout(w, n, &c);
    w->store = carve_store(&c);
    if (!w->store)
        return fail(err, STATUS_NO_MEMORY, "no memory for %zu simulations", n);
    layout(w, n, &(Carve){.base = w->store});
    for (size_t i = 0; i < n * s->schema.n_obj; i++)
        w->spread[i] = NAN;
    return STATUS_OK;
}

static int is_ok(const Verdict *v)
{
    return strcmp(v->outcome, "ok") == 0;
}

static void apply_limits(const Subject *s, const double natural[], double g[])
{
    for (size_t c = 0; c < s->n_limits; c++) {
        const Limit *l = &s->limit[c];
        g[c] = l->sign * (natural[l->objective] - l->bound) / (l->bound != 0.0 ? fabs(l->bound) : 1.0);
    }
}

/* Simulation i of the work is done: failed ones have no objectives, and the observer hears of it. */
static Status tell(const Work *w, size_t i, Err *err)
{
    const Subject *s = w->subject;
    double *f = w->F + i * s->schema.n_obj, g[LIMITS_MAX];
    const int ok = is_ok(&w->verdict[i]);
    for (size_t k = 0; !ok && k < s->schema.n_obj; k++)
        f[k] = NAN;
    if (!s->observer.done)
        return STATUS_OK;
    apply_limits(s, f, g);
    const Simulation simulation = {
        .number = (size_t)w->number[i],
        .x = w->X + i * s->schema.n_var,
        .f = f,
        .spread = w->spread + i * s->schema.n_obj,
        .violation = ok ? violation_of(s->n_limits, g) : INFINITY,
        .ok = ok,
        .verdict = &w->verdict[i],
    };
    return s->observer.done(&simulation, s->observer.user, err);
}

/* -- the three kinds of simulation: natural values into F ---------------------------------------------------------- */

static void judge_tower(const Trial *t, double f[], double spread[], Verdict *v)
{
    const SimResult *r = &t->result;
    double unused[N_OBJECTIVES];
    const int lost = !measure_objectives(r, unused) && r->outcome == RUN_OK;
    verdict_set(v, outcome_word(lost ? OUTCOME_NOT_FINITE : measure_outcome(r->outcome)),
                lost ? "an objective is not finite" : r->reason);
    memcpy(f, t->value, N_OBJECTIVES * sizeof *f);
    memcpy(spread, t->spread, N_OBJECTIVES * sizeof *spread);
    memcpy(v->extra, t->value + N_OBJECTIVES, (N_MEASURES - N_OBJECTIVES) * sizeof *v->extra);
    v->seconds = t->seconds;
}

static Status tower_done(size_t i, void *user, Err *err)
{
    const Work *w = user;
    judge_tower((const Trial *)w->raw + i, w->F + i * N_OBJECTIVES, w->spread + i * N_OBJECTIVES, &w->verdict[i]);
    return tell(w, i, err);
}

static int may_go_on(void *user)
{
    const Work *w = user;
    const Observer *o = &w->subject->observer;
    return !o->go_on || o->go_on(o->user);
}

static Status run_tower(Work *w, Err *err)
{
    Trial *trials = calloc(w->n, sizeof *trials);
    const Watch watch = {may_go_on, tower_done, w};
    if (!trials)
        return fail(err, STATUS_NO_MEMORY, "no memory for %zu designs", w->n);
    w->raw = trials;
    const Status status = trials_run(w->subject->trials, w->n, w->X, w->draws, trials, &watch, err);
    free(trials);
    return status;
}

static void judge_answer(const Answer *a, Verdict *v)
{
    verdict_set(v, answer_word(a->outcome), a->reason);
    v->seconds = a->seconds;
}

static Status answer_came(size_t i, void *user, Err *err)
{
    const Work *w = user;
    judge_answer((const Answer *)w->raw + i, &w->verdict[i]);
    return tell(w, i, err);
}

static Status run_external(Work *w, Err *err)
{
    Answer *answers = calloc(w->n, sizeof *answers);
    const Watch watch = {may_go_on, answer_came, w};
    if (!answers)
        return fail(err, STATUS_NO_MEMORY, "no memory for %zu answers", w->n);
    w->raw = answers;
    const Status status = external_run(w->subject->external, w->n, w->X, w->number, w->F, answers, &watch, err);
    free(answers);
    return status;
}

static const Textbook *textbook_of(const Subject *s)
{
    return textbook((size_t)(s->settings.problem.kind - PROBLEM_TEXTBOOK));
}

void subject_exact(const Subject *s, const double x[], double f[])
{
    textbook_of(s)->evaluate(s->schema.n_var, s->schema.n_obj, x, f);
}

static void answer_textbook(const Work *w, size_t i)
{
    const Subject *s = w->subject;
    const size_t m = s->schema.n_obj;
    double *f = w->F + i * m;
    Random noise = random_stream((uint32_t)s->settings.search.seed, RANDOM_NOISE, 0, (uint32_t)(w->number[i] - 1));
    subject_exact(s, w->X + i * s->schema.n_var, f);
    for (size_t k = 0; s->settings.problem.noise > 0.0 && k < m; k++)
        f[k] *= 1.0 + s->settings.problem.noise * random_normal(&noise);
    verdict_set(&w->verdict[i], "ok", "");
}

static Status run_textbook(Work *w, Err *err)
{
    for (size_t i = 0; i < w->n; i++) {
        if (!may_go_on(w))
            return fail(err, STATUS_STOPPED, "stopped");
        answer_textbook(w, i);
        TRY(tell(w, i, err));
    }
    return STATUS_OK;
}

static Status run_kind(Work *w, Err *err)
{
    return w->n == 0              ? STATUS_OK
           : w->subject->crew     ? run_tower(w, err)
           : w->subject->external ? run_external(w, err)
                                  : run_textbook(w, err);
}

void subject_judge(const Subject *s, size_t n, const double natural[], double F[], double G[])
{
    const size_t m = s->schema.n_obj;
    for (size_t i = 0; i < n; i++) {
        apply_limits(s, natural + i * m, G + i * s->n_limits);
        for (size_t k = 0; k < m; k++)
            F[i * m + k] = schema_objective(&s->schema, k)->sense * natural[i * m + k];
    }
}

/* Designs that are known from before get their answers at once, the others are work to do. */
static void sort_out(Work *w, size_t n, const double X[], const size_t draws[], double F[], unsigned char ok[])
{
    const Subject *s = w->subject;
    const Observer *o = &s->observer;
    const size_t n_var = s->schema.n_var, m = s->schema.n_obj;
    for (size_t i = 0; i < n; i++) {
        Verdict v;
        const size_t number = s->n_done + i + 1;
        if (o->recall && o->recall(number, X + i * n_var, F + i * m, &v, o->user)) {
            ok[i] = (unsigned char)is_ok(&v);
            continue;
        }
        memcpy(w->X + w->n * n_var, X + i * n_var, n_var * sizeof *X);
        w->number[w->n] = (long)number;
        w->draws[w->n] = draws ? draws[i] : 0;
        w->place[w->n++] = i;
    }
}

static Status evaluate(size_t n, const double X[], const size_t draws[], double F[], double G[], unsigned char ok[],
                       void *user, Err *err)
{
    Subject *s = user;
    const size_t m = s->schema.n_obj;
    Work w;
    TRY(work_create(&w, s, n, err));
    sort_out(&w, n, X, draws, F, ok);
    const Status status = run_kind(&w, err);
    for (size_t i = 0; status == STATUS_OK && i < w.n; i++) {
        ok[w.place[i]] = (unsigned char)is_ok(&w.verdict[i]);
        memcpy(F + w.place[i] * m, w.F + i * m, m * sizeof *F);
    }
    free(w.store);
    TRY(status);
    s->n_done += n;
    subject_judge(s, n, F, F, G);
    return STATUS_OK;
}

/* -- one by one, every thread for itself --------------------------------------------------------------------------- */

/* What ends a stream: the first fault, a stop only where there is none. */
typedef struct {
    Status status;
    Err *err;
} End;

static void note_end(End *end, Feed *feed, Status status, const Err *mine)
{
#pragma omp critical(subject_end)
    if (end->status == STATUS_OK || end->status == STATUS_STOPPED)
        end->status = fail(end->err, status, "%s", mine->text);
    feed_close(feed);
}

/* The design of w by this thread's own simulator. */
static Status simulate_one(Work *w, int thread, Err *err)
{
    Subject *s = w->subject;
    const Watch watch = {may_go_on, NULL, w};
    Trial trial;
    Answer answer;
    if (s->crew) {
        TRY(trials_run_alone(s->trials, thread, w->X, w->draws[0], &trial, &watch, err));
        judge_tower(&trial, w->F, w->spread, &w->verdict[0]);
    } else if (s->external) {
        TRY(external_ask(s->external, (size_t)thread, w->X, w->number[0], w->F, &answer, &watch, err));
        judge_answer(&answer, &w->verdict[0]);
    } else {
        answer_textbook(w, 0);
    }
    return STATUS_OK;
}

/* Designs are numbered as they are done. */
static Status hand_in(Work *w, Feed *feed, size_t name, Err *err)
{
    Subject *s = w->subject;
    double F[OBJECTIVES_MAX], G[LIMITS_MAX];
    w->number[0] = (long)++s->n_done;
    TRY(tell(w, 0, err));
    subject_judge(s, 1, w->F, F, G);
    feed_give(feed, name, F, G, is_ok(&w->verdict[0]));
    return STATUS_OK;
}

static Status work_on(Work *w, Feed *feed, int thread, Err *err)
{
    Subject *s = w->subject;
    for (size_t name; (name = feed_take(feed, w->X, w->draws)) != SIZE_MAX;) {
        Status status;
        if (!may_go_on(w))
            return fail(err, STATUS_STOPPED, "stopped");
#pragma omp atomic capture
        w->number[0] = ++s->n_asked;
        TRY(simulate_one(w, thread, err));
#pragma omp critical(subject_done)
        status = hand_in(w, feed, name, err);
        TRY(status);
    }
    return STATUS_OK;
}

static Status stream(Feed *feed, void *user, Err *err)
{
    Subject *s = user;
    End end = {.err = err};
#pragma omp parallel num_threads((int)s->problem.n_workers)
    {
        Work w;
        Err mine = {0};
        Status status = work_create(&w, s, 1, &mine);
        if (status == STATUS_OK)
            status = work_on(&w, feed, omp_get_thread_num(), &mine);
        if (status != STATUS_OK)
            note_end(&end, feed, status, &mine);
        free(w.store);
    }
    return end.status;
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

/* -- opening ------------------------------------------------------------------------------------------------------- */

static Status open_tower(Subject *s, Err *err)
{
    const Settings *t = &s->settings;
    TRY(trials_open(&s->trials, t, s->threads, err));
    s->crew = trials_crew(s->trials);
    return schema_of(&s->schema, t, scene_n_floors(trials_world(s->trials)->scene), err);
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
        s->upper[j] = j + 2 < n ? t->design.gap_max_m : t->design.thickness_max_m;
        if (t->problem.kind >= PROBLEM_TEXTBOOK)
            s->upper[j] = textbook_upper(textbook_of(s), j);
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

/* Where a front asks for repeats, there must be simulations enough to bring them. */
static Status check_repeats(const Subject *s, Err *err)
{
    const double share = s->settings.search.replicate_share, wanted = (double)(s->settings.search.replicates_min - 1);
    if (!schema_is_noisy(&s->settings) ||
        floor(search_replicates((size_t)s->settings.search.max_evals, share, s->schema.n_var)) >= wanted)
        return STATUS_OK;
    return fail(
        err, STATUS_BAD_DATA,
        "search.replicates_min: %ld simulations of a design are not to be had, repeats begin behind the first %zu; "
        "search.max_evals must be %.0f at least",
        s->settings.search.replicates_min, REPLICATE_AFTER * s->schema.n_var,
        ceil(wanted / share) + (double)(REPLICATE_AFTER * s->schema.n_var));
}

/* No number keeps both of two limits of one objective where the least wanted is above the most. */
static Status check_limits(const Subject *s, Err *err)
{
    for (size_t a = 0; a < s->n_limits; a++)
        for (size_t b = 0; b < s->n_limits; b++) {
            const Limit *most = &s->limit[a], *least = &s->limit[b];
            if (most->objective == least->objective && most->sign > 0.0 && least->sign < 0.0 &&
                least->bound > most->bound)
                return fail(err, STATUS_BAD_DATA, "search.limits: %s<=%g and >=%g contradict each other",
                            schema_objective(&s->schema, most->objective)->name, most->bound, least->bound);
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
    TRY(check_limits(s, err));
    TRY(check_repeats(s, err));
    s->problem = (Problem){
        .n_var = s->schema.n_var,
        .n_obj = s->schema.n_obj,
        .n_con = s->n_limits,
        .lower = s->lower,
        .upper = s->upper,
        .evaluate = evaluate,
        .stream = stream,
        .n_workers = s->crew || s->external ? (size_t)s->threads : 1,
        .repair = s->crew ? swap_if_top_heavy : NULL,
        .user = s,
        .is_noisy = schema_is_noisy(&s->settings),
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
    trials_close(s->trials);
    schema_free(&s->schema);
    free(s->lower);
    free(s);
}
