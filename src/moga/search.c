#include "moga/searching.h"

#include <math.h>
#include <stdlib.h>

#include "base/carve.h"

const char *stop_reason_words(StopReason reason)
{
    static const char *const words[] = {
        [STOP_NONE] = "not stopped",
        [STOP_GENERATIONS] = "all generations done",
        [STOP_EVALUATIONS] = "all simulations spent",
        [STOP_TIME] = "time limit reached",
        [STOP_SHARE] = "the wanted share of the archive is nondominated",
        [STOP_ASKED] = "stopped on request",
    };
    return words[reason];
}

/* Room for the archive's rows, after every generation. */
static Status widen(Search *s, Err *err)
{
    if (s->archive.n <= s->n_rows)
        return STATUS_OK;
    free(s->wins);
    free(s->reported);
    s->n_rows = 2 * s->archive.n;
    s->wins = calloc(s->n_rows, sizeof *s->wins);
    s->reported = calloc(s->n_rows, 1);
    if (s->wins && s->reported)
        return STATUS_OK;
    s->n_rows = 0;
    return fail(err, STATUS_NO_MEMORY, "no memory for %zu designs", s->archive.n);
}

static StopReason reason_to_stop(const Search *s)
{
    const SearchConfig *c = s->config;
    const Archive *a = &s->archive;
    if (a->n >= c->max_evals)
        return STOP_EVALUATIONS;
    if (s->generation >= c->generations)
        return STOP_GENERATIONS;
    if (c->nondominated_share < 1.0 && (double)a->n_front >= c->nondominated_share * (double)a->n)
        return STOP_SHARE;
    return c->max_seconds > 0.0 && search_seconds(s) >= c->max_seconds ? STOP_TIME : STOP_NONE;
}

/* Answers that a design on the front wants: at the end no more than one of them has. */
static size_t answers_wanted(const Search *s, int is_last)
{
    const Archive *a = &s->archive;
    size_t most = 0;
    for (size_t i = 0; i < a->n_front; i++)
        most = a->replicates[a->front[i]] > most ? a->replicates[a->front[i]] : most;
    return is_last && most < s->config->replicates_min ? most : s->config->replicates_min;
}

/* The front with answers enough; where answers are not noisy one is enough. */
static size_t count_reported(Search *s, int is_last)
{
    const Archive *a = &s->archive;
    const size_t wanted = s->problem->is_noisy ? answers_wanted(s, is_last) : 0;
    size_t n = 0;
    memcpy(s->reported, a->on_front, a->n);
    for (size_t i = 0; i < a->n_front; i++) {
        s->reported[a->front[i]] = a->replicates[a->front[i]] >= wanted;
        n += s->reported[a->front[i]];
    }
    return n;
}

static int report(Search *s, int is_last, ObserveFn observe, void *user)
{
    const Archive *a = &s->archive;
    const size_t n_reported = count_reported(s, is_last);
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
        .on_front = s->reported,
        .n_front = n_reported,
        .n_failed = a->n_failed,
        .n_replicates = a->n_replicates,
        .generation_now = s->generation,
        .n_predicted = s->n_predicted,
        .surrogate_error = surrogate_error(s->surrogate),
        .seconds = search_seconds(s),
        .simulation_s = s->n_timed > 0 ? s->simulating_s / (double)s->n_timed : NAN,
        .own_s = s->n_guided > 0 ? s->guided_s / (double)s->n_guided : NAN,
        .is_aside = s->aside == ASIDE_YES,
        .waited_s = s->waited_s,
        .surrogate_s = s->surrogate_s,
        .is_asynchronous = s->config->asynchronous != 0,
        .state = pack_finished(&s->state) ? s->state.bytes : NULL,
        .n_state = s->state.n,
    };
    return observe && observe(&view, user) ? 1 : 0;
}

static Status run_loop(Search *s, const SearchStart *start, ObserveFn observe, void *user, StopReason *reason, Err *err)
{
    *reason = STOP_NONE;
    if (start) {
        TRY(state_restore(s, start, err));
        TRY(widen(s, err));
        *reason = start->state ? reason_to_stop(s) : STOP_NONE;
        s->generation += start->state != NULL;
    }
    for (; *reason == STOP_NONE; s->generation += *reason == STOP_NONE) {
        TRY(s->generation == 0 ? generation_first(s, err) : generation_next(s, err));
        TRY(widen(s, err));
        *reason = reason_to_stop(s);
        if (report(s, *reason != STOP_NONE, observe, user) && *reason == STOP_NONE)
            *reason = STOP_ASKED;
    }
    if (queue_pending(s->queue) == 0 || *reason == STOP_ASKED)
        return STATUS_OK;
    s->generation++;
    TRY(generation_last(s, err));
    TRY(widen(s, err));
    report(s, 1, observe, user);
    return STATUS_OK;
}

static Status check(const Problem *p, const SearchConfig *c, Err *err)
{
    if (p->n_var < 1 || p->n_obj < 1)
        return fail(err, STATUS_BAD_DATA, "search: %zu variables and %zu objectives, wanted at least one of each",
                    p->n_var, p->n_obj);
    if (c->population < 4 || (c->initial > 0 && c->initial < 4) || c->max_evals < 1 || c->surrogate_max < 4)
        return fail(err, STATUS_BAD_DATA,
                    "search: population %zu, initial %zu and surrogate_max %zu must be 4 at least, max_evals %zu 1",
                    c->population, c->initial, c->surrogate_max, c->max_evals);
    for (size_t d = 0; d < p->n_var; d++)
        if (!(p->lower[d] <= p->upper[d]) || !isfinite(p->lower[d]) || !isfinite(p->upper[d]))
            return fail(err, STATUS_BAD_DATA, "search: variable %zu has bounds %g and %g, lower must not exceed upper",
                        d + 1, p->lower[d], p->upper[d]);
    return STATUS_OK;
}

