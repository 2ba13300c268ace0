#include "moga/search.h"

#include <math.h>
#include <stdint.h>
#include <stdlib.h>
#include <time.h>

#include "base/carve.h"
#include "base/pack.h"
#include "moga/archive.h"
#include "moga/directions.h"
#include "moga/dominance.h"
#include "moga/group.h"
#include "moga/infill.h"
#include "moga/order.h"
#include "moga/surface.h"
#include "moga/survival.h"
#include "moga/variation.h"

enum {
    INNER_GENERATIONS = 10, /* on the surface, between two batches */
    WISHES_MAX = 400,
    BATCH_SHARE = 8, /* a batch is this part of the population ... */
    CHECK_SHARE = 4, /* ... and this part of it checks predictions that stand */
    AGE_MAX = 3      /* a prediction that stood so often is checked first */
};

/* Kendall's tau below which the surface no longer leads, and how much one batch counts in its running mean. */
static const double LEAST_AGREEMENT = 0.15, AGREEMENT_WEIGHT = 0.25;
/* Where descents end so far off their directions (sine of the angle, median), the front has not the shape of a simplex:
 * from OFF_LEAST on simulations are chosen by rays too, from OFF_MOST on mostly. One generation's weight in the mean.
 */
static const double OFF_LEAST = 0.15, OFF_MOST = 0.35, RAYS_MOST = 0.85, OFF_WEIGHT = 0.2;

/* A surface costs wall time; with it a search needs a fifth of the simulations of a plain one, mostly less
 * (docs/search.md). It therefore pays as long as its time for one simulation is below that of PAYS simulations. */
static const double PAYS = 4.0;
enum { COST_SAMPLE = 60 }; /* simulations chosen by the surface, before costs are weighed */
typedef enum { ASIDE_OPEN, ASIDE_NO, ASIDE_YES } Aside;

typedef struct {
    const Problem *problem;
    const SearchConfig *config;
    Archive archive;
    Directions directions, wishes; /* of survival, of the choice of simulations */
    Survival *survival;
    Infill *infill[INFILL_KINDS];
    Surface *surface;
    Group population, pool, offspring;
    size_t generation, n_predicted, batch_max;
    double simulating_s, guided_s;      /* wall time of this session: in the simulator, of our own while guided */
    size_t n_timed, n_guided;           /* simulations in these times */
    size_t aside;                       /* Aside */
    double agreement;                   /* running mean of Kendall's tau between predicted and simulated batches */
    double off;                         /* running mean of how far from their directions descents by PBI end */
    size_t n_followed, n_followed_rays; /* descents of this generation, the last of the offspring; by rays come first */
    double *foreseen;                   /* (batch, n_obj) what was predicted of the batch under way */
    size_t *chosen;                     /* (pool) */
    double *apart;                      /* (wishes) scratch */
    size_t *followed;                   /* (wishes) in the order of this generation */
    double *descended;                  /* (pool, n_var) */
    double *child;                      /* (2, n_var) */
    double *X, *F, *G;                  /* (batch) of one call of evaluate */
    unsigned char *ok;                  /* (batch) */
    unsigned char *allowed, *picked;    /* (pool) offspring that may still be, that have been sent to simulation */
    Pack state;                         /* as of the last report */
    void *store;
    struct timespec start;
} Search;

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

static double seconds_since(const struct timespec *start)
{
    struct timespec now;
    clock_gettime(CLOCK_MONOTONIC, &now);
    return (double)(now.tv_sec - start->tv_sec) + 1e-9 * (double)(now.tv_nsec - start->tv_nsec);
}

/* -- simulation: the only way into the archive ------------------------------------------------------------------ */

static int in_batch(const Search *s, size_t n, const double x[])
{
    for (size_t i = 0; i < n; i++)
        if (memcmp(s->X + i * s->problem->n_var, x, s->problem->n_var * sizeof *x) == 0)
            return 1;
    return 0;
}

