#include "moga/search.h"
#include "moga/state.h"

#include "base/hypervolume.h"

const char *stop_reason_words(StopReason reason)
{
    static const char *const words[] = {
        [STOP_NONE] = "not stopped",
        [STOP_GENERATIONS] = "all generations done",
        [STOP_EVALUATIONS] = "all simulations spent",
        [STOP_TIME] = "time limit reached",
        [STOP_SHARE] = "the wanted share of the archive is nondominated",
        [STOP_CONVERGED] = "the last search.stop_after simulations gained nothing above the noise of hypervolume",
        [STOP_ASKED] = "stopped on request",
        [STOP_FAILURES] = "too many simulations in a row have failed",
    };
    return words[reason];
}

static StopReason reason_to_stop(const Search *s)
{
    const SearchConfig *c = s->common.config;
    const Archive *a = &s->common.archive;
    if (screening_is_spent(&s->screening, &s->common))
        return s->screening.cost.whole == 1 && a->n < c->max_evals ? STOP_CONVERGED : STOP_EVALUATIONS;
    if (s->common.generation >= c->generations && !screening_is_due(&s->screening, &s->common))
        return STOP_GENERATIONS;
    if (c->nondominated_share < 1.0 && a->n_front >= c->nondominated_share * (double)a->n)
        return STOP_SHARE;
    return c->max_seconds > 0.0 && search_seconds(s) >= c->max_seconds ? STOP_TIME : STOP_NONE;
}

/* -- convergence --------------------------------------------------------------------------------------------------- */

/* Eight times in stop_after evaluations: this generation has passed one of those marks. */
static int is_due(const Search *s)
{
    const Archive *a = &s->common.archive;
    const size_t wanted = s->common.config->stop_after, step = wanted / 8 + 1;
    size_t before = a->n;
    while (before > 0 && a->generation[before - 1] == s->common.generation)
        before--;
    return wanted > 0 && s->common.convergence.end == 0 && a->n > wanted && a->n / step > before / step;
}

static Status look_for_convergence(Search *s, Err *err)
{
    const Archive *a = &s->common.archive;
    unsigned char *counts = a->scratch.mark;
    const size_t cuts[] = {a->n - s->common.config->stop_after, a->n};
    double h[2];
    if (!is_due(s))
        return STATUS_OK;
    for (size_t i = 0; i < a->n; i++)
        counts[i] = a->usable[i] && a->replicates[i] > 0 && a->violation[i] == 0.0;
    const GrowingFront designs = {a->n, a->n_obj, a->F, a->error, NULL, counts, a->on_front};
    TRY(convergence_shares(&designs, 2, cuts, h, err));
    if (!(h[1] - h[0] <= hypervolume_error(h[1])))
        return STATUS_OK;
    s->common.convergence.after = s->common.config->stop_after;
    s->common.convergence.end = a->n + queue_pending(s->common.queue);
    return STATUS_OK;
}

/* A search that is resumed with another stop_after may not be over any more. */
static void reconsider_convergence(Search *s)
{
    if (s->common.convergence.after != s->common.config->stop_after)
        s->common.convergence = (Convergence){0};
}

/* -- the view of the observer -------------------------------------------------------------------------------------- */

static int report(Search *s, int is_last, ObserveFn observe, void *user)
{
    const Archive *a = &s->common.archive;
    state_save(s);
    const SearchView view = {
        .n = a->n,
        .n_var = a->n_var,
        .n_obj = a->n_obj,
        .n_con = a->n_con,
        .X = a->X,
        .F = a->F,
        .sd = a->sd,
        .replicates = a->replicates,
        .Y = a->Y,
        .H = a->H,
        .ok = a->ok,
        .kind = a->kind,
        .generation = a->generation,
        .on_front = a->on_front,
        .n_front = a->n_front,
        .n_failed = a->n_failed,
        .n_replicates = a->n_replicates,
        .n_evaluations = screening_evaluations(&s->screening, &s->common),
        .n_screened = s->screening.n,
        .level_agreement = s->screening.agreement,
        .has_left_screening = s->screening.n > 0 && !s->screening.is_on,
        .generation_now = s->common.generation,
        .n_left_out = surrogate_left_out(s->surrogate),
        .surrogate_error = surrogate_error(s->surrogate),
        .seconds = search_seconds(s),
        .waited_s = s->waited_s,
        .surrogate_s = s->surrogate_s,
        .is_last = is_last,
        .is_asynchronous = s->common.config->asynchronous != 0,
        .state = pack_finished(&s->state) ? s->state.bytes : NULL,
        .n_state = s->state.n,
    };
    screening_exchange(&s->screening, &s->common.archive);
    const int stop = observe && observe(&view, user);
    screening_exchange(&s->screening, &s->common.archive);
    return stop;
}

