#include <omp.h>
#include <unistd.h>

#include "api/handle.h"
#include "api/search_config.h"
#include "base/clock.h"
#include "base/linalg.h"
#include "base/text.h"
#include "evaluate/limits.h"
#include "evaluate/tasks.h"

enum { STARTS_MAX = 1000000 };

/* -- its designs --------------------------------------------------------------------------------------------------- */

Status handle_add(imtet_search *s, const double x[], Err *err)
{
    Evaluation *row;
    if (s->table.n == s->room) {
        const size_t room = 2 * s->room + 64;
        AskedDesign *wider = realloc(s->design, room * sizeof *wider);
        if (!wider)
            return fail_memory(err, room, "designs");
        s->design = wider;
        s->room = room;
    }
    TRY(evaluation_table_add(&s->table, &row, err));
    copy_values(s->table.n_var, x, row->x);
    row->id = s->table.n;
    s->design[s->table.n - 1] = (AskedDesign){0};
    return STATUS_OK;
}

/* Let the search go on until it waits for answers, or ends: what may be asked for now is in the table. A search that
 * was saved asks again for what was under way, which may be told already. Meanwhile
 * threads and BLAS are as the search wants them; afterwards the caller's own are as before. */
static Status advance(imtet_search *s, Err *err)
{
    const int threads = omp_get_max_threads();
    SearchMove move = SEARCH_ASKS;
    Status status = STATUS_OK;
    if (s->is_over)
        return STATUS_OK;
    if (s->config.max_seconds > 0.0 && clock_seconds() >= s->began + s->config.max_seconds)
        search_stop(s->search, STOP_TIME);
    linalg_begin();
    omp_set_num_threads((int)threads_wanted(s->settings.search.threads));
    while (status == STATUS_OK && move != SEARCH_WAITS && move != SEARCH_ENDS) {
        Question q;
        status = search_ask(s->search, &move, &q, err);
        if (status != STATUS_OK || move != SEARCH_ASKS)
            continue;
        const size_t row = q.number - 1;
        if (row == s->table.n)
            status = handle_add(s, q.x, err);
        else if (row > s->table.n) /* there was no memory for the one before */
            status = fail(err, STATUS_INTERNAL, "design %zu was never asked for", q.number);
        if (status != STATUS_OK)
            break;
        Evaluation *e = &s->table.row[row];
        e->kind = q.kind;
        e->generation = q.generation;
        if (s->design[row].place == DESIGN_TOLD)
            status = search_tell(s->search, q.number, e, NULL, err);
    }
    omp_set_num_threads(threads);
    linalg_end();
    s->is_over = status == STATUS_OK && move == SEARCH_ENDS;
    if (s->is_over)
        s->reason = search_look(s->search).reason;
    return status;
}

/* -- making one ---------------------------------------------------------------------------------------------------- */

static void judge(const Evaluation *e, double f[], double g[], const void *user)
{
    const imtet_search *s = user;
    for (size_t k = 0; k < s->schema.n_obj; k++)
        f[k] = schema_objective(&s->schema, k)->sense * e->f[k];
    copy_values(s->schema.n_extra, e->extra, g);
}

Status handle_create(imtet_search **out, const Settings *settings, size_t n_given, Err *err)
{
    const ProblemOptions *o = &settings->problem;
    const size_t n_var = o->variables;
    TRY(settings_check(settings, err));
    TRY_ROOM(*out, 1, "a search", err);
    imtet_search *s = *out;
    s->settings = *settings;
    s->process = getpid();
    s->n_given = n_given;
    pthread_mutex_init(&s->lock, NULL);
    s->problem = (Problem){.n_var = n_var, .n_obj = o->objectives, .n_con = o->constraints};
    s->table = evaluation_table(n_var, o->objectives, o->constraints);
    TRY_ROOM(s->lower, (2 + n_given) * n_var, "numbers of a search", err);
    TRY_ROOM(s->kind, n_var, "variables", err);
    s->upper = s->lower + n_var;
    s->given = s->upper + n_var;
    return schema_of(&s->schema, settings, 0, err);
}