static void layout(Search *s, size_t n_pool, Carve *c)
{
    const Problem *p = s->problem;
    s->chosen = carve(c, n_pool, sizeof(size_t));
    s->followed = carve(c, s->wishes.n, sizeof(size_t));
    s->descended = carve(c, n_pool * p->n_var, sizeof(double));
    s->foreseen = carve(c, s->came_max * p->n_obj, sizeof(double));
    s->child = carve(c, 2 * p->n_var, sizeof(double));
    s->note = carve(c, NOTE_FORESEEN + p->n_obj + p->n_con, sizeof(double));
    s->X = carve(c, s->came_max * p->n_var, sizeof(double));
    s->F = carve(c, s->came_max * p->n_obj, sizeof(double));
    s->ok = carve(c, s->came_max, 1);
    s->kind = carve(c, s->came_max, 1);
    s->way = carve(c, s->came_max + 1, 1);
    s->foretold = carve(c, s->came_max, 1);
    s->draws = carve(c, s->came_max, sizeof(size_t));
    s->allowed = carve(c, n_pool, 1);
    s->picked = carve(c, n_pool, 1);
}

/* Directions of the choice of simulations: one for five simulations of the budget; of small budgets one for two and a
 * half, up to VECTORS_FEW. */
static size_t wishes_for(size_t n_obj, const SearchConfig *c)
{
    const size_t fifth = search_planned(c) / VECTOR_EVALS, twice = 2 * fifth < VECTORS_FEW ? 2 * fifth : VECTORS_FEW;
    const size_t served = fifth > twice ? fifth : twice, least = n_obj > c->population ? n_obj : c->population;
    return n_obj < 2 ? 1 : served < least ? least : served < VECTORS_MAX ? served : VECTORS_MAX;
}

static Status create(Search *s, Err *err)
{
    const Problem *p = s->problem;
    const size_t population = s->config->population, initial = s->config->n_given + generation_samples(s);
    const size_t lead = batch_lead_max(s->config, p->n_workers);
    const size_t n_pool = (initial > 5 * population ? initial : 5 * population) + 2 * lead;
    const size_t most = s->config->max_evals > 4 ? s->config->max_evals : 4; /* centres there can ever be */
    const size_t centres = s->config->surrogate_max < most ? s->config->surrogate_max : most;
    size_t outer, inner;
    s->batch_max = initial > population ? initial : population;
    s->came_max = s->batch_max + lead;
    directions_choose(p->n_obj, population, &outer, &inner);
    TRY(directions_create(&s->directions, p->n_obj, outer, inner, err));
    TRY(directions_spread(&s->wishes, p->n_obj, wishes_for(p->n_obj, s->config), err));
    TRY(archive_init(&s->archive, 2 * initial, p->n_var, p->n_obj, p->n_con, err));
    TRY(selection_create(&s->selection, s->config->selection, n_pool, &s->directions, err));
    for (int kind = 0; kind < INFILL_KINDS; kind++)
        TRY(infill_create(&s->infill[kind], (InfillKind)kind, n_pool, &s->wishes, err));
    for (int kind = 0; kind < INFILL_KINDS; kind++)
        TRY(infill_create(&s->gained[kind], (InfillKind)kind, 1, &s->wishes, err));
    TRY(surrogate_create(&s->surrogate, p, centres, n_pool, err));
    TRY(population_create(&s->population, 2 * population + lead, p->n_var, p->n_obj, err));
    TRY(population_create(&s->offspring, n_pool, p->n_var, p->n_obj, err));
    TRY(population_create(&s->pool, n_pool, p->n_var, p->n_obj, err));
    Carve c = {0};
    layout(s, n_pool, &c);
    s->store = carve_store(&c);
    if (!s->store)
        return fail(err, STATUS_NO_MEMORY, "no memory for a search with population %zu", population);
    layout(s, n_pool, &(Carve){.base = s->store});
    return STATUS_OK;
}

static void release(Search *s)
{
    directions_free(&s->directions);
    directions_free(&s->wishes);
    archive_free(&s->archive);
    selection_free(s->selection);
    for (int kind = 0; kind < INFILL_KINDS; kind++)
        infill_free(s->infill[kind]);
    for (int kind = 0; kind < INFILL_KINDS; kind++)
        infill_free(s->gained[kind]);
    surrogate_free(s->surrogate);
    population_free(&s->population);
    population_free(&s->offspring);
    population_free(&s->pool);
    free(s->state.bytes);
    free(s->wins);
    free(s->reported);
    free(s->store);
}

static Status open_queue(Search *s, const SearchStart *start, Err *err)
{
    const int asynchronous = s->config->asynchronous;
    const size_t n_before = start ? start->n + (asynchronous ? start->n_later : 0) : 0;
    TRY(queue_open(&s->queue, s->problem, asynchronous ? QUEUE_AS_ARRIVED : QUEUE_AS_ASKED,
                   NOTE_FORESEEN + s->problem->n_obj, (long)n_before, err));
    if (start)
        queue_know(s->queue, start->n_later, start->row + start->n);
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
    Search s = {.problem = problem, .config = config};
    TRY(check(problem, config, err));
    guide_begin(&s);
    s.start = clock_seconds();
    Status status = create(&s, err);
    if (status == STATUS_OK)
        status = open_queue(&s, start, err);
    if (status == STATUS_OK)
        status = run_loop(&s, start, observe, user, reason, err);
    queue_close(s.queue);
    release(&s);
    return status;
}