/* Appends x to a batch of n unless it is known, the batch is full or the simulations are spent; returns the new n. */
static size_t batch_add(Search *s, size_t n, const double x[])
{
    if (n >= s->batch_max || s->archive.n + n >= s->config->max_evals || in_batch(s, n, x) ||
        archive_find(&s->archive, x) < s->archive.n)
        return n;
    memcpy(s->X + n * s->problem->n_var, x, s->problem->n_var * sizeof *x);
    return n + 1;
}

static Status simulate_batch(Search *s, size_t n, EvaluationKind kind, Err *err)
{
    const Problem *p = s->problem;
    if (n == 0)
        return STATUS_OK;
    const double before = seconds_since(&s->start);
    TRY(p->evaluate(n, s->X, s->F, s->G, s->ok, p->user, err));
    s->simulating_s += seconds_since(&s->start) - before;
    s->n_timed += n;
    return archive_insert(&s->archive, n, s->X, s->F, s->G, s->ok, (unsigned char)kind, s->generation, err);
}

/* Simulated designs of the archive's rows first.. join the pool; failed ones do not. */
static void add_simulated(Search *s, Group *group, size_t first)
{
    const Archive *a = &s->archive;
    for (size_t row = first; row < a->n; row++) {
        if (!a->ok[row])
            continue;
        const size_t i = group_add(group, a->X + row * a->n_var);
        memcpy(group->F + i * a->n_obj, a->F + row * a->n_obj, a->n_obj * sizeof *a->F);
        group->violation[i] = a->violation[row];
        group->row[i] = row;
    }
}

static size_t planned_evals(const SearchConfig *c)
{
    return c->planned_evals > 0 ? c->planned_evals : c->max_evals;
}

static void survive(Search *s, Group *group, uint32_t step)
{
    Random random = random_stream(s->config->seed, RANDOM_NICHING, (uint32_t)s->generation, step);
    const double progress = fmin((double)s->archive.n / (double)planned_evals(s->config), 1.0);
    const size_t n = survival_select(s->survival, group->n, group->F, group->violation, s->config->population, progress,
                                     &random, s->chosen);
    group_keep(group, n, s->chosen);
}

/* -- variation ---------------------------------------------------------------------------------------------------- */

static const double *tournament(const Group *g, Random *random)
{
    const size_t a = random_below(random, g->n), b = random_below(random, g->n), m = g->n_obj;
    const int b_wins = dominates_constrained(m, g->F + b * m, g->violation[b], g->F + a * m, g->violation[a]);
    return g->X + (b_wins ? b : a) * g->n_var;
}

/* Appends n children of the group's first n_parents members to it. Child pair j of step has its own streams. */
static void breed(Search *s, Group *group, size_t n, uint32_t step)
{
    const Problem *p = s->problem;
    const SearchConfig *c = s->config;
    Group parents = *group;
    for (size_t j = 0; 2 * j < n; j++) {
        const uint32_t name = step * (uint32_t)c->population + (uint32_t)j;
        Random choice = random_stream(c->seed, RANDOM_PARENTS, (uint32_t)s->generation, name);
        Random change = random_stream(c->seed, RANDOM_VARIATION, (uint32_t)s->generation, name);
        const double *mother = tournament(&parents, &choice), *father = tournament(&parents, &choice);
        crossover_sbx(&change, p->n_var, p->lower, p->upper, c->crossover_probability, c->crossover_eta, mother, father,
                      s->child, s->child + p->n_var);
        for (size_t i = 0; i < 2 && 2 * j + i < n; i++) {
            double *x = s->child + i * p->n_var;
            mutate_polynomial(&change, p->n_var, p->lower, p->upper, c->mutation_rate / (double)p->n_var,
                              c->mutation_eta, x);
            if (p->repair)
                p->repair(x, p->user);
            group_add(group, x);
        }
    }
}

/* -- one generation ----------------------------------------------------------------------------------------------- */