/* Complete the problem and the configuration, then create the search; one that was saved goes on from its state. */
Status handle_open(imtet_search *s, Err *err)
{
    Problem *p = &s->problem;
    for (size_t j = 0; j < p->n_var; j++) {
        const double lower = s->lower[j], upper = s->upper[j];
        if (!isfinite(lower) || !isfinite(upper) || lower > upper)
            return bad_data(err, "variable %zu has the bounds %g and %g; give finite ones, the lower one first", j + 1,
                            lower, upper);
    }
    TRY(kinds_read(s->settings.problem.kinds, p->n_var, s->kind, s->lower, &s->steps, err));
    TRY(aspirations_read(&p->aspire, s->aspire, &s->schema, s->settings.search.aspire, err));
    p->lower = s->lower;
    p->upper = s->upper;
    p->steps = s->steps;
    p->kind = kinds_are_real(s->settings.problem.kinds) ? NULL : s->kind;
    p->judge = judge;
    p->user = s;
    s->config = search_config_of(&s->settings);
    s->config.given = s->given;
    s->config.n_given = s->n_given;
    s->began = clock_seconds();
    const SearchStart start = {.n = s->n_entered, .row = s->table.row, .state = s->state, .n_state = s->n_state};
    TRY(search_create(&s->search, p, &s->config, s->state ? &start : NULL, err));
    free(s->state);
    s->state = NULL;
    return s->table.n > 0 ? advance(s, err) : STATUS_OK;
}

void handle_free(imtet_search *s)
{
    if (!s)
        return;
    search_free(s->search);
    evaluation_table_free(&s->table);
    pthread_mutex_destroy(&s->lock);
    schema_free(&s->schema);
    free(s->design);
    free(s->state);
    free(s->lower);
    free(s->kind);
    free(s->steps);
    free(s);
}

static Status put_count(Settings *s, const char *key, size_t n, Err *err)
{
    char text[32];
    snprintf(text, sizeof text, "%zu", n);
    return settings_put(s, key, text, err);
}

/* Settings of a problem that is asked and told. Those refused are of runs, of towers, or of evaluations that answer
 * differently each time. */
static Status settings_of(const imtet_search_options *o, Settings *s, Err *err)
{
    static const char *const KEYS[] = {"search.max_evals",    "search.seed",      "search.population",
                                       "search.initial",      "search.max_hours", "search.stop_after",
                                       "search.failures_max", "search.surrogate", "search.threads",
                                       "search.aspire",       "search.ahead"};
    char key[64];
    settings_defaults(s);
    TRY(settings_put(s, "problem.kind", "external", err));
    TRY(settings_put(s, "problem.command", "ask and tell", err));
    TRY(put_count(s, "problem.variables", o->variables, err));
    TRY(put_count(s, "problem.objectives", o->objectives, err));
    TRY(settings_put(s, "problem.kinds", o->kinds ? o->kinds : "real", err));
    TRY(settings_put(s, "problem.senses", o->senses ? o->senses : "min", err));
    if (o->constraints > CONSTRAINTS_MAX)
        return bad_data(err, "constraints: %zu are more than %d", o->constraints, CONSTRAINTS_MAX);
    s->problem.constraints = o->constraints;
    for (size_t i = 0; o->settings && o->settings[i]; i++) {
        snprintf(key, sizeof key, "%.*s", (int)strcspn(o->settings[i], "="), o->settings[i]);
        if (index_of_word(key, KEYS, N_OF(KEYS)) == N_OF(KEYS))
            return fail_no_word(err, STATUS_BAD_DATA, "settings", key, "setting of a search that is asked and told",
                                KEYS, N_OF(KEYS));
    }
    return api_settings(s, o->settings, err);
}

/* A search of these options: bounds (0 and 1 without) and first designs as they are given. Where it fails *out is for
 * handle_free. */
