#include "moga/searching.h"

enum { STATE_VERSION = 7 };

/* Designs that are asked for and not simulated yet. */
static void pack_pending(Search *s, Pack *p)
{
    const size_t n_var = s->problem->n_var, n_note = NOTE_FORESEEN + s->problem->n_obj;
    size_t n = queue_pending(s->queue);
    pack_size(p, &n, SIZE_MAX / 2);
    for (size_t i = 0; i < n && !p->faulty; i++) {
        Asked asked = {.x = s->child, .note = s->note};
        size_t kind;
        if (!p->reading) {
            asked = queue_design(s->queue, i);
            memcpy(s->child, asked.x, n_var * sizeof *s->child);
            memcpy(s->note, asked.note, n_note * sizeof *s->note);
        }
        kind = asked.kind;
        pack(p, s->child, n_var * sizeof *s->child);
        pack(p, s->note, n_note * sizeof *s->note);
        pack_size(p, &asked.repeat, SIZE_MAX / 2);
        pack_size(p, &kind, KIND_COUNT - 1);
        asked.kind = (EvaluationKind)kind;
        p->faulty = p->faulty || !(s->note[NOTE_WAY] >= 0.0 && s->note[NOTE_WAY] < INFILL_KINDS);
        if (p->reading && !p->faulty)
            p->faulty = queue_ask(s->queue, &asked, &(Err){0}) != STATUS_OK;
    }
}

/* All that the next generation takes from the earlier ones, beside the archive. */
static void state_pack(Search *s, Pack *p)
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
    pack(p, &s->lost, sizeof s->lost);
    pack(p, &s->sources, sizeof s->sources);
    pack(p, &s->ways, sizeof s->ways);
    pack_size(p, &s->aside, ASIDE_YES);
    population_pack(&s->population, p, s->archive.n);
    surrogate_pack(s->surrogate, p);
    pack_pending(s, p);
}

void state_save(Search *s)
{
    s->state.n = 0;
    s->state.faulty = 0;
    state_pack(s, &s->state);
}

Status state_restore(Search *s, const SearchStart *start, Err *err)
{
    const Problem *p = s->problem;
    double *f = s->note + NOTE_FORESEEN, *g = f + p->n_obj;
    for (size_t i = 0; i < start->n; i++) {
        const Evaluation *e = &start->row[i];
        const unsigned char ok = e->outcome == OUTCOME_OK;
        problem_judge(p, e, f, g);
        TRY(archive_insert(&s->archive, 1, e->x, f, p->n_con > 0 ? g : NULL, &ok, (unsigned char)e->kind,
                           (size_t)e->generation, err));
    }
    archive_update_noise(&s->archive);
    if (!start->state)
        return STATUS_OK;
    Pack state = {.bytes = (unsigned char *)(uintptr_t)start->state, .n = start->n_state, .reading = 1};
    state_pack(s, &state);
    if (!pack_finished(&state))
        return fail(err, STATUS_BAD_DATA,
                    "the state of the search (%zu bytes after %zu simulations) does not fit this search: written by "
                    "another version, or with other settings",
                    start->n_state, start->n);
    return STATUS_OK;
}