/* Where there is nobody to breed from (every simulation failed so far), another Latin hypercube. */
static Status sample_again(Search *s, Err *err)
{
    const Problem *p = s->problem;
    const size_t first = s->archive.n;
    size_t n = 0;
    latin_hypercube(s->config->seed, (uint32_t)s->generation, s->config->population, p->n_var, p->lower, p->upper,
                    s->pool.X, s->chosen);
    for (size_t i = 0; i < s->config->population; i++) {
        if (p->repair)
            p->repair(s->pool.X + i * p->n_var, p->user);
        n = batch_add(s, n, s->pool.X + i * p->n_var);
    }
    TRY(simulate_batch(s, n, KIND_SAMPLED, err));
    add_simulated(s, &s->population, first);
    return STATUS_OK;
}

/* Once, when enough has been timed: a surface that costs more wall time per simulation than PAYS simulations steps
 * aside. The decision is part of the state, so that a search that goes on keeps it. */
static void weigh_costs(Search *s)
{
    if (s->config->surrogate != SURROGATE_AUTO || s->aside != ASIDE_OPEN || s->n_guided < COST_SAMPLE)
        return;
    const double simulation = s->simulating_s / (double)s->n_timed, own = s->guided_s / (double)s->n_guided;
    s->aside = own > PAYS * simulation ? ASIDE_YES : ASIDE_NO;
}

static int may_use_surface(const Search *s)
{
    return s->config->surrogate != SURROGATE_OFF && s->aside != ASIDE_YES;
}

/* Whether the surface leads: it explains its own data, and what it foretold of late batches came in that order. */
static int is_guided(const Search *s)
{
    return may_use_surface(s) && surface_stands(s->surface) && s->agreement > LEAST_AGREEMENT;
}

/* Simulations between two fits of the surface: more as they accumulate, so that fitting never takes over. */
static size_t batch_size(const Search *s)
{
    const size_t population = s->config->population, least = population / BATCH_SHARE + 1, grown = s->archive.n / 40;
    return grown < least ? least : grown < population / 2 ? grown : population / 2;
}

/* Part of a batch that is chosen by rays, the rest by PBI: PBI is the better guide where every direction meets the
 * front, but where most of them miss it, rays measure what a design adds to the hypervolume whatever the front's shape.
 */
static double share_of_rays(const Search *s)
{
    return RAYS_MOST * fmin(fmax((s->off - OFF_LEAST) / (OFF_MOST - OFF_LEAST), 0.0), 1.0);
}

/* How far off their directions this generation's descents by PBI end, as the surface sees them. */
static void judge_directions(Search *s)
{
    const size_t first = s->offspring.n - s->n_followed, n = s->n_followed - s->n_followed_rays;
    for (size_t j = 0; j < n; j++) {
        const size_t i = s->n_followed_rays + j;
        s->apart[j] =
            infill_off(s->infill[INFILL_PBI], s->followed[i], s->offspring.F + (first + i) * s->problem->n_obj);
    }
    sort_numbers(n, s->apart);
    s->off += OFF_WEIGHT * (s->apart[n / 2] - s->off);
}

/* Some directions, drawn anew each time, are followed down the surface. */
static void add_descended(Search *s)
{
    const Problem *p = s->problem;
    size_t n = 2 * batch_size(s);
    Random random = random_stream(s->config->seed, RANDOM_DESCENT, (uint32_t)s->generation, 0);
    n = n < s->wishes.n ? n : s->wishes.n;
    for (size_t r = 0; r < s->wishes.n; r++)
        s->followed[r] = r;
    random_shuffle(&random, s->wishes.n, s->followed);
    const size_t rays = (size_t)(share_of_rays(s) * (double)n);
    s->n_followed = n;
    s->n_followed_rays = rays;
    surface_descend(s->surface, &s->archive, s->infill[INFILL_RAYS], rays, s->followed, s->descended);
    surface_descend(s->surface, &s->archive, s->infill[INFILL_PBI], n - rays, s->followed + rays,
                    s->descended + rays * p->n_var);
    for (size_t i = 0; i < n; i++) {
        if (p->repair)
            p->repair(s->descended + i * p->n_var, p->user);
        group_add(&s->offspring, s->descended + i * p->n_var);
    }
}