static Status create(const imtet_search_options *o, imtet_search **out, Err *err)
{
    Settings settings;
    if (o->size != sizeof *o)
        return misused(err, "imtet_search_create: options.size is %zu, wanted sizeof options, %zu", o->size, sizeof *o);
    if ((o->starts > 0 && !o->start) || o->starts > STARTS_MAX)
        return misused(err, "imtet_search_create: %zu starts are more than %d, or start is NULL", o->starts,
                       STARTS_MAX);
    TRY(settings_of(o, &settings, err));
    TRY(handle_create(out, &settings, o->starts, err));
    imtet_search *s = *out;
    const size_t n = o->variables;
    for (size_t j = 0; j < n; j++) {
        s->lower[j] = o->lower ? o->lower[j] : 0.0;
        s->upper[j] = o->upper ? o->upper[j] : 1.0;
    }
    TRY(api_check_finite("start", o->starts * n, o->start, "give designs to begin with", err));
    for (size_t i = 0; i < o->starts * n; i++) {
        if (!kinds_have(settings.problem.kinds, i % n, o->start[i]))
            return misused(err,
                           "start: variable %zu of design %zu is %g; it is a whole number, or one of its list (kinds)",
                           i % n + 1, i / n + 1, o->start[i]);
        s->given[i] = o->start[i];
    }
    return handle_open(s, err);
}

/* What making or loading one came to: where it failed nothing is left of it. */
static imtet_status made(imtet_search **out, Status status, const Err *err, imtet_error *error)
{
    if (status != STATUS_OK && out) {
        handle_free(*out);
        *out = NULL;
    }
    return api_status(status, err, error);
}

imtet_status imtet_search_create(const imtet_search_options *options, imtet_search **out, imtet_error *error)
{
    Err err = {0};
    if (out)
        *out = NULL;
    return made(out,
                out && options ? create(options, out, &err)
                               : misused(&err, "imtet_search_create: %s is NULL", out ? "options" : "out"),
                &err, error);
}

imtet_status imtet_search_load(const char *path, imtet_search **out, imtet_error *error)
{
    Err err = {0};
    if (out)
        *out = NULL;
    return made(out,
                path && out ? saved_read(out, path, &err)
                            : misused(&err, "imtet_search_load: %s is NULL", out ? "path" : "out"),
                &err, error);
}

void imtet_search_free(imtet_search **search)
{
    if (search && *search && (*search)->process == getpid())
        handle_free(*search);
    if (search)
        *search = NULL;
}

/* -- calls on one -------------------------------------------------------------------------------------------------- */

/* One thread at a time, in the process that made it. */
static int enter(imtet_search *s, Err *err, imtet_error *error)
{
    if (!s)
        misused(err, "the search is NULL: not made, or freed");
    else if (s->process != getpid())
        misused(err, "the search belongs to process %ld, of which this one is a fork; load a saved one",
                (long)s->process);
    else
        return pthread_mutex_lock(&s->lock) == 0;
    api_status(err->code, err, error);
    return 0;
}

/* Every call on a search begins by this, which declares err, and ends by leave; where it fails the call returns. */
#define ENTER(search, err, error)                                                                                      \
    Err err = {0};                                                                                                     \
    if (!enter(search, &(err), error))                                                                                 \
    return (imtet_status)(err).code

static imtet_status leave(imtet_search *s, Status status, const Err *err, imtet_error *error)
{
    pthread_mutex_unlock(&s->lock);
    return api_status(status, err, error);
}

/* Give out up to n free designs; the search chooses more where it can. */
static Status ask(imtet_search *s, size_t n, long ids[], double X[], size_t *found, Err *err)
{
    const size_t n_var = s->schema.n_var, failing = s->failing;
    if (!found || (n > 0 && (!ids || !X)))
        return misused(err, "imtet_search_ask: %s is NULL", !found ? "found" : !ids ? "ids" : "X");
    if (s->settings.search.failures_max > 0 && failing >= (size_t)s->settings.search.failures_max) {
        s->failing = 0; /* said once: who calls again wants to go on */
        return fail(err, STATUS_INTERNAL,
                    "the last %zu designs failed (search.failures_max), the last one: %s; mend what is wrong and ask "
                    "again",
                    failing, s->table.row[s->failed].reason);
    }
    if (n > 0)
        TRY(advance(s, err));
    for (; s->next < s->table.n && *found < n; s->next++) {
        if (s->design[s->next].place != DESIGN_FREE)
            continue;
        s->design[s->next].place = DESIGN_OUT;
        ids[*found] = s->next + 1;
        copy_values(n_var, s->table.row[s->next].x, X + *found * n_var);
        ++*found;
    }
    return STATUS_OK;
}

