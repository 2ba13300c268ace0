#include <unistd.h>

#include "api/handle.h"
#include "api/search_config.h"
#include "evaluate/limits.h"
#include "evaluate/tasks.h"
#include "moga/archive.h"

enum { STARTS_MAX = 1000000 };

/* -- making one ---------------------------------------------------------------------------------------------------- */

static void judge(const Evaluation *e, double f[], double g[], const void *user)
{
    const imtet_search *s = user;
    for (size_t k = 0; k < s->schema.n_obj; k++)
        f[k] = schema_objective(&s->schema, k)->sense * e->f[k];
    for (size_t c = 0; c < s->schema.n_extra; c++)
        g[c] = e->extra[c];
}

static Status make_room(imtet_search *s, Err *err)
{
    const size_t n_var = s->settings.problem.variables;
    TRY_ROOM(s->lower, (2 + s->n_given) * n_var, "a search", err);
    TRY_ROOM(s->kind, n_var, "a search", err);
    s->upper = s->lower + n_var;
    s->given = s->upper + n_var;
    return schema_of(&s->schema, &s->settings, 0, err);
}

Status handle_create(imtet_search **out, const Settings *settings, size_t n_given, Err *err)
{
    imtet_search *s;
    const ProblemOptions *o = &settings->problem;
    *out = NULL;
    TRY(settings_check(settings, err));
    TRY_ROOM(s, 1, "a search", err);
    s->settings = *settings;
    s->process = getpid();
    s->n_given = n_given;
    pthread_mutex_init(&s->lock, NULL);
    s->asking.problem =
        (Problem){.n_var = o->variables, .n_obj = o->objectives, .n_con = o->constraints, .n_extra = o->constraints};
    asking_init(&s->asking);
    const Status status = make_room(s, err);
    if (status == STATUS_OK)
        *out = s;
    else
        handle_free(s);
    return status;
}

Status handle_open(imtet_search *s, Err *err)
{
    Asking *a = &s->asking;
    const size_t n_var = s->schema.n_var;
    for (size_t j = 0; j < n_var; j++)
        if (!isfinite(s->lower[j]) || !isfinite(s->upper[j]) || s->lower[j] > s->upper[j])
            return bad_data(err, "variable %zu has the bounds %g and %g; give finite ones, the lower one first", j + 1,
                            s->lower[j], s->upper[j]);
    TRY(kinds_read(s->settings.problem.kinds, n_var, s->kind, s->lower, s->upper, err));
    TRY(aspirations_read(&a->problem.aspire, s->aspire, &s->schema, s->settings.search.aspire, err));
    a->config = search_config_of(&s->settings);
    a->config.given = s->given;
    a->config.n_given = s->n_given;
    a->threads = threads_wanted(s->settings.search.threads);
    a->problem.lower = s->lower;
    a->problem.upper = s->upper;
    a->problem.kind = kinds_are_real(s->settings.problem.kinds) ? NULL : s->kind;
    a->problem.judge = judge;
    a->problem.user = s;
    return asking_open(a, err);
}

void handle_free(imtet_search *s)
{
    if (!s)
        return;
    asking_close(&s->asking);
    pthread_mutex_destroy(&s->lock);
    schema_free(&s->schema);
    free(s->lower);
    free(s->kind);
    free(s);
}

static const char *const KEYS[] = {"search.max_evals",    "search.seed",      "search.population",
                                   "search.initial",      "search.max_hours", "search.stop_after",
                                   "search.failures_max", "search.surrogate", "search.nondominated_share",
                                   "search.threads",      "search.aspire",    "search.ahead"};

/* The others are of runs, towers, or of evaluations that answer differently each time. */
static Status take_settings(Settings *s, const char *const list[], Err *err)
{
    char key[64];
    for (size_t i = 0; list && list[i]; i++) {
        size_t k = 0;
        snprintf(key, sizeof key, "%.*s", (int)strcspn(list[i], "="), list[i]);
        while (k < N_OF(KEYS) && strcmp(key, KEYS[k]) != 0)
            k++;
        if (k == N_OF(KEYS))
            return fail_no_word(err, STATUS_BAD_DATA, "settings", key, "setting of a search that is asked and told",
                                KEYS, N_OF(KEYS));
    }
    return api_settings(s, list, err);
}

static Status put_count(Settings *s, const char *key, size_t n, Err *err)
{
    char text[32];
    snprintf(text, sizeof text, "%zu", n);
    return settings_put(s, key, text, err);
}

