#include "moga/searching.h"

enum { STATE_VERSION = 6 };

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
    if (s->feed)
        feed_pack(s->feed, p);
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
    for (size_t i = 0; i < start->n; i++)
        TRY(archive_insert(&s->archive, 1, start->X + i * p->n_var, start->F + i * p->n_obj,
                           p->n_con > 0 ? start->G + i * p->n_con : NULL, start->ok + i, start->kind[i],
                           start->generation[i], err));
    archive_update_noise(&s->archive);
    if (s->feed)
        feed_replay(s->feed, start->n_later, start->X + start->n * p->n_var, start->F + start->n * p->n_obj,
                    start->G ? start->G + start->n * p->n_con : NULL, start->ok + start->n, start->kind + start->n);
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
