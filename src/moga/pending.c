#include "moga/pending.h"

#include <float.h>

#include "base/carve.h"

static size_t width(const Pending *p)
{
    return p->n_var + p->n_obj + p->n_con;
}

Place *pending_at(const Pending *p, size_t i)
{
    return &p->place[p->head + i];
}

double *pending_x(const Pending *p, size_t i)
{
    return p->number + (p->head + i) * width(p);
}

void pending_free(Pending *p)
{
    for (size_t i = 0; i < p->n; i++)
        free(pending_at(p, i)->parts);
    free(p->place);
    free(p->number);
}

Status pending_add(Pending *p, const Question *q, Err *err)
{
    /* Room behind the last one: what is there moves to the front where half is free, else there will be twice as
     * much. */
    if (p->head + p->n == p->n_max) {
        if (p->head <= p->n_max / 2) {
            const size_t n_max = p->n_max > 0 ? 2 * p->n_max : 64;
            int lacks = 0;
            p->place = widened(p->place, n_max, sizeof *p->place, &lacks);
            p->number = widened(p->number, n_max * width(p), sizeof *p->number, &lacks);
            if (lacks)
                return fail_memory(err, n_max, "designs under way");
            p->n_max = n_max;
        }
        memmove(p->place, p->place + p->head, p->n * sizeof *p->place);
        copy_values(p->n * width(p), p->number + p->head * width(p), p->number);
        p->head = 0;
    }
    *pending_at(p, p->n) = (Place){.q = *q};
    copy_values(p->n_var, q->x, pending_x(p, p->n++));
    p->n_of_kind[q->kind]++;
    return STATUS_OK;
}

int pending_hand(Pending *p, Question *q)
{
    if (p->n_handed == p->n)
        return 0;
    *q = pending_at(p, p->n_handed)->q;
    q->x = pending_x(p, p->n_handed);
    q->number = p->n_entered + ++p->n_handed;
    return 1;
}

Status pending_tell(Pending *p, size_t number, int ok, const void *parts, size_t size, double **f, Err *err)
{
    const size_t i = number - p->n_entered - 1;
    if (number <= p->n_entered || i >= p->n_handed || pending_at(p, i)->is_told)
        return fail(err, STATUS_INTERNAL, "design %zu is told, but was not asked for, or is told already", number);
    Place *place = pending_at(p, i);
    if (parts) {
        TRY_ROOM(place->parts, size, "a part of an evaluation", err);
        memcpy(place->parts, parts, size);
    }
    *f = pending_x(p, i) + p->n_var;
    place->ok = ok != 0;
    place->is_told = 1;
    while (p->n_known < p->n && pending_at(p, p->n_known)->is_told)
        p->n_known++;
    return STATUS_OK;
}

void pending_enter(Pending *p)
{
    const Place *first = pending_at(p, 0);
    free(first->parts);
    p->n_of_kind[first->q.kind]--;
    p->head++;
    p->n--;
    p->n_handed--;
    p->n_known--;
    p->n_entered++;
}

int pending_has(const Pending *p, const double x[])
{
    for (size_t i = 0; i < p->n; i++)
        if (memcmp(pending_x(p, i), x, p->n_var * sizeof *x) == 0)
            return 1;
    return 0;
}

void pending_pack(Pending *p, Pack *pack)
{
    size_t n = p->n;
    double *x = calloc(p->n_var, sizeof *x);
    pack->faulty |= !x;
    pack_size(pack, &n, UINT32_MAX);
    for (size_t i = 0; i < n && !pack->faulty; i++) {
        Question q = {.x = x};
        if (!pack->reading) {
            q = pending_at(p, i)->q;
            copy_values(p->n_var, pending_x(p, i), x);
        }
        size_t kind = q.kind, criterion = q.criterion;
        pack_numbers(pack, x, p->n_var, -DBL_MAX, DBL_MAX);
        pack_size(pack, &q.repeat, UINT32_MAX);
        pack_size(pack, &kind, KIND_COUNT - 1);
        pack_size(pack, &q.n_parts, UINT32_MAX);
        pack_size(pack, &q.generation, UINT32_MAX);
        pack_size(pack, &criterion, UINT8_MAX);
        q.criterion = (unsigned char)criterion;
        q.kind = (EvaluationKind)kind;
        if (pack->reading && !pack->faulty)
            pack->faulty = pending_add(p, &q, &(Err){0}) != STATUS_OK;
    }
    free(x);
}
