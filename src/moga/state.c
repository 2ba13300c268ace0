#include "moga/state.h"

#include <float.h>

#include "base/carve.h"

/* -- memory -------------------------------------------------------------------------------------------------------- */

static void layout(void *search, Carve *c)
{
    Search *s = search;
    const Problem *p = s->common.problem;
    const size_t n_var = p->n_var, population = s->common.config->population, n_pool = s->offspring.pool.n_max,
                 n_members = s->offspring.members.n_max;
    Batch *b = &s->batch;
    Offspring *o = &s->offspring;
    Scratch *w = &s->scratch;
    CARVE(c, b->X, b->size_max * n_var);
    CARVE(c, b->q, b->size_max);
    CARVE(c, o->allowed, n_members);
    CARVE(c, o->survivors, n_pool);
    CARVE(c, o->bound, n_members * p->n_obj);
    CARVE(c, o->children, (population + 1) * n_var);
    CARVE(c, o->scaled, (2 + 3 * (population + 1) / 2) * n_var);
    CARVE(c, o->descent_vector, 2 * s->criteria.vectors.n);
    CARVE(c, o->descent_X, n_pool * n_var);
    CARVE(c, w->members, n_pool);
    CARVE(c, w->slices, b->size_max);
    CARVE(c, w->samples, b->size_max * n_var);
    CARVE(c, w->f, p->n_obj + p->n_con);
}

/* Rows of the archive that there is room for from the beginning, where so many are to come: what is not used yet is no
 * memory of the system's, and growing would need room for what was there as well. */
enum { ROWS_AT_ONCE = 1 << 20 };

Status state_create(Search *s, Err *err)
{
    const Problem *p = s->common.problem;
    const SearchConfig *c = s->common.config;
    screening_begin(&s->screening, &s->common);
    const size_t population = c->population, initial = c->n_given + generation_samples(s);
    const size_t pending = common_ahead(&s->common, UINT32_MAX); /* the most: screened designs may be any number */
    const size_t n_pool = MAX_OF(initial, 5 * population) + 2 * pending + 1;
    const size_t n_members = n_pool + (p->kind ? SWAPS * population : 0); /* every design of a descent has its swaps */
    const size_t evals = MAX_OF(c->max_evals, 4);
    const size_t centres = MIN_OF(c->surrogate_max, evals), known = MIN_OF(evals, ROWS_AT_ONCE);
    const size_t n_vectors = p->n_obj < 2 ? 1 : MAX_OF(population, VECTORS); /* reference vectors of infill */
    Criteria *q = &s->criteria;
    size_t outer, inner;
    s->batch.size_max = MAX_OF(initial, population);
    s->offspring.pending_max = pending;
    directions_choose(p->n_obj, population, &outer, &inner);
    TRY(directions_create(&s->directions, p->n_obj, outer, inner, err));
    TRY(selection_create(&s->selection, n_pool, &s->directions, p->aspire, err));
    q->credit = (Credit){0.5, 0.5};
    TRY(directions_spread(&q->vectors, p->n_obj, n_vectors, err));
    for (int kind = 0; kind < INFILL_KINDS; kind++)
        TRY(infill_create(&q->select[kind], (InfillKind)kind, n_members, &q->vectors, p->aspire, err));
    TRY(pareto_archive_init(&s->common.archive, p->is_noisy ? 2 * initial : MAX_OF(known, 2 * initial), p->n_var,
                            p->n_obj, p->n_con, err));
    TRY(surrogate_create(&s->surrogate, p, centres, n_members, err));
    TRY(population_create(&s->population, 2 * population + pending, p->n_var, p->n_obj, err));
    TRY(population_create(&s->offspring.members, n_members, p->n_var, p->n_obj, err));
    TRY(population_create(&s->offspring.pool, n_pool, p->n_var, p->n_obj, err));
    s->common.pending = (Pending){.n_var = p->n_var, .n_obj = p->n_obj, .n_con = p->n_con};
    s->store = carve_all(layout, s);
    return s->store ? STATUS_OK : fail(err, STATUS_NO_MEMORY, "no memory for a search with population %zu", population);
}