/* The offspring population: what survives some generations of variation and selection on the surface and has not been
 * simulated. Without a surface that can be relied on, plain children of the population. */
static void make_offspring(Search *s, int plainly)
{
    const int guided = is_guided(s) && !plainly;
    s->pool.n = s->offspring.n = s->n_followed = 0;
    for (size_t i = 0; i < s->population.n; i++)
        group_copy_member(&s->pool, &s->population, i);
    for (uint32_t step = 0; step < (guided ? INNER_GENERATIONS : 1); step++) {
        const size_t n_parents = s->pool.n;
        breed(s, &s->pool, s->config->population, step);
        if (!guided)
            break;
        surface_predict(s->surface, &s->pool, n_parents, 0);
        survive(s, &s->pool, 1 + step);
    }
    for (size_t i = 0; i < s->pool.n; i++)
        if (s->pool.row[i] == PREDICTED)
            group_copy_member(&s->offspring, &s->pool, i);
    if (guided && s->archive.n_front > 0)
        add_descended(s);
    surface_predict(s->surface, &s->offspring, 0, 1);
    if (s->n_followed > 0)
        judge_directions(s);
}

static int is_trusted(const Search *s, const Group *g, size_t i)
{
    return is_guided(s) && g->uncertainty[i] < s->config->trust_error;
}

/* Offspring i into the batch, and what is foretold of it. */
static size_t batch_take(Search *s, size_t n, size_t i)
{
    const Group *g = &s->offspring;
    if (n < s->batch_max)
        memcpy(s->foreseen + n * g->n_obj, g->F + i * g->n_obj, g->n_obj * sizeof *g->F);
    s->picked[i] = 1;
    return batch_add(s, n, g->X + i * g->n_var);
}

/* Plain children are simulated in their order. */
static size_t choose_plain_batch(Search *s, size_t batch)
{
    size_t n = 0;
    for (size_t i = 0; i < s->offspring.n && n < batch; i++)
        n = batch_take(s, n, i);
    return n;
}

/* Up to `limit` designs among those allowed, by both ways of choosing in turn. */
static size_t choose_in_turn(Search *s, size_t n, size_t limit)
{
    const double share = share_of_rays(s);
    while (n < limit) {
        const int rays = floor(share * (double)(n + 1)) > floor(share * (double)n);
        const size_t i = infill_pick(s->infill[rays ? INFILL_RAYS : INFILL_PBI], s->allowed);
        if (i == SIZE_MAX)
            break;
        infill_take(s->infill[rays ? INFILL_PBI : INFILL_RAYS], i);
        n = batch_take(s, n, i);
    }
    return n;
}

/* First predictions that do not stand or have stood for long, then a few of those that do. */
static size_t choose_batch(Search *s)
{
    const Group *g = &s->offspring;
    const size_t batch = batch_size(s), check = batch / CHECK_SHARE + 1;
    size_t n = 0;
    memset(s->picked, 0, g->n);
    if (!is_guided(s))
        return choose_plain_batch(s, batch);
    for (int kind = 0; kind < INFILL_KINDS; kind++)
        infill_offer(s->infill[kind], g->n, g->F, g->violation, g->uncertainty);
    for (int round = 0; round < 2; round++) {
        const size_t limit = round == 0 ? batch - check : n + check;
        for (size_t i = 0; i < g->n; i++)
            s->allowed[i] = !s->picked[i] && (round == 1 || !is_trusted(s, g, i) || g->age[i] >= AGE_MAX);
        n = choose_in_turn(s, n, limit);
    }
    return n;
}

/* How far the surface foretold the order of the n designs just simulated, in the mean over the objectives. */
static void judge_surface(Search *s, size_t n)
{
    const size_t m = s->problem->n_obj;
    double mean = 0.0;
    if (n < 4 || !surface_stands(s->surface))
        return;
    for (size_t k = 0; k < m; k++)
        mean += kendall_tau(n, m, s->foreseen + k, s->F + k, s->ok) / (double)m;
    s->agreement += AGREEMENT_WEIGHT * (mean - s->agreement);
}