imtet_status imtet_search_ask(imtet_search *search, size_t n, long ids[], double X[], size_t *found, imtet_error *error)
{
    if (found)
        *found = 0;
    ENTER(search, err, error);
    return leave(search, ask(search, n, ids, X, found, &err), &err, error);
}

/* The answers of one call. */
typedef struct {
    const long *ids;
    const double *F, *G;
    const char *const *failed;
} Answers;

/* Is answer i one that can be stored? Nothing is changed yet, but for the mark by which a design that is named twice is
 * found. */
static Status check_answer(imtet_search *s, const Answers *t, size_t i, Err *err)
{
    static const char CURE[] = "tell that the design failed, and why";
    const size_t n_obj = s->schema.n_obj, n_con = s->schema.n_extra, n_asked = MAX_OF(s->next, s->known);
    const long id = t->ids[i];
    char what[64];
    if (id < 1 || (size_t)id > n_asked)
        return misused(err, "no design has the id %ld; %zu were asked for", id, n_asked);
    AskedDesign *design = &s->design[id - 1];
    if (design->place == DESIGN_TOLD || design->is_named)
        return misused(err, "design %ld is told %s", id, design->is_named ? "twice" : "already");
    design->is_named = 1;
    if (t->failed && t->failed[i])
        return evaluation_table_give_room(&s->table.row[id - 1], err);
    if (!t->F || (n_con > 0 && !t->G))
        return misused(err, "design %ld succeeded, but its %s is NULL", id, t->F ? "G" : "F");
    snprintf(what, sizeof what, "F of design %ld", id);
    TRY(api_check_finite(what, n_obj, t->F + i * n_obj, CURE, err));
    what[0] = 'G';
    return n_con > 0 ? api_check_finite(what, n_con, t->G + i * n_con, CURE, err) : STATUS_OK;
}

/* Store answer i and tell the search; 0 has no sign, as in the run that a study stores. */
static Status store_answer(imtet_search *s, const Answers *t, size_t i, Err *err)
{
    const size_t n_obj = s->schema.n_obj, n_con = s->schema.n_extra, row = t->ids[i] - 1;
    const char *failed = t->failed ? t->failed[i] : NULL;
    Evaluation *e = &s->table.row[row];
    evaluation_set_outcome(e, failed ? OUTCOME_ERROR : OUTCOME_OK,
                           failed && !failed[0] ? "no reason is known" : failed);
    for (size_t k = 0; !failed && k < n_obj; k++)
        e->f[k] = t->F[i * n_obj + k] + 0.0;
    for (size_t c = 0; !failed && c < n_con; c++)
        e->extra[c] = t->G[i * n_con + c] + 0.0;
    s->design[row].place = DESIGN_TOLD;
    s->n_told++;
    s->failing = failed ? s->failing + 1 : 0;
    s->failed = row;
    return search_tell(s->search, row + 1, e, NULL, err);
}

imtet_status imtet_search_tell(imtet_search *search, size_t n, const long ids[], const double F[], const double G[],
                               const char *const failed[], imtet_error *error)
{
    const Answers answers = {ids, F, G, failed};
    size_t n_checked = 0;
    ENTER(search, err, error);
    Status status = n == 0 || ids ? STATUS_OK : misused(&err, "imtet_search_tell: ids is NULL");
    while (status == STATUS_OK && n_checked < n)
        status = check_answer(search, &answers, n_checked++, &err);
    for (size_t i = 0; i < n_checked; i++)
        if (ids[i] >= 1 && (size_t)ids[i] <= search->table.n)
            search->design[ids[i] - 1].is_named = 0;
    for (size_t i = 0; status == STATUS_OK && i < n; i++)
        status = store_answer(search, &answers, i, &err);
    return leave(search, status, &err, error);
}