static Status settings_of(const imtet_search_options *o, Settings *s, Err *err)
{
    settings_defaults(s);
    TRY(settings_put(s, "problem.kind", "external", err));
    TRY(settings_put(s, "problem.command", "ask and tell", err));
    TRY(put_count(s, "problem.variables", o->variables, err));
    TRY(put_count(s, "problem.objectives", o->objectives, err));
    TRY(settings_put(s, "problem.kinds", o->kinds ? o->kinds : "real", err));
    TRY(settings_put(s, "problem.senses", o->senses ? o->senses : "min", err));
    if (o->constraints > CONSTRAINTS_MAX)
        return bad_data(err, "constraints: %zu are more than %d", o->constraints, CONSTRAINTS_MAX);
    s->problem.constraints = (long)o->constraints;
    return take_settings(s, o->settings, err);
}

/* Bounds and first designs as they are given; 0 and 1 without. */
static Status take_numbers(imtet_search *s, const imtet_search_options *o, Err *err)
{
    const size_t n = o->variables;
    for (size_t j = 0; j < n; j++) {
        s->lower[j] = o->lower ? o->lower[j] : 0.0;
        s->upper[j] = o->upper ? o->upper[j] : 1.0;
    }
    TRY(api_check_finite("start", o->starts * n, o->start, "give designs to begin with", err));
    for (size_t i = 0; i < o->starts * n; i++)
        if (kinds_are_whole(s->settings.problem.kinds, i % n) && o->start[i] != floor(o->start[i]))
            return misused(err, "start: variable %zu of design %zu is %g; it is a whole number (kinds)", i % n + 1,
                           i / n + 1, o->start[i]);
    if (o->starts > 0)
        memcpy(s->given, o->start, o->starts * n * sizeof *o->start);
    return handle_open(s, err);
}

static Status create(const imtet_search_options *o, imtet_search **out, Err *err)
{
    Settings settings;
    if (!out || !o)
        return misused(err, "imtet_search_create: %s is NULL", out ? "options" : "out");
    *out = NULL;
    if (o->size != sizeof *o)
        return misused(err, "imtet_search_create: options.size is %zu, wanted sizeof options, %zu", o->size, sizeof *o);
    if ((o->starts > 0 && !o->start) || o->starts > STARTS_MAX)
        return misused(err, "imtet_search_create: %zu starts are more than %d, or start is NULL", o->starts,
                       STARTS_MAX);
    TRY(settings_of(o, &settings, err));
    TRY(handle_create(out, &settings, o->starts, err));
    const Status status = take_numbers(*out, o, err);
    if (status != STATUS_OK) {
        handle_free(*out);
        *out = NULL;
    }
    return status;
}

imtet_status imtet_search_create(const imtet_search_options *options, imtet_search **out, imtet_error *error)
{
    Err err = {0};
    return api_status(create(options, out, &err), &err, error);
}

void imtet_search_free(imtet_search **search)
{
    if (search && *search && (*search)->process == getpid())
        handle_free(*search);
    if (search)
        *search = NULL;
}

/* -- calls on one -------------------------------------------------------------------------------------------------- */

typedef Status (*CallFn)(imtet_search *s, const void *arguments, Err *err);

/* The one way into a search and out of it. */
static imtet_status call(imtet_search *s, CallFn fn, const void *arguments, imtet_error *error)
{
    Err err = {0};
    if (!s)
        return api_status(misused(&err, "the search is NULL: not made, or freed"), &err, error);
    if (s->process != getpid())
        return api_status(misused(&err,
                                  "the search belongs to process %ld, of which this one is a fork; load a saved one",
                                  (long)s->process),
                          &err, error);
    pthread_mutex_lock(&s->lock);
    const Status status = fn(s, arguments, &err);
    pthread_mutex_unlock(&s->lock);
    return api_status(status, &err, error);
}

/* Said once: who calls again wants to go on. */
static Status check_failures(imtet_search *s, Err *err)
{
    const size_t most = (size_t)s->settings.search.failures_max, failing = s->failing;
    if (most == 0 || failing < most)
        return STATUS_OK;
    s->failing = 0;
    return fail(err, STATUS_INTERNAL,
                "the last %zu designs failed (search.failures_max), the last one: %s; mend what is wrong and ask again",
                failing, s->asking.table.row[s->failed].reason);
}

typedef struct {
    size_t n;
    long *ids;
    double *X;
    size_t *found;
} Portion;

static Status ask(imtet_search *s, const void *arguments, Err *err)
{
    const Portion *t = arguments;
    Asking *a = &s->asking;
    const size_t n_var = s->schema.n_var;
    if (!t->found || (t->n > 0 && (!t->ids || !t->X)))
        return misused(err, "imtet_search_ask: %s is NULL", !t->found ? "found" : !t->ids ? "ids" : "X");
    TRY(check_failures(s, err));
    if (t->n > 0)
        TRY(asking_advance(a, err));
    for (; s->next < a->table.n && *t->found < t->n; s->next++) {
        if (a->design[s->next].place != DESIGN_FREE)
            continue;
        a->design[s->next].place = DESIGN_OUT;
        t->ids[*t->found] = (long)s->next + 1;
        memcpy(t->X + *t->found * n_var, a->table.row[s->next].x, n_var * sizeof *t->X);
        (*t->found)++;
    }
    return STATUS_OK;
}