/* Where the surface has nothing new to propose, plain children; where these are all known too, fresh samples. */
static size_t choose_any_batch(Search *s, EvaluationKind *kind)
{
    const size_t n = choose_batch(s);
    *kind = n > 0 && is_guided(s) ? KIND_INFILL : KIND_OFFSPRING;
    if (n > 0)
        return n;
    make_offspring(s, 1);
    memset(s->picked, 0, s->offspring.n);
    return choose_plain_batch(s, batch_size(s));
}

/* The front to be improved; where nothing is feasible yet, the population. */
static void measure_front(Search *s)
{
    for (size_t i = 0; i < s->population.n; i++)
        s->chosen[i] = i;
    for (int kind = 0; kind < INFILL_KINDS; kind++)
        if (s->archive.n_front > 0)
            infill_measure(s->infill[kind], s->archive.n_front, s->archive.front, s->archive.F);
        else
            infill_measure(s->infill[kind], s->population.n, s->chosen, s->population.F);
}

/* Next population: from the simulated members of the present one, the batch, and the predictions that stand. */
static void renew_population(Search *s, size_t first_new)
{
    Group *population = &s->population, *pool = &s->pool, *offspring = &s->offspring;
    pool->n = 0;
    for (size_t i = 0; i < population->n; i++)
        if (population->row[i] != PREDICTED)
            group_copy_member(pool, population, i);
    for (size_t i = 0; i < offspring->n; i++)
        if (!s->picked[i] && is_trusted(s, offspring, i)) {
            s->n_predicted += offspring->age[i]++ == 0;
            group_copy_member(pool, offspring, i);
        }
    add_simulated(s, pool, first_new);
    survive(s, pool, 0);
    group_copy(population, pool);
}

static Status next_generation(Search *s, Err *err)
{
    const size_t first_new = s->archive.n;
    const double start = seconds_since(&s->start), simulating = s->simulating_s;
    s->n_predicted = 0;
    if (s->population.n < 2)
        return sample_again(s, err);
    weigh_costs(s);
    measure_front(s);
    if (may_use_surface(s))
        TRY(surface_fit(s->surface, &s->archive, s->infill[INFILL_PBI], err));
    else
        surface_drop(s->surface);
    surface_predict(s->surface, &s->population, 0, 0);
    make_offspring(s, 0);
    EvaluationKind kind;
    const size_t n = choose_any_batch(s, &kind);
    if (n == 0)
        return sample_again(s, err);
    TRY(simulate_batch(s, n, kind, err));
    judge_surface(s, n);
    renew_population(s, first_new);
    if (may_use_surface(s)) {
        s->guided_s += seconds_since(&s->start) - start - (s->simulating_s - simulating);
        s->n_guided += n;
    }
    return STATUS_OK;
}

/* Enough for a first surface of this many variables, and no more than half of the budget. */
static size_t initial_size(const Search *s)
{
    const size_t wanted = 4 * s->problem->n_var + 12, half = (planned_evals(s->config) + 1) / 2;
    if (s->config->initial > 0)
        return s->config->initial;
    return wanted < half ? wanted : half > 4 ? half : 4;
}

/* Samples beside n_given designs that are given: what is left of the first sample, but at least a half of it. */
static size_t n_samples(const Search *s)
{
    const size_t initial = initial_size(s), given = s->config->n_given;
    return given < initial / 2 ? initial - given : initial - initial / 2;
}

/* Into the box, then into what can be built. */
static void make_allowed(const Problem *p, double x[])
{
    for (size_t d = 0; d < p->n_var; d++)
        x[d] = fmin(fmax(x[d], p->lower[d]), p->upper[d]);
    if (p->repair)
        p->repair(x, p->user);
}