/* -- what is known so far ------------------------------------------------------------------------------------------ */

imtet_status imtet_search_look(imtet_search *search, imtet_search_state *state, imtet_error *error)
{
    ENTER(search, err, error);
    const Status status = state && state->size == sizeof *state
                              ? advance(search, &err)
                              : misused(&err, "imtet_search_look: state.size is no sizeof state, %zu", sizeof *state);
    if (status == STATUS_OK) {
        *state = (imtet_search_state){.size = sizeof *state,
                                      .variables = search->schema.n_var,
                                      .objectives = search->schema.n_obj,
                                      .constraints = search->schema.n_extra,
                                      .told = search->n_told,
                                      .done = search->is_over,
                                      .why = search->is_over ? stop_reason_words(search->reason) : "",
                                      .senses = search->settings.problem.senses,
                                      .lower = search->lower,
                                      .upper = search->upper};
        for (size_t i = 0; i < search->table.n; i++) {
            state->under_way += search->design[i].place == DESIGN_OUT;
            state->ready += search->design[i].place == DESIGN_FREE;
            state->failed += search->design[i].place == DESIGN_TOLD && search->table.row[i].outcome != OUTCOME_OK;
        }
        const size_t most = search->settings.search.max_evals, spent = state->told + state->under_way;
        state->left = most > spent && !search->is_over ? most - spent : 0;
    }
    return leave(search, status, &err, error);
}

/* An archive of every row that is told, whose on_front are those that are there. */
static Status fill_archive(const imtet_search *s, Archive *archive, Err *err)
{
    double f[OBJECTIVES_MAX], g[CONSTRAINTS_MAX];
    if (s->is_over)
        TRY(evaluation_table_check(&s->table, err));
    TRY(pareto_archive_init(archive, s->n_told + 1, s->schema.n_var, s->schema.n_obj, s->schema.n_extra, err));
    for (size_t i = 0; i < s->table.n; i++) {
        const Evaluation *e = &s->table.row[i];
        if (s->design[i].place != DESIGN_TOLD)
            continue;
        judge(e, f, g, s);
        TRY(pareto_archive_insert(archive, e->x, f, g, e->outcome == OUTCOME_OK, KIND_SAMPLED, 0, err));
    }
    return STATUS_OK;
}

imtet_status imtet_search_designs(imtet_search *search, imtet_set which, size_t max, long ids[], double X[], double F[],
                                  double G[], size_t *found, imtet_error *error)
{
    Archive archive = {0};
    Status status = STATUS_OK;
    if (found)
        *found = 0;
    ENTER(search, err, error);
    if (!found || (which != IMTET_FRONT && which != IMTET_TOLD))
        status = misused(&err, "imtet_search_designs: %s", found ? "`which` is no set" : "found is NULL");
    else if (which == IMTET_FRONT)
        status = fill_archive(search, &archive, &err);
    for (size_t i = 0, at = 0; status == STATUS_OK && i < search->table.n; i++) {
        const Evaluation *e = &search->table.row[i];
        if (search->design[i].place != DESIGN_TOLD || (which == IMTET_FRONT && !archive.on_front[at++]))
            continue;
        const size_t n = (*found)++, size[] = {search->schema.n_var, search->schema.n_obj, search->schema.n_extra};
        const double *const from[] = {e->x, e->f, e->extra};
        double *const to[] = {X, F, G};
        if (n < max && ids)
            ids[n] = e->id;
        for (size_t k = 0; n < max && k < N_OF(size); k++)
            if (to[k])
                copy_values(size[k], from[k], to[k] + n * size[k]);
    }
    pareto_archive_free(&archive);
    return leave(search, status, &err, error);
}

imtet_status imtet_search_save(imtet_search *search, const char *path, imtet_error *error)
{
    ENTER(search, err, error);
    return leave(search, path ? saved_write(search, path, &err) : misused(&err, "imtet_search_save: path is NULL"),
                 &err, error);
}
