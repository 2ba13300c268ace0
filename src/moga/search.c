#include "moga/search.h"
#include "moga/state.h"

#include "base/hypervolume.h"

const char *stop_reason_words(StopReason reason)
{
    static const char *const words[] = {
        [STOP_NONE] = "not stopped",
        [STOP_EVALUATIONS] = "all simulations spent",
        [STOP_EXHAUSTED] = "every design has been simulated",
        [STOP_TIME] = "time limit reached",
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
    return s->n_vain >= VAIN_MAX ? STOP_EXHAUSTED : STOP_NONE;
}

void search_stop(Search *s, StopReason reason)
{
    if (s->reason == STOP_NONE)
        s->reason = reason;
}

/* -- convergence --------------------------------------------------------------------------------------------------- */

/* Eight times in stop_after evaluations, where this step has passed one of those marks. */
static Status look_for_convergence(Search *s, Err *err)
{
    const Archive *a = &s->common.archive;
    const size_t wanted = s->common.config->stop_after, step = wanted / 8 + 1, cuts[] = {a->n - wanted, a->n};
    unsigned char *counts = a->scratch.mark;
    double h[2];
    if (wanted == 0 || s->common.convergence.end > 0 || a->n <= wanted || a->n / step == s->n_before / step)
        return STATUS_OK;
    for (size_t i = 0; i < a->n; i++)
        counts[i] = a->usable[i] && a->replicates[i] > 0 && a->violation[i] == 0.0;
    const GrowingFront designs = {a->n, a->n_obj, a->F, a->error, NULL, counts, a->on_front};
    TRY(convergence_shares(&designs, 2, cuts, h, err));
    if (!(h[1] - h[0] <= hypervolume_error(h[1])))
        return STATUS_OK;
    s->common.convergence = (Convergence){.after = wanted, .end = a->n + s->common.pending.n};
    return STATUS_OK;
}

/* -- what is known ------------------------------------------------------------------------------------------------- */

/* For who looks the archive has the results of screened designs, for the search what is expected of them. */
static void exchange(Search *s)
{
    screening_exchange(&s->screening, &s->common.archive);
}

static int is_over(const Search *s)
{
    return s->reason != STOP_NONE && s->common.pending.n == 0;
}

SearchView search_look(Search *s)
{
    s->state.n = 0;
    s->state.faulty = 0;
    if (s->is_behind_step)
        exchange(s);
    state_pack(s, &s->state);
    if (s->is_behind_step)
        exchange(s);
    return (SearchView){.all = &s->common.archive,
                        .n_evaluations = screening_evaluations(&s->screening, &s->common),
                        .n_screened = s->screening.n,
                        .level_agreement = s->screening.agreement,
                        .has_left_screening = s->screening.n > 0 && !s->screening.is_on,
                        .generation = s->common.generation,
                        .n_left_out = surrogate_left_out(s->surrogate),
                        .surrogate_error = surrogate_error(s->surrogate),
                        .reason = is_over(s) ? s->reason : STOP_NONE,
                        .state = pack_finished(&s->state) ? s->state.bytes : NULL,
                        .n_state = s->state.n};
}

/* -- asked and told ------------------------------------------------------------------------------------------------ */

Status search_ask(Search *s, SearchMove *move, Question *q, Err *err)
{
    Pending *p = &s->common.pending;
    *move = SEARCH_ENDS;
    if (is_over(s))
        return STATUS_OK;

    /* 1. Behind a step a group of questions is made; the next one of those that are there is asked. */
    if (s->is_behind_step) {
        exchange(s);
        s->is_behind_step = 0;
        s->common.generation += s->common.archive.n > 0;
        TRY(generation_ask(s, err));
    }
    if (pending_hand(p, q)) {
        *move = SEARCH_ASKS;
        q->cheap_parts = q->kind == KIND_FINISHED ? screening_parts(&s->screening, &s->common, q->x) : NULL;
        return STATUS_OK;
    }

    /* 2. What is due enters, where all of it is there, and what follows from it is decided. */
    *move = SEARCH_WAITS;
    if (p->n_known + s->allowed < p->n)
        return STATUS_OK;
    *move = SEARCH_STEPS;
    TRY(generation_enter(s, err));
    TRY(look_for_convergence(s, err));
    search_stop(s, reason_to_stop(s));
    exchange(s);
    s->is_behind_step = 1;
    return STATUS_OK;
}

size_t search_at_once(const Problem *p, const SearchConfig *c)
{
    const Common end = {.problem = p, .config = c, .archive.n = c->max_evals};
    return common_ahead(&end, c->max_evals) + batch_size(&end);
}

Status search_tell(Search *s, size_t number, const Evaluation *e, const void *parts, Err *err)
{
    const Problem *p = s->common.problem;
    double *f;
    TRY(pending_tell(&s->common.pending, number, e->outcome == OUTCOME_OK, parts, p->n_cheap * p->part_size, &f, err));
    problem_judge(p, e, f, f + p->n_obj);
    return STATUS_OK;
}

/* -- life ---------------------------------------------------------------------------------------------------------- */

/* Checks what it is made of. One that is resumed behind a step may have other limits now, and with another stop_after
 * not be over any more. */
static Status begin(Search *s, const SearchStart *start, Err *err)
{
    const SearchConfig *c = s->common.config;
    const Problem *p = s->common.problem;
    if (c->population < 4 || (c->initial > 0 && c->initial < 4) || c->max_evals < 1 || c->surrogate_max < 4)
        return bad_data(err,
                        "search: population %zu, initial %zu and surrogate_max %zu must be 4 at least, max_evals %zu 1",
                        c->population, c->initial, c->surrogate_max, c->max_evals);
    for (size_t d = 0; d < p->n_var; d++) {
        const double lower = p->lower[d], upper = p->upper[d];
        if (!(lower <= upper) || !isfinite(lower) || !isfinite(upper))
            return bad_data(err, "search: variable %zu has bounds %g and %g, lower must not exceed upper", d + 1, lower,
                            upper);
    }
    TRY(state_create(s, err));
    s->is_behind_step = 1;
    if (!start)
        return STATUS_OK;
    TRY(state_restore(s, start, err));
    if (!s->is_behind_step || s->common.archive.n == 0)
        return STATUS_OK;
    exchange(s);
    if (s->common.convergence.after != c->stop_after)
        s->common.convergence = (Convergence){0};
    search_stop(s, reason_to_stop(s));
    return STATUS_OK;
}

Status search_create(Search **out, const Problem *problem, const SearchConfig *config, const SearchStart *start,
                     Err *err)
{
    TRY_ROOM(*out, 1, "a search", err);
    (*out)->common = (Common){.problem = problem, .config = config};
    return begin(*out, start, err);
}

void search_free(Search *s)
{
    if (s)
        state_free(s);
    free(s);
}