/* -- the loop over generations ------------------------------------------------------------------------------------- */

static Status begin(Search *s, const SearchStart *start, StopReason *reason, Err *err)
{
    *reason = STOP_NONE;
    if (!start)
        return STATUS_OK;
    TRY(state_restore(s, start, err));
    reconsider_convergence(s);
    *reason = start->state ? reason_to_stop(s) : STOP_NONE;
    s->common.generation += start->state != NULL;
    return STATUS_OK;
}

static Status run_loop(Search *s, const SearchStart *start, ObserveFn observe, void *user, StopReason *reason, Err *err)
{
    TRY(begin(s, start, reason, err));
    for (; *reason == STOP_NONE; s->common.generation += *reason == STOP_NONE) {
        TRY(s->common.generation == 0 ? generation_first(s, err) : generation_next(s, err));
        TRY(look_for_convergence(s, err));
        *reason = reason_to_stop(s);
        if (report(s, *reason != STOP_NONE, observe, user) && *reason == STOP_NONE)
            *reason = STOP_ASKED;
    }
    if (queue_pending(s->common.queue) == 0 || *reason == STOP_ASKED)
        return STATUS_OK;
    s->common.generation++;
    TRY(generation_last(s, err));
    report(s, 1, observe, user);
    return STATUS_OK;
}

static Status check(const Problem *p, const SearchConfig *c, Err *err)
{
    if (p->n_var < 1 || p->n_obj < 1)
        return bad_data(err, "search: %zu variables and %zu objectives, wanted at least one of each", p->n_var,
                        p->n_obj);
    if (c->population < 4 || (c->initial > 0 && c->initial < 4) || c->max_evals < 1 || c->surrogate_max < 4)
        return bad_data(err,
                        "search: population %zu, initial %zu and surrogate_max %zu must be 4 at least, max_evals %zu 1",
                        c->population, c->initial, c->surrogate_max, c->max_evals);
    for (size_t d = 0; d < p->n_var; d++)
        if (!(p->lower[d] <= p->upper[d]) || !isfinite(p->lower[d]) || !isfinite(p->upper[d]))
            return bad_data(err, "search: variable %zu has bounds %g and %g, lower must not exceed upper", d + 1,
                            p->lower[d], p->upper[d]);
    return STATUS_OK;
}

static Status open_queue(Search *s, const SearchStart *start, Err *err)
{
    const int asynchronous = s->common.config->asynchronous;
    const size_t n_before = start ? start->n + (asynchronous ? start->n_later : 0) : 0;
    TRY(queue_open(&s->common.queue, s->common.problem, asynchronous ? QUEUE_AS_ARRIVED : QUEUE_AS_ASKED, n_before,
                   err));
    if (start)
        queue_know(s->common.queue, start->n_later, start->row + (start->each ? 0 : start->n));
    return STATUS_OK;
}

Status search_run(const Problem *problem, const SearchConfig *config, ObserveFn observe, void *user, StopReason *reason,
                  Err *err)
{
    return search_resume(problem, config, NULL, observe, user, reason, err);
}

Status search_resume(const Problem *problem, const SearchConfig *config, const SearchStart *start, ObserveFn observe,
                     void *user, StopReason *reason, Err *err)
{
    Search s = {.common = {.problem = problem, .config = config}, .start = clock_seconds()};
    TRY(check(problem, config, err));
    Status status = state_create(&s, err);
    if (status == STATUS_OK)
        status = open_queue(&s, start, err);
    if (status == STATUS_OK)
        status = run_loop(&s, start, observe, user, reason, err);
    queue_close(s.common.queue);
    state_free(&s);
    return status;
}