void state_free(Search *s)
{
    directions_free(&s->directions);
    directions_free(&s->criteria.vectors);
    pareto_archive_free(&s->common.archive);
    free(s->selection);
    for (int kind = 0; kind < INFILL_KINDS; kind++)
        free(s->criteria.select[kind]);
    surrogate_free(s->surrogate);
    screening_free(&s->screening);
    pending_free(&s->common.pending);
    population_free(&s->population);
    population_free(&s->offspring.members);
    population_free(&s->offspring.pool);
    free(s->state.bytes);
    free(s->store);
}

/* -- as bytes ------------------------------------------------------------------------------------------------------ */

enum { STATE_VERSION = 21 };

int search_state_is_current(const void *state, size_t n_state)
{
    uint64_t version = 0;
    if (n_state < sizeof version)
        return 0;
    memcpy(&version, state, sizeof version);
    return version == STATE_VERSION;
}

/* All that the next generation takes from the earlier ones, beside the archive. */
void state_pack(Search *s, Pack *p)
{
    const Problem *problem = s->common.problem;
    pack_expect(p, STATE_VERSION);
    pack_expect(p, problem->n_var);
    pack_expect(p, problem->n_obj);
    pack_expect(p, problem->n_con);
    pack_expect(p, s->common.config->population);
    pack_expect(p, s->common.archive.n);
    pack_size(p, &s->common.generation, UINT32_MAX);
    pack_size(p, &s->offspring.n_dealt, UINT32_MAX);
    population_pack(&s->population, p, &s->common.archive);
    surrogate_pack(s->surrogate, p);
    pack_size(p, &s->common.convergence.after, UINT32_MAX);
    pack_size(p, &s->common.convergence.end, UINT32_MAX);
    pack_size(p, &s->screening.is_on, 1);
    pack_size(p, &s->n_vain, UINT32_MAX);
    pack_numbers(p, &s->criteria.credit.gain, 1, 0.0, 1.0);
    pack_numbers(p, &s->criteria.credit.designs, 1, DBL_MIN, 1.0 - DBL_EPSILON);
    pending_pack(&s->common.pending, p);

    /* Where it stands; why it stops is decided anew behind a step. */
    size_t behind_step = s->is_behind_step, reason = behind_step ? STOP_NONE : s->reason;
    pack_size(p, &behind_step, 1);
    pack_size(p, &reason, STOP_FAILURES);
    pack_size(p, &s->allowed, UINT32_MAX);
    s->is_behind_step = behind_step != 0;
    s->reason = p->reading ? (StopReason)reason : s->reason;
}

static Status restore_row(const Evaluation *e, void *search, Err *err)
{
    Search *s = search;
    double *f = s->scratch.f;
    problem_judge(s->common.problem, e, f, f + s->common.problem->n_obj);
    return screening_enter(&s->screening, &s->common,
                           &(Answer){e->x, f, e->outcome == OUTCOME_OK, e->kind, e->generation, NULL}, err);
}

Status state_restore(Search *s, const SearchStart *start, Err *err)
{
    if (start->each)
        TRY(start->each(restore_row, s, start->user, err));
    for (size_t i = 0; i < start->n && !start->each; i++)
        TRY(restore_row(&start->row[i], s, err));
    pareto_archive_update_noise(&s->common.archive);
    s->common.pending.n_entered = s->common.archive.n;
    if (!start->state)
        return STATUS_OK;
    Pack state = {.bytes = (unsigned char *)(uintptr_t)start->state, .n = start->n_state, .reading = 1};
    state_pack(s, &state);
    if (!pack_finished(&state))
        return bad_data(
            err,
            "the state of the search (%zu bytes after %zu simulations) does not fit this search: written by "
            "another version, or with other settings",
            start->n_state, start->n);
    return screening_update(&s->screening, &s->common, err);
}