imtet_status imtet_search_ask(imtet_search *search, size_t n, long ids[], double X[], size_t *found, imtet_error *error)
{
    if (found)
        *found = 0;
    return call(search, ask, &(Portion){n, ids, X, found}, error);
}

typedef struct {
    size_t n;
    const long *ids;
    const double *F, *G;
    const char *const *failed;
} Answers;

static const char *failure_of(const Answers *t, size_t i)
{
    return t->failed ? t->failed[i] : NULL;
}

static size_t last_asked_for(const imtet_search *s)
{
    return MAX_OF(s->next, s->known);
}

static int is_design(const imtet_search *s, long id)
{
    return id >= 1 && (size_t)id <= last_asked_for(s);
}

/* Before anything is changed. */
static Status check_answer(imtet_search *s, const Answers *t, size_t i, Err *err)
{
    static const char CURE[] = "tell that the design failed, and why";
    const size_t n_obj = s->schema.n_obj, n_con = s->schema.n_extra;
    const long id = t->ids[i];
    Asking *a = &s->asking;
    char what[64];
    if (!is_design(s, id))
        return misused(err, "no design has the id %ld; %zu were asked for", id, last_asked_for(s));
    if (a->design[id - 1].place == DESIGN_TOLD || a->design[id - 1].is_named)
        return misused(err, "design %ld is told %s", id, a->design[id - 1].is_named ? "twice" : "already");
    a->design[id - 1].is_named = 1;
    if (failure_of(t, i))
        return evaluation_table_give_room(&a->table.row[id - 1], err);
    if (!t->F || (n_con > 0 && !t->G))
        return misused(err, "design %ld succeeded, but its %s is NULL", id, t->F ? "G" : "F");
    snprintf(what, sizeof what, "F of design %ld", id);
    TRY(api_check_finite(what, n_obj, t->F + i * n_obj, CURE, err));
    what[0] = 'G';
    return n_con > 0 ? api_check_finite(what, n_con, t->G + i * n_con, CURE, err) : STATUS_OK;
}

static Status store_answer(imtet_search *s, const Answers *t, size_t i, Err *err)
{
    Asking *a = &s->asking;
    const size_t n_obj = s->schema.n_obj, n_con = s->schema.n_extra, row = (size_t)t->ids[i] - 1;
    const char *failed = failure_of(t, i);
    Evaluation *e = &a->table.row[row];
    evaluation_set_outcome(e, failed ? OUTCOME_ERROR : OUTCOME_OK,
                           failed && !failed[0] ? "no reason is known" : failed);
    for (size_t k = 0; !failed && k < n_obj; k++)
        e->f[k] = t->F[i * n_obj + k] + 0.0; /* 0 has no sign, as in the run that a study stores */
    for (size_t c = 0; !failed && c < n_con; c++)
        e->extra[c] = t->G[i * n_con + c] + 0.0;
    a->design[row].place = DESIGN_TOLD;
    a->n_told++;
    s->failing = failed ? s->failing + 1 : 0;
    s->failed = row;
    return asking_tell(a, row, err);
}

static Status tell(imtet_search *s, const void *arguments, Err *err)
{
    const Answers *t = arguments;
    size_t n = 0;
    Status status = t->n == 0 || t->ids ? STATUS_OK : misused(err, "imtet_search_tell: ids is NULL");
    while (status == STATUS_OK && n < t->n)
        status = check_answer(s, t, n++, err);
    for (size_t i = 0; i < n; i++)
        if (is_design(s, t->ids[i]))
            s->asking.design[t->ids[i] - 1].is_named = 0;
    for (size_t i = 0; status == STATUS_OK && i < n; i++)
        status = store_answer(s, t, i, err);
    return status;
}

imtet_status imtet_search_tell(imtet_search *search, size_t n, const long ids[], const double F[], const double G[],
                               const char *const failed[], imtet_error *error)
{
    return call(search, tell, &(Answers){n, ids, F, G, failed}, error);
}

/* -- what is known so far ------------------------------------------------------------------------------------------ */

static size_t number_out(const Asking *a)
{
    size_t n = 0;
    for (size_t i = 0; i < a->table.n; i++)
        n += a->design[i].place == DESIGN_OUT;
    return n;
}