static Status first_generation(Search *s, Err *err)
{
    const Problem *p = s->problem;
    size_t n = 0;
    for (size_t i = 0; i < s->config->n_given; i++) {
        memcpy(s->child, s->config->given + i * p->n_var, p->n_var * sizeof *s->child);
        make_allowed(p, s->child);
        n = batch_add(s, n, s->child);
    }
    latin_hypercube(s->config->seed, 0, n_samples(s), p->n_var, p->lower, p->upper, s->pool.X, s->chosen);
    for (size_t i = 0; i < n_samples(s); i++) {
        make_allowed(p, s->pool.X + i * p->n_var);
        n = batch_add(s, n, s->pool.X + i * p->n_var);
    }
    TRY(simulate_batch(s, n, KIND_SAMPLED, err));
    add_simulated(s, &s->pool, 0);
    survive(s, &s->pool, 0);
    group_copy(&s->population, &s->pool);
    return STATUS_OK;
}

/* -- the loop ----------------------------------------------------------------------------------------------------- */

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
    return c->max_seconds > 0.0 && seconds_since(&s->start) >= c->max_seconds ? STOP_TIME : STOP_NONE;
}

/* -- the state ---------------------------------------------------------------------------------------------------- */

enum { STATE_VERSION = 3 };

/* All that the next generation takes from the earlier ones, beside the archive. */
static void search_pack(Search *s, Pack *p)
{
    const Problem *problem = s->problem;
    pack_expect(p, STATE_VERSION);
    pack_expect(p, problem->n_var);
    pack_expect(p, problem->n_obj);
    pack_expect(p, problem->n_con);
    pack_expect(p, s->config->population);
    pack_expect(p, s->archive.n);
    pack_size(p, &s->generation, UINT32_MAX);
    pack(p, &s->agreement, sizeof s->agreement);
    pack(p, &s->off, sizeof s->off);
    pack_size(p, &s->aside, ASIDE_YES);
    group_pack(&s->population, p, s->archive.n);
    surface_pack(s->surface, p);
}

static void save_state(Search *s)
{
    s->state.n = 0;
    s->state.faulty = 0;
    search_pack(s, &s->state);
}

static Status restore(Search *s, const SearchStart *start, Err *err)
{
    const Problem *p = s->problem;
    for (size_t i = 0; i < start->n; i++)
        TRY(archive_insert(&s->archive, 1, start->X + i * p->n_var, start->F + i * p->n_obj,
                           p->n_con > 0 ? start->G + i * p->n_con : NULL, start->ok + i, start->kind[i],
                           start->generation[i], err));
    Pack state = {.bytes = (unsigned char *)(uintptr_t)start->state, .n = start->n_state, .reading = 1};
    search_pack(s, &state);
    if (!pack_finished(&state))
        return fail(err, STATUS_BAD_DATA,
                    "the state of the search (%zu bytes after %zu simulations) does not fit this search: written by "
                    "another version, or with other settings",
                    start->n_state, start->n);
    return STATUS_OK;
}

static int report(Search *s, ObserveFn observe, void *user)
{
    const Archive *a = &s->archive;
    save_state(s);
    const SearchView view = {
        .n = a->n,
        .n_var = a->n_var,
        .n_obj = a->n_obj,
        .n_con = a->n_con,
        .X = a->X,
        .F = a->F,
        .G = a->G,
        .ok = a->ok,
        .kind = a->kind,
        .generation = a->generation,
        .on_front = a->on_front,
        .n_front = a->n_front,
        .n_failed = a->n_failed,
        .generation_now = s->generation,
        .n_predicted = s->n_predicted,
        .surrogate_error = surface_error(s->surface),
        .seconds = seconds_since(&s->start),
        .simulation_s = s->n_timed > 0 ? s->simulating_s / (double)s->n_timed : NAN,
        .own_s = s->n_guided > 0 ? s->guided_s / (double)s->n_guided : NAN,
        .is_aside = s->aside == ASIDE_YES,
        .state = pack_finished(&s->state) ? s->state.bytes : NULL,
        .n_state = s->state.n,
    };
    return observe && observe(&view, user) ? 1 : 0;
}