static Status look(imtet_search *s, const void *arguments, Err *err)
{
    imtet_search_state *out = (imtet_search_state *)(uintptr_t)arguments;
    Asking *a = &s->asking;
    if (!out || out->size != sizeof *out)
        return misused(err, "imtet_search_look: state.size is no sizeof state, %zu", sizeof *out);
    TRY(asking_advance(a, err));
    const size_t most = (size_t)s->settings.search.max_evals, n_out = number_out(a), spent = a->n_told + n_out;
    *out = (imtet_search_state){.size = sizeof *out,
                                .variables = s->schema.n_var,
                                .objectives = s->schema.n_obj,
                                .constraints = s->schema.n_extra,
                                .told = a->n_told,
                                .under_way = n_out,
                                .left = most > spent && !a->is_over ? most - spent : 0,
                                .done = a->is_over,
                                .why = a->is_over ? stop_reason_words(a->reason) : ""};
    for (size_t i = 0; i < a->table.n; i++)
        out->failed += a->design[i].place == DESIGN_TOLD && a->table.row[i].outcome != OUTCOME_OK;
    return STATUS_OK;
}

imtet_status imtet_search_look(imtet_search *search, imtet_search_state *state, imtet_error *error)
{
    return call(search, look, state, error);
}

/* Every row that is told; on_front of those that are there. */
static Status fill_archive(const imtet_search *s, Archive *archive, Err *err)
{
    const Asking *a = &s->asking;
    double f[OBJECTIVES_MAX], g[CONSTRAINTS_MAX];
    for (size_t i = 0; i < a->table.n; i++) {
        const Evaluation *e = &a->table.row[i];
        const unsigned char ok = e->outcome == OUTCOME_OK;
        if (a->design[i].place != DESIGN_TOLD)
            continue;
        judge(e, f, g, s);
        TRY(pareto_archive_insert(archive, 1, e->x, f, s->schema.n_extra > 0 ? g : NULL, &ok, KIND_SAMPLED, 0, err));
    }
    return STATUS_OK;
}

typedef struct {
    imtet_set which;
    size_t max;
    long *ids;
    double *X, *F, *G;
    size_t *found;
} Wanted;

static void write_row(const Evaluation *e, const Schema *schema, const Wanted *w, size_t n)
{
    const size_t size[] = {schema->n_var, schema->n_obj, schema->n_extra};
    const double *const from[] = {e->x, e->f, e->extra};
    double *const to[] = {w->X, w->F, w->G};
    if (w->ids)
        w->ids[n] = e->id;
    for (size_t k = 0; k < N_OF(size); k++)
        if (to[k] && size[k] > 0)
            memcpy(to[k] + n * size[k], from[k], size[k] * sizeof *to[k]);
}

static Status write_rows(const imtet_search *s, const Wanted *w, Archive *archive, Err *err)
{
    const Asking *a = &s->asking;
    size_t at = 0;
    if (w->which == IMTET_FRONT && a->is_over)
        TRY(evaluation_table_check(&a->table, err));
    if (w->which == IMTET_FRONT)
        TRY(fill_archive(s, archive, err));
    for (size_t i = 0; i < a->table.n; i++) {
        if (a->design[i].place != DESIGN_TOLD || (w->which == IMTET_FRONT && !archive->on_front[at++]))
            continue;
        if (*w->found < w->max)
            write_row(&a->table.row[i], &s->schema, w, *w->found);
        (*w->found)++;
    }
    return STATUS_OK;
}

static Status designs(imtet_search *s, const void *arguments, Err *err)
{
    const Wanted *w = arguments;
    Archive archive = {0};
    if (!w->found || (w->which != IMTET_FRONT && w->which != IMTET_TOLD))
        return misused(err, "imtet_search_designs: %s", w->found ? "`which` is no set" : "found is NULL");
    Status status =
        pareto_archive_init(&archive, s->asking.n_told + 1, s->schema.n_var, s->schema.n_obj, s->schema.n_extra, err);
    if (status == STATUS_OK)
        status = write_rows(s, w, &archive, err);
    pareto_archive_free(&archive);
    return status;
}

imtet_status imtet_search_designs(imtet_search *search, imtet_set which, size_t max, long ids[], double X[], double F[],
                                  double G[], size_t *found, imtet_error *error)
{
    if (found)
        *found = 0;
    return call(search, designs, &(Wanted){which, max, ids, X, F, G, found}, error);
}

/* -- its file ------------------------------------------------------------------------------------------------------ */

static Status save(imtet_search *s, const void *path, Err *err)
{
    return path ? saved_write(s, path, err) : misused(err, "imtet_search_save: path is NULL");
}

imtet_status imtet_search_save(imtet_search *search, const char *path, imtet_error *error)
{
    return call(search, save, path, error);
}

imtet_status imtet_search_load(const char *path, imtet_search **out, imtet_error *error)
{
    Err err = {0};
    if (out)
        *out = NULL;
    return api_status(path && out ? saved_read(out, path, &err)
                                  : misused(&err, "imtet_search_load: %s is NULL", out ? "path" : "out"),
                      &err, error);
}