static Status run_loop(Search *s, const SearchStart *start, ObserveFn observe, void *user, StopReason *reason, Err *err)
{
    *reason = STOP_NONE;
    if (start) {
        TRY(restore(s, start, err));
        *reason = reason_to_stop(s);
        s->generation++;
    }
    for (; *reason == STOP_NONE; s->generation += *reason == STOP_NONE) {
        TRY(s->generation == 0 ? first_generation(s, err) : next_generation(s, err));
        *reason = reason_to_stop(s);
        if (report(s, observe, user) && *reason == STOP_NONE)
            *reason = STOP_ASKED;
    }
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
    s->foreseen = carve(c, s->batch_max * p->n_obj, sizeof(double));
    s->child = carve(c, 2 * p->n_var, sizeof(double));
    s->X = carve(c, s->batch_max * p->n_var, sizeof(double));
    s->F = carve(c, s->batch_max * p->n_obj, sizeof(double));
    s->G = carve(c, s->batch_max * p->n_con, sizeof(double));
    s->ok = carve(c, s->batch_max, 1);
    s->apart = carve(c, s->wishes.n, sizeof(double));
    s->allowed = carve(c, n_pool, 1);
    s->picked = carve(c, n_pool, 1);
}

/* Directions of the choice of simulations: as many as the budget can serve, five simulations each. */
static size_t wishes_for(size_t n_obj, const SearchConfig *c)
{
    const size_t served = planned_evals(c) / 5, least = n_obj > c->population ? n_obj : c->population;
    return n_obj < 2 ? 1 : served < least ? least : served < WISHES_MAX ? served : WISHES_MAX;
}

static Status create(Search *s, Err *err)
{
    const Problem *p = s->problem;
    const size_t population = s->config->population, initial = s->config->n_given + n_samples(s);
    const size_t n_pool = initial > 3 * population ? initial : 3 * population;
    const size_t most = s->config->max_evals > 4 ? s->config->max_evals : 4; /* centres there can ever be */
    const size_t centres = s->config->surrogate_max < most ? s->config->surrogate_max : most;
    size_t outer, inner;
    s->batch_max = initial > population ? initial : population;
    directions_choose(p->n_obj, population, &outer, &inner);
    TRY(directions_create(&s->directions, p->n_obj, outer, inner, err));
    TRY(directions_spread(&s->wishes, p->n_obj, wishes_for(p->n_obj, s->config), err));
    TRY(archive_init(&s->archive, 2 * initial, p->n_var, p->n_obj, p->n_con, err));
    TRY(survival_create(&s->survival, s->config->survival, n_pool, &s->directions, err));
    for (int kind = 0; kind < INFILL_KINDS; kind++)
        TRY(infill_create(&s->infill[kind], (InfillKind)kind, n_pool, &s->wishes, err));
    TRY(surface_create(&s->surface, p, centres, n_pool, err));
    TRY(group_create(&s->population, 2 * population, p->n_var, p->n_obj, err));
    TRY(group_create(&s->offspring, n_pool, p->n_var, p->n_obj, err));
    TRY(group_create(&s->pool, n_pool, p->n_var, p->n_obj, err));
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
    survival_free(s->survival);
    for (int kind = 0; kind < INFILL_KINDS; kind++)
        infill_free(s->infill[kind]);
    surface_free(s->surface);
    group_free(&s->population);
    group_free(&s->offspring);
    group_free(&s->pool);
    free(s->state.bytes);
    free(s->store);
}

Status search_run(const Problem *problem, const SearchConfig *config, ObserveFn observe, void *user, StopReason *reason,
                  Err *err)
{
    return search_resume(problem, config, NULL, observe, user, reason, err);
}

Status search_resume(const Problem *problem, const SearchConfig *config, const SearchStart *start, ObserveFn observe,
                     void *user, StopReason *reason, Err *err)
{
    Search s = {.problem = problem, .config = config, .agreement = 1.0};
    TRY(check(problem, config, err));
    clock_gettime(CLOCK_MONOTONIC, &s.start);
    Status status = create(&s, err);
    if (status == STATUS_OK)
        status = run_loop(&s, start, observe, user, reason, err);
    release(&s);
    return status;
}
